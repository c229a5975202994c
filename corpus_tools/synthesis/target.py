"""A target utterance made ready for selection: its phones in the codes of an inventory, weights folded in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from corpus_tools.core import FloatArray, InputError, IntArray, Utterance, counted
from corpus_tools.fragments import phone_codes
from corpus_tools.speech.places import phone_places, place_gaps, stress_codes, stress_gaps
from corpus_tools.synthesis.model import SHORTEST_S, SelectionModel

__all__ = ["JOIN_TERMS", "TARGET_TERMS", "Target", "prepare_target"]

TARGET_TERMS = ("timing", "context", "place", "stress", "backoff", "flagged")
JOIN_TERMS = ("position", "velocity", "acceleration", "aperture", "sound", "each")


@dataclass(frozen=True, slots=True, eq=False)
class Target:
    """A target utterance in the codes of the inventory, with the weights folded into its tables.

    Attributes
    ----------
    labels : tuple of str
    codes : (n_phones,) int64
        -1 where the inventory has no such phone.
    classes : (n_phones,) int64
        -1 where no phone of the inventory is of that class.
    log_durations : (n_phones,) float64
    timing : (n_phones,) float64
        Weight of the timing of each phone; 0 for silence, which has no rhythm to keep.
    context : (n_phones + 2, n_codes + 1) float64
        Weighted mismatch of a neighbour: 0 same phone, 0.5 same viseme class, 1 else. Row k + 1 belongs to
        target phone k; the rows at both ends stand for silence.
    place : (n_phones, n_places) float64, or None with no weight on it
        Weighted mismatch of the place in syllable, word and phrase, 0 to 1; 0 for silence.
    stress : (n_phones, n_stresses) float64, or None with no weight on it
        Weighted mismatch of the stress, 0 to 1; 0 where either is unknown.
    backoff : (n_phones, n_codes + 1) float64
        Weighted mismatch of the phone itself: 0 same phone, 0.5 same viseme class, else 0.5 to 1 by how far
        the postures of the two classes lie apart. A diphone holds half of each of its phones, so that a whole
        phone replaced by one of its class costs the weight, any other up to twice that, the farthest most.
    flagged, join, velocity, acceleration, aperture, sound, each : float
        Weights; the middle four have `join` multiplied in.
    """

    labels: tuple[str, ...]
    codes: IntArray
    classes: IntArray
    log_durations: FloatArray
    timing: FloatArray
    context: FloatArray
    place: FloatArray | None
    stress: FloatArray | None
    backoff: FloatArray
    flagged: float
    join: float
    velocity: float
    acceleration: float
    aperture: float
    sound: float
    each: float

    @property
    def n_diphones(self) -> int:
        """Number of diphones: phones minus one."""
        return len(self.labels) - 1

    @property
    def unasked(self) -> frozenset[str]:
        """The terms that have no weight and are not listed: those that were added to the first ones."""
        weights = {"place": self.place is not None, "stress": self.stress is not None}
        weights |= {k: getattr(self, k) > 0 for k in ("acceleration", "aperture", "sound", "each")}
        return frozenset(name for name, asked in weights.items() if not asked)

    @property
    def typical_join(self) -> float:
        """What a join costs whose distances are all 1."""
        return self.join + self.velocity + self.acceleration + self.aperture + self.sound


def prepare_target(
    model: SelectionModel,
    utterance: Utterance,
    *,
    duration: float = 1.0,
    context: float = 0.3,
    position: float = 0.0,
    stress: float = 0.0,
    backoff: float = 2.0,
    flagged: float = 1.0,
    join: float = 1.0,
    velocity: float = 0.3,
    acceleration: float = 0.0,
    aperture: float = 0.0,
    sound: float = 0.0,
    per_join: float = 0.0,
) -> Target:
    """Encode a target utterance and fold the weights in.

    Raises
    ------
    InputError
        The utterance has fewer than two phones, or a weight is negative or not a number.
    LabelError
        A phone is not in the phone set.
    """
    weights = dict(duration=duration, context=context, position=position, stress=stress, backoff=backoff)
    weights |= dict(flagged=flagged, join=join, velocity=velocity, acceleration=acceleration)
    _check_weights(weights | dict(aperture=aperture, sound=sound, per_join=per_join))
    labels = utterance.labels
    if len(labels) < 2:
        raise InputError(
            f"'{utterance.name}' has {counted(len(labels), 'phone')}; a target needs at least two."
        )
    codes = phone_codes(model.inventory, labels)
    classes = _class_numbers(model, labels)
    spoken = np.array([p != model.phones.silence for p in labels])
    context_mismatch, own_mismatch = _mismatches(model, codes, classes, ~spoken)
    seconds = np.array([interval.duration_s for interval in utterance.phones])
    return Target(
        labels=labels,
        codes=codes,
        classes=classes,
        log_durations=np.log(np.maximum(seconds, SHORTEST_S)),
        timing=duration * spoken,
        context=context * context_mismatch,
        place=_places(model, utterance, position, spoken),
        stress=stress * stress_gaps()[stress_codes(utterance)] if stress > 0 else None,
        backoff=backoff * own_mismatch,
        flagged=flagged,
        join=join,
        velocity=join * velocity,
        acceleration=join * acceleration,
        aperture=join * aperture,
        sound=join * sound,
        each=per_join,
    )


def _mismatches(
    model: SelectionModel, codes: IntArray, classes: IntArray, silent: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return the mismatch of neighbours, with silence beyond both ends, and of the phones themselves."""
    beyond = len(model.inventory.phone_set)  # silence inside the target counts as that beyond its ends
    own = [beyond if p == model.phones.silence else i for i, p in enumerate(model.inventory.phone_set)]
    padded_codes = np.concatenate([[beyond], np.where(silent, beyond, codes), [beyond]])
    padded_classes = np.concatenate([model.classes[-1:], classes, model.classes[-1:]])
    same = padded_codes[:, None] == np.array([*own, beyond])
    alike = padded_classes[:, None] == model.classes
    mismatch = np.where(same, 0.0, np.where(alike, 0.5, 1.0))
    gaps = np.where(classes[:, None] < 0, 1.0, model.class_gaps[classes][:, model.classes])
    return mismatch, np.where(same[1:-1], 0.0, np.where(alike[1:-1], 0.5, 0.5 + 0.5 * gaps))


def _places(
    model: SelectionModel, utterance: Utterance, weight: float, spoken: IntArray
) -> FloatArray | None:
    if weight == 0:
        return None
    places = phone_places(utterance, model.phones.vowels, model.phones.silence)
    return weight * place_gaps()[places] * spoken[:, None]


def _check_weights(weights: dict[str, float]) -> None:
    for name, value in weights.items():
        if not (np.isfinite(value) and value >= 0):
            raise InputError(f"The weight '{name}' is {value:g}; a number of at least 0 was expected.")


def _class_numbers(model: SelectionModel, labels: Sequence[str]) -> IntArray:
    number = {name: i for i, name in enumerate(model.class_names)}
    return np.array([number.get(model.phones.viseme_class(p), -1) for p in labels], dtype=np.int64)
