"""What closure projection needs to know of a speaker, learned from the corpus."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from corpus_tools.core import FloatArray, Recording, Trajectory, Utterance, frozen
from corpus_tools.speech import PhoneSet, aperture_functional, bite_functional, phone_minima_mm
from corpus_tools.synthesis.closure import HOLD_S, close_lips, closure_direction

__all__ = ["LipContact", "LipModel", "lip_model", "make_contacts"]


@dataclass(frozen=True, slots=True, eq=False)
class LipContact:
    """How this speaker makes one contact: of the lips in p b m, of lower lip and upper teeth in f v.

    Attributes
    ----------
    functional : (n_markers, 3)
        Weights of the distance, mm: the signed aperture, or how far the lower lip stands below the teeth.
    direction : (n_markers, 3)
        The likeliest change of the face per mm of it.
    target_mm : float
        Median of the corpus's own contacts; NaN without any.
    threshold_mm : float
        95th percentile of them: above it there is no contact.
    """

    functional: FloatArray
    direction: FloatArray
    target_mm: float
    threshold_mm: float


@dataclass(frozen=True, slots=True, eq=False)
class LipModel(LipContact):
    """How this speaker's lips close, and how the lower one goes to the teeth.

    Attributes
    ----------
    functional, direction, target_mm, threshold_mm
        Of the closure of the lips, as of :class:`LipContact`.
    on_teeth : LipContact
    """

    on_teeth: LipContact


def _contact(
    recordings: Sequence[Recording],
    labels: Collection[str],
    functional: FloatArray,
    components: FloatArray,
    variances: FloatArray,
) -> LipContact:
    minima = [phone_minima_mm(r.capture, r.utterance, labels, functional) for r in recordings]
    every = np.concatenate([*minima, np.zeros(0)])
    target, threshold = np.percentile(every, [50, 95]).tolist() if len(every) else (float("nan"),) * 2
    direction = closure_direction(functional, components, variances)
    return LipContact(frozen(functional), frozen(direction), target, threshold)


def lip_model(recordings: Sequence[Recording], phones: PhoneSet, n_components: int) -> LipModel:
    """Learn a :class:`LipModel` from all recordings.

    Parameters
    ----------
    recordings : sequence of Recording
    phones : PhoneSet
    n_components : int
        Principal components of the face that may take part in a contact.
    """
    captures = [r.capture for r in recordings]
    names = captures[0].names
    frames = np.concatenate([np.asarray(c.positions_mm).reshape(c.n_frames, -1) for c in captures])
    centred = frames - frames.mean(axis=0)
    values, vectors = np.linalg.eigh(centred.T @ centred / max(1, len(centred) - 1))
    keep = slice(-min(n_components, len(values)), None)
    moving = vectors[:, keep].T, values[keep]
    closed = _contact(recordings, phones.bilabials, aperture_functional(names), *moving)
    on_teeth = _contact(recordings, phones.labiodentals, bite_functional(names), *moving)
    return LipModel(closed.functional, closed.direction, closed.target_mm, closed.threshold_mm, on_teeth)


def make_contacts(
    lips: LipModel,
    trajectory: Trajectory,
    utterance: Utterance,
    phones: PhoneSet,
    iterations: int,
    hold_s: float = HOLD_S,
    on_teeth: bool = True,
) -> Trajectory:
    """Bring the lower lip to the teeth in f and v, then close the lips in p, b and m, where they are not.

    Closed lips touch as the speaker's usually do; the lower lip goes only as near to the teeth as 95 of 100
    of the speaker's f and v are (our choice: all the way, it would meet the upper lip, and be seen as a
    p b m). A contact that the corpus does not have is left as it is.
    """
    wanted: list[tuple[LipContact, float, Collection[str]]] = [(lips, lips.target_mm, phones.bilabials)]
    if on_teeth:
        wanted.insert(0, (lips.on_teeth, lips.on_teeth.threshold_mm, phones.labiodentals))
    for contact, target_mm, labels in wanted:
        if np.isfinite(target_mm):
            trajectory = close_lips(
                trajectory,
                utterance.phones,
                labels=labels,
                vowels=phones.vowels,
                functional=contact.functional,
                direction=contact.direction,
                target_mm=target_mm,
                hold_mm=contact.threshold_mm,
                hold_s=hold_s,
                iterations=iterations,
            )
    return trajectory
