"""Kalman smoothing of marker trajectories (paper A section 4): noise out, short gaps bridged, doubt kept."""

from __future__ import annotations

import functools

import numpy as np
import numpy.typing as npt

from corpus_tools.cleaning.gaps import frame_ranges
from corpus_tools.core import BoolArray, Capture, FloatArray, FrameFlag, IntArray, MotionError, frozen, step

__all__ = [
    "DOUBTFUL_GAP_S",
    "filter_gains",
    "kalman_smooth",
    "measurement_sd_mm",
    "process_noise",
    "smooth_channels",
]

DOUBTFUL_GAP_S = 0.1
"""A gap longer than this is bridged but marked doubtful (our choice: a lip closure can hide in it)."""

_TRANSITION = np.array([[1.0, 1.0, 0.5], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]])
"""Constant acceleration over one frame; time counted in frames."""


def process_noise(rate_hz: float, cutoff_hz: float) -> FloatArray:
    """Return the process covariance (3, 3) of a constant-acceleration model for unit measurement noise.

    White jerk of spectral density q gives the smoother the response ``1 / (1 + (f / cutoff)^6)`` when
    ``q = (2 pi cutoff)^6 dt``: with the cutoff fixed the gains do not depend on the measurement noise
    (our choice: the paper says "Kalman filtering" and no more). Time is counted in frames, so that position,
    velocity and acceleration are numbers of one size and the recursion stays well conditioned.
    """
    q = (2 * np.pi * cutoff_hz / rate_hz) ** 6
    return q * np.array([[1 / 20, 1 / 8, 1 / 6], [1 / 8, 1 / 3, 1 / 2], [1 / 6, 1 / 2, 1.0]])


def _prior(rate_hz: float, cutoff_hz: float) -> FloatArray:
    """Return the covariance of the first state before anything is seen: as good as no knowledge."""
    omega = 2 * np.pi * cutoff_hz / rate_hz
    return 1e8 * np.diag([1.0, omega**2, omega**4])


def _updated(p: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return gain (3,) and covariance after a measurement; Joseph form: stays symmetric and positive."""
    gain = p[:, 0] / (p[0, 0] + 1.0)
    keep = np.eye(3)
    keep[:, 0] -= gain
    return gain, keep @ p @ keep.T + np.outer(gain, gain)


def _settled(now: FloatArray, before: FloatArray) -> bool:
    return bool(np.abs(now - before).max() <= 1e-14 * np.abs(now).max())


def _forward(
    seen: BoolArray, prior: FloatArray, noise: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, list[tuple[int, int]]]:
    """Return gains, predicted and filtered covariances, and the runs in which they no longer change."""
    n = len(seen)
    gains, predicted, filtered = np.zeros((n, 3)), np.zeros((n, 3, 3)), np.zeros((n, 3, 3))
    ends = np.append(np.flatnonzero(np.diff(seen.astype(np.int8))) + 1, n)
    steady = []
    p, k = prior, 0
    while k < n:
        if k:
            p = _TRANSITION @ p @ _TRANSITION.T + noise
        predicted[k] = p
        if seen[k]:
            gains[k], p = _updated(p)
        filtered[k] = p
        if k and seen[k] and seen[k - 1] and _settled(p, filtered[k - 1]):
            end = int(ends[np.searchsorted(ends, k, side="right")])
            gains[k:end], predicted[k:end], filtered[k:end] = gains[k], predicted[k], p
            steady.append((k, end))
            k = end - 1
        k += 1
    return gains, predicted, filtered, steady


def _backward(
    predicted: FloatArray, filtered: FloatArray, back: FloatArray, steady: list[tuple[int, int]]
) -> FloatArray:
    """Return the smoothed position variances (n,), stepping over what no longer changes."""
    n = len(filtered)
    variance = np.zeros(n)
    smooth = filtered[-1]
    variance[-1] = smooth[0, 0]
    runs = list(steady)
    k = n - 2
    while k >= 0:
        before = smooth
        smooth = filtered[k] + back[k] @ (smooth - predicted[k + 1]) @ back[k].T
        variance[k] = smooth[0, 0]
        while runs and k < runs[-1][0]:
            runs.pop()
        if runs and k < runs[-1][1] - 1 and _settled(smooth, before):
            variance[runs[-1][0] : k] = smooth[0, 0]
            k = runs[-1][0]
        k -= 1
    return variance


@functools.lru_cache(maxsize=32)
def _gains(pattern: bytes, rate_hz: float, cutoff_hz: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return filter gains (n, 3), smoother gains (n, 3, 3) and smoothed variances (n,) of a pattern of gaps.

    They depend on nothing else, so recordings of one length without gaps share one computation. The recursion
    is exact up to the frame where the covariance repeats itself to rounding; from there to the next gap it is
    copied (which is what "steady-state" filters use throughout, gaps and ends included).
    """
    seen = np.frombuffer(pattern, dtype=np.bool_)
    noise = process_noise(rate_hz, cutoff_hz)
    gains, predicted, filtered, steady = _forward(seen, _prior(rate_hz, cutoff_hz), noise)
    back = np.zeros_like(filtered)
    back[:-1] = np.linalg.solve(predicted[1:], _TRANSITION @ filtered[:-1]).transpose(0, 2, 1)
    variance = _backward(predicted, filtered, back, steady)
    # at the edge of a gap of many seconds differences of huge numbers are rounded to anything, below 0 too
    variance = np.maximum(variance, variance[seen & (variance > 0)].min())
    return frozen(gains), frozen(back), frozen(variance)


def filter_gains(seen: BoolArray, rate_hz: float, cutoff_hz: float) -> FloatArray:
    """Return the gains (n_frames, 3) of the filter for a pattern of gaps; 0 where nothing is seen."""
    return _gains(np.ascontiguousarray(seen).tobytes(), rate_hz, cutoff_hz)[0]


def smooth_channels(
    values: FloatArray, seen: BoolArray, rate_hz: float, cutoff_hz: float
) -> tuple[FloatArray, FloatArray]:
    """Smooth channels that share one pattern of gaps by an exact Rauch-Tung-Striebel pass.

    Parameters
    ----------
    values : (n_frames, n_channels)
        What stands in unseen frames is not looked at.
    seen : (n_frames,) bool
        At least one frame is seen.
    rate_hz, cutoff_hz : float

    Returns
    -------
    smoothed : (n_frames, n_channels)
    variance : (n_frames,)
        Of the smoothed position, in units of the measurement variance; they depend on the gaps only,
        so all channels share them.
    """
    gains, back, variance = _gains(np.ascontiguousarray(seen).tobytes(), rate_hz, cutoff_hz)
    n, channels = values.shape
    states = np.empty((n, 3, channels))
    x = np.zeros((3, channels))
    x[0] = values[int(np.argmax(seen))]
    for k in range(n):
        if k:
            x = _TRANSITION @ x
        if seen[k]:
            x = x + gains[k][:, None] * (values[k] - x[0])
        states[k] = x
    for k in range(n - 2, -1, -1):
        states[k] += back[k] @ (states[k + 1] - _TRANSITION @ states[k])
    return states[:, 0].copy(), variance


def measurement_sd_mm(positions_mm: FloatArray) -> FloatArray:
    """Return the noise of each channel, mm: (n_markers, 3), from third differences.

    For white noise the third difference has 20 times its variance; the median absolute deviation keeps the
    motion itself out (our choice; an upper bound where the motion is fast against the frame rate).
    """
    if len(positions_mm) < 5:
        return np.zeros(positions_mm.shape[1:])
    third = np.abs(np.diff(positions_mm, n=3, axis=0))
    finite = np.where(np.isfinite(third), third, np.nan)
    counted = np.isfinite(finite).sum(axis=0) > 0
    safe = np.where(counted[None], finite, 0.0)
    return np.asarray(np.nanmedian(safe, axis=0) / 0.6745 / np.sqrt(20.0))


def _mark_gaps(
    flags: npt.NDArray[np.uint8],
    smoothed: FloatArray,
    columns: IntArray,
    seen: BoolArray,
    rate_hz: float,
) -> None:
    """Flag filled frames; hold the nearest seen pose in gaps at either end, where nothing can be bridged."""
    n = len(seen)
    for a, b in frame_ranges(~seen):
        mark = FrameFlag.FILLED
        if a == 0 or b == n - 1 or (b - a + 1) / rate_hz > DOUBTFUL_GAP_S:
            mark |= FrameFlag.DOUBTFUL
        block = np.ix_(np.arange(a, b + 1), columns)
        flags[block] = (flags[block] & (FrameFlag.DOUBTFUL | FrameFlag.OUTLIER)) | mark
        if a == 0:
            smoothed[a : b + 1, columns] = smoothed[b + 1, columns]
        elif b == n - 1:
            smoothed[a : b + 1, columns] = smoothed[a - 1, columns]


def kalman_smooth(
    capture: Capture, cutoff_hz: float = 10.0, measurement_sd: FloatArray | float | None = None
) -> tuple[Capture, FloatArray]:
    """Smooth a capture and bridge its gaps.

    Parameters
    ----------
    capture : Capture
        NaN where a marker is missing; one that is missing throughout stays at the centroid of the others.
    cutoff_hz : float
        Frequency that is kept to one half, Hz; at most 0.45 of the frame rate is used.
    measurement_sd : float or (n_markers, 3), optional
        Noise of the samples, mm; estimated by :func:`measurement_sd_mm` when not given. It scales the
        uncertainty only: the motion depends on the cutoff.

    Returns
    -------
    Capture
        Without NaN. Filled frames are flagged; gaps at an end, or long ones, doubtful too.
    sd_mm : (n_frames, n_markers, 3)
        One standard deviation of each sample, mm.

    Raises
    ------
    MotionError
        No marker is seen in any frame.
    """
    positions = np.asarray(capture.positions_mm)
    assert capture.flags is not None
    flags = np.array(capture.flags)
    seen = np.isfinite(positions).all(axis=2)
    if not seen.any():
        raise MotionError(
            "The capture shows no marker in any frame: there is nothing to smooth; check the file."
        )
    cutoff = min(cutoff_hz, 0.45 * capture.rate_hz)
    smoothed = np.zeros_like(positions)
    noise = measurement_sd_mm(positions) if measurement_sd is None else np.asarray(measurement_sd, float)
    sd_mm = np.broadcast_to(noise, positions.shape).copy()
    patterns, group = np.unique(seen, axis=1, return_inverse=True)
    group = np.ravel(group)
    for index in range(patterns.shape[1]):
        columns = np.flatnonzero(group == index)
        pattern = np.ascontiguousarray(patterns[:, index])
        if not pattern.any():
            smoothed[:, columns] = np.nanmean(positions, axis=(0, 1))
            flags[:, columns] = FrameFlag.FILLED | FrameFlag.DOUBTFUL
            continue
        values = positions[:, columns].reshape(len(positions), -1)
        result, variance = smooth_channels(values, pattern, capture.rate_hz, cutoff)
        smoothed[:, columns] = result.reshape(len(positions), -1, 3)
        sd_mm[:, columns] *= np.sqrt(variance)[:, None, None]
        _mark_gaps(flags, smoothed, columns, pattern, capture.rate_hz)
    done = step("kalman_smooth", cutoff_hz=cutoff, model="constant acceleration, RTS")
    return capture.with_step(done, positions_mm=smoothed, flags=flags), sd_mm
