"""What closure projection needs to know of a speaker, learned from the corpus."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from corpus_tools.core import FloatArray, Recording, Trajectory, Utterance, frozen
from corpus_tools.speech import PhoneSet, aperture_functional, bilabial_minima_mm, closure_threshold_mm
from corpus_tools.synthesis.closure import HOLD_S, close_lips, closure_direction

__all__ = ["LipModel", "close_bilabials", "lip_model"]


@dataclass(frozen=True, slots=True, eq=False)
class LipModel:
    """How this speaker's lips close.

    Attributes
    ----------
    functional : (n_markers, 3)
        Weights of the signed lip aperture.
    direction : (n_markers, 3)
        The likeliest change of the face per mm of aperture.
    target_mm : float
        Median aperture of the corpus's own closures; NaN without bilabials.
    threshold_mm : float
        95th percentile of them: above it the lips are open.
    """

    functional: FloatArray
    direction: FloatArray
    target_mm: float
    threshold_mm: float


def lip_model(recordings: Sequence[Recording], phones: PhoneSet, n_components: int) -> LipModel:
    """Learn a :class:`LipModel` from all recordings.

    Parameters
    ----------
    recordings : sequence of Recording
    phones : PhoneSet
    n_components : int
        Principal components of the face that may take part in a closure.
    """
    captures = [r.capture for r in recordings]
    utterances = [r.utterance for r in recordings]
    names = captures[0].names
    functional = aperture_functional(names)
    frames = np.concatenate([np.asarray(c.positions_mm).reshape(c.n_frames, -1) for c in captures])
    centred = frames - frames.mean(axis=0)
    values, vectors = np.linalg.eigh(centred.T @ centred / max(1, len(centred) - 1))
    keep = slice(-min(n_components, len(values)), None)
    direction = closure_direction(functional, vectors[:, keep].T, values[keep])
    minima = [bilabial_minima_mm(c, u, phones) for c, u in zip(captures, utterances, strict=True)]
    every = np.concatenate([*minima, np.zeros(0)])
    target = float(np.median(every)) if len(every) else float("nan")
    threshold = closure_threshold_mm(captures, utterances, phones)
    return LipModel(frozen(functional), frozen(direction), target, threshold)


def close_bilabials(
    lips: LipModel,
    trajectory: Trajectory,
    utterance: Utterance,
    phones: PhoneSet,
    iterations: int,
    hold_s: float = HOLD_S,
) -> Trajectory:
    """Close the lips of a synthesised trajectory in its bilabials; unchanged when the corpus has none."""
    if not np.isfinite(lips.target_mm):
        return trajectory
    return close_lips(
        trajectory,
        utterance.phones,
        bilabials=phones.bilabials,
        functional=lips.functional,
        direction=lips.direction,
        target_mm=lips.target_mm,
        hold_mm=lips.threshold_mm,
        hold_s=hold_s,
        iterations=iterations,
    )
