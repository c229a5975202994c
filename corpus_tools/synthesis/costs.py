"""What a unit costs in its place: timing, context, backoff and flagged frames; and what a join costs.

Paper A section 5.1.1 names two factors, "similarity in the phonetic timing to the target utterance, and
similarity of context". Backoff, flagged frames and the join terms are our additions. Every cost belongs to
one diphone or to one join, so that a unit costs the sum of its diphones and both searches are judged by one
and the same number.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from corpus_tools.core import FloatArray, InputError, IntArray, Utterance, counted
from corpus_tools.fragments import phone_codes
from corpus_tools.synthesis.model import SHORTEST_S, SelectionModel

__all__ = [
    "JOIN_TERMS",
    "TARGET_TERMS",
    "Target",
    "join_costs",
    "join_matrix",
    "prepare_target",
    "span_costs",
]

TARGET_TERMS = ("timing", "context", "backoff", "flagged")
JOIN_TERMS = ("position", "velocity", "each")


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
    backoff : (n_phones, n_codes + 1) float64
        Weighted mismatch of the phone itself: 0 same phone, 0.5 same viseme class, else 0.5 to 1 by how far
        the postures of the two classes lie apart. A diphone holds half of each of its phones, so that a whole
        phone replaced by one of its class costs the weight, any other up to twice that, the farthest most.
    flagged, join, velocity, each : float
        Weights; `velocity` has `join` multiplied in.
    """

    labels: tuple[str, ...]
    codes: IntArray
    classes: IntArray
    log_durations: FloatArray
    timing: FloatArray
    context: FloatArray
    backoff: FloatArray
    flagged: float
    join: float
    velocity: float
    each: float

    @property
    def n_diphones(self) -> int:
        """Number of diphones: phones minus one."""
        return len(self.labels) - 1


def prepare_target(
    model: SelectionModel,
    utterance: Utterance,
    *,
    duration: float = 1.0,
    context: float = 0.3,
    backoff: float = 2.0,
    flagged: float = 1.0,
    join: float = 1.0,
    velocity: float = 0.3,
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
    weights = dict(duration=duration, context=context, backoff=backoff, flagged=flagged, join=join)
    _check_weights(weights | dict(velocity=velocity, per_join=per_join))
    labels = utterance.labels
    if len(labels) < 2:
        raise InputError(
            f"'{utterance.name}' has {counted(len(labels), 'phone')}; a target needs at least two."
        )
    codes = phone_codes(model.inventory, labels)
    classes = _class_numbers(model, labels)
    silent = np.array([p == model.phones.silence for p in labels])
    beyond = len(model.inventory.phone_set)  # silence inside the target counts as that beyond its ends
    own = [beyond if p == model.phones.silence else i for i, p in enumerate(model.inventory.phone_set)]
    padded_codes = np.concatenate([[beyond], np.where(silent, beyond, codes), [beyond]])
    padded_classes = np.concatenate([model.classes[-1:], classes, model.classes[-1:]])
    same = padded_codes[:, None] == np.array([*own, beyond])
    alike = padded_classes[:, None] == model.classes
    mismatch = np.where(same, 0.0, np.where(alike, 0.5, 1.0))
    gaps = np.where(classes[:, None] < 0, 1.0, model.class_gaps[classes][:, model.classes])
    own_mismatch = np.where(same[1:-1], 0.0, np.where(alike[1:-1], 0.5, 0.5 + 0.5 * gaps))
    seconds = np.array([interval.duration_s for interval in utterance.phones])
    return Target(
        labels=labels,
        codes=codes,
        classes=classes,
        log_durations=np.log(np.maximum(seconds, SHORTEST_S)),
        timing=duration * ~silent,
        context=context * mismatch,
        backoff=backoff * own_mismatch,
        flagged=flagged,
        join=join,
        velocity=join * velocity,
        each=per_join,
    )


def _check_weights(weights: dict[str, float]) -> None:
    for name, value in weights.items():
        if not (np.isfinite(value) and value >= 0):
            raise InputError(f"The weight '{name}' is {value:g}; a number of at least 0 was expected.")


def _class_numbers(model: SelectionModel, labels: Sequence[str]) -> IntArray:
    number = {name: i for i, name in enumerate(model.class_names)}
    return np.array([number.get(model.phones.viseme_class(p), -1) for p in labels], dtype=np.int64)


def span_costs(
    model: SelectionModel, target: Target, first: int, rows: npt.NDArray[np.int64], length: int = 1
) -> FloatArray:
    """Cost of units that start at `rows` and speak `length` target diphones from diphone `first` on.

    Returns
    -------
    (n_rows, 4) float64
        The weighted terms of :data:`TARGET_TERMS`, summed over the diphones of the unit.
    """
    steps = np.arange(length)
    r = rows[:, None] + steps
    k = first + steps
    codes = model.inventory.codes
    late = np.abs(model.log_durations[r] - target.log_durations[k]) * target.timing[k]
    late_next = np.abs(model.log_durations[r + 1] - target.log_durations[k + 1]) * target.timing[k + 1]
    context = target.context[k, model.left[r]] + target.context[k + 3, model.right[r]]
    backoff = target.backoff[k, codes[r]] + target.backoff[k + 1, codes[r + 1]]
    terms = np.empty((len(rows), len(TARGET_TERMS)))
    for column, values in enumerate((late + late_next, context, backoff, target.flagged * model.flagged[r])):
        values.sum(axis=1, out=terms[:, column])
    return terms


def join_costs(
    model: SelectionModel, target: Target, left_rows: npt.NDArray[np.int64], right_rows: npt.NDArray[np.int64]
) -> FloatArray:
    """Cost of joining units whose last phones are `left_rows` to units whose first phones are `right_rows`.

    Returns
    -------
    (n, 3) float64
        The weighted terms of :data:`JOIN_TERMS`; all 0 where the rows are one and the same: speech goes on.
    """
    joins = model.joins
    terms = np.empty((len(right_rows), len(JOIN_TERMS)))
    terms[:, 0] = target.join * _lengths(joins.position[left_rows] - joins.position[right_rows])
    terms[:, 1] = target.velocity * _lengths(joins.velocity[left_rows] - joins.velocity[right_rows])
    terms[:, 2] = target.each
    terms[left_rows == right_rows] = 0.0
    return terms


def _lengths(vectors: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(np.einsum("ij,ij->i", vectors, vectors)))


def join_matrix(
    model: SelectionModel, target: Target, left_rows: npt.NDArray[np.int64], right_rows: npt.NDArray[np.int64]
) -> FloatArray:
    """Total join cost of every pair, shape (n_left, n_right), as if none went on naturally."""
    joins = model.joins
    total = _distances(joins.position[left_rows], joins.position[right_rows])
    total *= target.join
    if target.velocity > 0:
        total += target.velocity * _distances(joins.velocity[left_rows], joins.velocity[right_rows])
    total += target.each
    return total


def _distances(a: FloatArray, b: FloatArray) -> FloatArray:
    squares = (-2.0 * a) @ b.T
    squares += np.einsum("ij,ij->i", a, a)[:, None]
    squares += np.einsum("ij,ij->i", b, b)
    np.maximum(squares, 0.0, out=squares)
    return np.asarray(np.sqrt(squares, out=squares))
