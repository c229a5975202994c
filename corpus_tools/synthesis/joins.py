"""What a join looks like in numbers: gaps between its fragments, and how natural its motion is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from corpus_tools.core import FLAGGED, Capture, FloatArray, IntArray, Join, Trajectory, frozen
from corpus_tools.synthesis.pieces import AlignedPieces, Piece
from corpus_tools.synthesis.resampling import resample_uniform

__all__ = [
    "WINDOW_S",
    "NaturalDistribution",
    "join_gaps",
    "natural_distribution",
    "peaks_at",
    "piece_state",
    "ranked_joins",
    "rms_acceleration",
]

WINDOW_S = 0.12
"""Length of the windows whose peak acceleration is compared, s: that of the longest usual overlap."""


@dataclass(frozen=True, slots=True, eq=False)
class NaturalDistribution:
    """Peak accelerations of natural speech, sorted, to rank joins among.

    Attributes
    ----------
    peaks_mm_s2 : (n_windows,) mm/s2, ascending
        Largest rms acceleration over the columns in each window of :data:`WINDOW_S`.
    frames_p95_mm_s2 : float
        95th percentile of the acceleration of single frames, mm/s2.
    columns : (n,) int64
        Markers that were looked at.
    rate_hz : float
    """

    peaks_mm_s2: FloatArray
    frames_p95_mm_s2: float
    columns: IntArray
    rate_hz: float

    @property
    def p95_mm_s2(self) -> float:
        """The 95th percentile of the peaks, mm/s2; NaN when there are none."""
        return float(np.percentile(self.peaks_mm_s2, 95)) if len(self.peaks_mm_s2) else float("nan")

    def percentile(self, peak_mm_s2: float) -> float:
        """Return the share of natural windows whose peak lies below, in per cent; NaN when there are none."""
        if not len(self.peaks_mm_s2):
            return float("nan")
        return float(100.0 * np.searchsorted(self.peaks_mm_s2, peak_mm_s2) / len(self.peaks_mm_s2))

    def ratio(self, peak_mm_s2: float) -> float:
        """Return a peak over the natural 95th percentile; NaN when there is none or nothing moves in it."""
        p95 = self.p95_mm_s2
        return peak_mm_s2 / p95 if p95 > 0 else float("nan")


def rms_acceleration(values_mm: FloatArray, rate_hz: float) -> FloatArray:
    """Return the rms over markers of the acceleration, mm/s2, shape (n_frames,), by second differences."""
    if len(values_mm) < 3:
        return np.zeros(len(values_mm))
    second = np.diff(values_mm, n=2, axis=0) * rate_hz**2
    rms = np.sqrt((second**2).sum(axis=2).mean(axis=1))
    return np.concatenate([rms[:1], rms, rms[-1:]])


def peaks_at(
    values_mm: FloatArray, times_s: FloatArray, rate_hz: float, instants_s: Sequence[float] | FloatArray
) -> FloatArray:
    """Return the largest rms acceleration within half of :data:`WINDOW_S` of each instant, (n,) mm/s2.

    Parameters
    ----------
    values_mm : (n_frames, n_markers, 3) mm
        Of the markers that are looked at.
    times_s : (n_frames,) s
    rate_hz : float
    instants_s : (n,) s
        Such as the times of joins.
    """
    acceleration = rms_acceleration(values_mm, rate_hz)
    return np.array([acceleration[np.abs(times_s - t) <= 0.5 * WINDOW_S].max() for t in instants_s])


def _window_peaks(acceleration: FloatArray, width: int) -> FloatArray:
    n = len(acceleration) // width
    return acceleration[: n * width].reshape(n, width).max(axis=1) if n else np.zeros(0)


def natural_distribution(
    captures: Sequence[Capture],
    rate_hz: float = 120.0,
    columns: Sequence[int] | IntArray | None = None,
    spans_s: Sequence[tuple[float, float]] | None = None,
) -> NaturalDistribution:
    """Measure the accelerations of recorded speech, resampled as synthesis is.

    Parameters
    ----------
    captures : sequence of Capture
        Cleaned.
    rate_hz : float
        Rate of the synthesised motion, Hz.
    columns : sequence of int, optional
        Markers to look at; all when None.
    spans_s : sequence of (start, end), optional
        Where there is speech in each capture, s; the whole capture when None.
    """
    every_marker = range(len(captures[0].names))
    chosen = np.asarray(every_marker if columns is None else columns, dtype=np.int64)
    width = max(1, round(WINDOW_S * rate_hz))
    peaks, frames = [], []
    for index, capture in enumerate(captures):
        low, high = (capture.times_s[0], capture.times_s[-1]) if spans_s is None else spans_s[index]
        low, high = max(low, float(capture.times_s[0])), min(high, float(capture.times_s[-1]))
        times = np.arange(np.ceil(low * rate_hz), np.floor(high * rate_hz) + 1) / rate_hz
        if len(times) < width:
            continue
        values = np.asarray(capture.positions_mm)[:, chosen]
        motion, _ = resample_uniform(float(capture.times_s[0]), capture.rate_hz, values, times)
        acceleration = rms_acceleration(motion, rate_hz)
        frames.append(acceleration)
        peaks.append(_window_peaks(acceleration, width))
    every = np.concatenate([*frames, np.zeros(0)])
    p95 = float(np.percentile(every, 95)) if len(every) else float("nan")
    return NaturalDistribution(frozen(np.sort(np.concatenate([*peaks, np.zeros(0)]))), p95, chosen, rate_hz)


def ranked_joins(trajectory: Trajectory, natural: NaturalDistribution) -> tuple[Join, ...]:
    """Return the joins of a trajectory with where their peak acceleration stands among natural windows.

    Parameters
    ----------
    trajectory : Trajectory
        Blended.
    natural : NaturalDistribution

    Returns
    -------
    tuple of Join
        `natural_percentile`, 0 to 100, and `peak_ratio`, the peak over the natural 95th percentile; NaN when
        that is unknown or nothing moves in it.
    """
    values = np.asarray(trajectory.values_mm)[:, natural.columns]
    peaks = peaks_at(values, trajectory.times_s, trajectory.rate_hz, [j.time_s for j in trajectory.joins])
    return tuple(
        replace(join, natural_percentile=natural.percentile(peak), peak_ratio=natural.ratio(peak))
        for join, peak in zip(trajectory.joins, peaks.tolist(), strict=True)
    )


def piece_state(piece: Piece, frame: int, rate_hz: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return position, velocity and acceleration of a piece at a target frame, by central differences."""
    k = int(np.clip(frame - piece.start, 1, len(piece.motion_mm) - 2))
    before, here, after = piece.motion_mm[k - 1 : k + 2]
    return here, (after - before) * 0.5 * rate_hz, (after - 2 * here + before) * rate_hz**2


def _rms(difference: FloatArray) -> float:
    return float(np.sqrt((difference**2).sum(axis=1).mean()))


def _flagged(left: Piece, right: Piece, frame: int, n_frames: float) -> float:
    """Return the share of samples of both pieces within half an overlap of a frame that are flagged."""
    reach, parts = round(0.5 * n_frames), []
    for piece in (left, right):
        first = min(max(frame - reach - piece.start, 0), len(piece.flags) - 1)
        last = max(min(frame + reach - piece.start, len(piece.flags) - 1), first)
        parts.append((piece.flags[first : last + 1] & FLAGGED) > 0)
    return float(np.concatenate(parts).mean())


def join_gaps(aligned: AlignedPieces, overlaps_s: FloatArray) -> tuple[Join, ...]:
    """Return the joins of aligned pieces with the gaps between their fragments, before any blending.

    Parameters
    ----------
    aligned : AlignedPieces
    overlaps_s : (n_joins,) s
    """
    phones = aligned.utterance.phones.intervals
    joins = []
    for k, (left, right) in enumerate(zip(aligned.pieces[:-1], aligned.pieces[1:], strict=True)):
        shared = phones[left.last]
        frame = round(shared.centre_s * aligned.rate_hz)
        here = piece_state(left, frame, aligned.rate_hz)
        there = piece_state(right, frame, aligned.rate_hz)
        position, velocity, acceleration = (_rms(a - b) for a, b in zip(here, there, strict=True))
        joins.append(
            Join(
                index=k,
                time_s=shared.centre_s,
                phone=shared.text,
                left_source=left.source,
                right_source=right.source,
                overlap_s=float(overlaps_s[k]),
                gap_mm=position,
                gap_mm_s=velocity,
                gap_mm_s2=acceleration,
                flagged=_flagged(left, right, frame, float(overlaps_s[k]) * aligned.rate_hz),
            )
        )
    return tuple(joins)
