"""How well fragments fit where they are joined, against what natural speech does.

Two yardsticks: `join_peak` is a ratio to the 95th percentile of single *frames* of natural speech, as the
other accelerations are; `join_unnatural` counts peaks beyond the 95th percentile of the peaks of natural
*stretches* as long as a join, as ``natural_percentile`` of ``joins.csv`` and the page do. The row of natural
speech is the recordings themselves in the very windows in which the methods have their joins: same times,
same phones.
"""

from __future__ import annotations

import numpy as np

from corpus_tools.core import BoolArray, FloatArray
from corpus_tools.evaluate.comparison import Comparison
from corpus_tools.evaluate.metrics.registry import metric, quotient
from corpus_tools.synthesis import peaks_at

__all__ = ["join_peaks"]

_MEETING = "all face markers, where fragments meet"


def join_peaks(comparison: Comparison) -> FloatArray:
    """Return the peak rms acceleration of lips and chin around each join (or other instant), mm/s2."""
    motion, natural = comparison.prediction, comparison.natural
    values = np.asarray(motion.values_mm)[:, natural.columns]
    return peaks_at(values, motion.times_s, natural.rate_hz, comparison.instants_s)


def _summed(values: FloatArray | BoolArray | list[float]) -> FloatArray:
    return np.array([float(np.sum(values)), float(len(values))])


@metric("joins", better="", mask="")
def _count(comparison: Comparison) -> FloatArray:
    """Count the joins of a sentence."""
    return np.array([float(len(comparison.prediction.joins))])


@metric("join_peak", better="low", mask="lips and chin, 0.12 s around each join", combine=quotient)
def _peak(comparison: Comparison) -> FloatArray:
    """Mean over joins of the peak acceleration around them, over the natural 95th percentile of frames."""
    return _summed(join_peaks(comparison) / comparison.natural.acceleration_p95_mm_s2)


@metric("join_unnatural", better="low", mask="lips and chin, 0.12 s around each join", combine=quotient)
def _unnatural(comparison: Comparison) -> FloatArray:
    """Share of joins with a higher peak acceleration than 95 % of natural stretches of 0.12 s: about .05."""
    return _summed(join_peaks(comparison) > comparison.natural.stretch_p95_mm_s2)


@metric("join_gap_position", better="low", mask=_MEETING, combine=quotient)
def _gap(comparison: Comparison) -> FloatArray:
    """Mean gap of the fragments in position before blending, over the natural spread of postures."""
    return _summed([j.gap_mm / comparison.natural.face_sd_mm for j in comparison.prediction.joins])


@metric("join_gap_velocity", better="low", mask=_MEETING, combine=quotient)
def _velocity_gap(comparison: Comparison) -> FloatArray:
    """Mean gap in velocity before blending, over the natural 95th percentile of the speed in frames."""
    return _summed([j.gap_mm_s / comparison.natural.face_speed_p95_mm_s for j in comparison.prediction.joins])


@metric(
    "join_gap_acceleration", better="low", mask="all face markers, where fragments meet", combine=quotient
)
def _acceleration_gap(comparison: Comparison) -> FloatArray:
    """Mean gap in acceleration before blending, over the natural 95th percentile of it in frames."""
    scale = comparison.natural.face_acceleration_p95_mm_s2
    return _summed([j.gap_mm_s2 / scale for j in comparison.prediction.joins])
