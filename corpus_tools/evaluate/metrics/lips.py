"""Whether lips close where they must, as far as they do, and nowhere else."""

from __future__ import annotations

import numpy as np

from corpus_tools.core import FloatArray
from corpus_tools.evaluate.comparison import Comparison, curve_at
from corpus_tools.evaluate.metrics.registry import metric, quotient
from corpus_tools.speech import CLOSURE_WINDOW_S, lip_aperture_mm

__all__ = ["closure_minima"]


def closure_minima(comparison: Comparison) -> tuple[FloatArray, FloatArray]:
    """Return the least aperture around each bilabial, predicted and recorded, (n_bilabials,) mm each.

    Looked for within :data:`~corpus_tools.speech.CLOSURE_WINDOW_S` of the label, in frames of the prediction.
    """
    names = comparison.capture.names
    times = comparison.fine_s
    made = lip_aperture_mm(comparison.made_fine_mm, names)
    truth = lip_aperture_mm(comparison.truth_fine_mm, names)
    found = []
    for phone in comparison.recording.utterance.phones:
        if phone.text in comparison.phones.bilabials:
            low, high = phone.start_s - CLOSURE_WINDOW_S, phone.end_s + CLOSURE_WINDOW_S
            inside = (times >= low) & (times <= high)
            if inside.any():
                found.append((made[inside].min(), truth[inside].min()))
    pairs = np.array(found).reshape(-1, 2)
    return pairs[:, 0], pairs[:, 1]


@metric("bilabial_closure", better="high", mask="lip aperture around P, B, M", combine=quotient)
def _closed(comparison: Comparison) -> FloatArray:
    """Share of bilabials in which the lips close: least aperture below the natural 95th percentile of it."""
    made, _ = closure_minima(comparison)
    return np.array([float((made <= comparison.natural.closed_mm).sum()), float(len(made))])


@metric("closure_depth", unit="mm", better="low", mask="lip aperture around P, B, M", combine=quotient)
def _depth(comparison: Comparison) -> FloatArray:
    """Mean of (least aperture made - recorded) over bilabials: above 0, lips stay open too far."""
    made, truth = closure_minima(comparison)
    return np.array([(made - truth).sum(), float(len(made))])


@metric("vowel_false_closure", better="low", mask="lip aperture at the centres of vowels", combine=quotient)
def _false_closures(comparison: Comparison) -> FloatArray:
    """Share of vowels, open in the recording, at whose centre the lips are closed.

    Open: aperture above t + |t| + 0.5 mm, with t the aperture below which lips are closed.
    """
    limit = comparison.natural.closed_mm
    vowels = [p for p in comparison.recording.utterance.phones if p.text in comparison.phones.vowels]
    if not vowels or not len(comparison.fine_s):
        return np.array([0.0, 0.0])
    names = comparison.capture.names
    at = np.array([p.centre_s for p in vowels])
    truth, made = (
        curve_at(comparison.fine_s, lip_aperture_mm(motion, names), at)
        for motion in (comparison.truth_fine_mm, comparison.made_fine_mm)
    )
    is_open = truth > limit + abs(limit) + 0.5
    return np.array([float((made[is_open] <= limit).sum()), float(is_open.sum())])
