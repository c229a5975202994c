"""Kalman smoothing whose noise is estimated from the innovations, per channel or per principal component.

Innovations are what each sample has that the filter did not foresee. With the right noise they are white and
as large as the filter expects; the likelihood that follows (Schweppe 1965) tells which cutoff, that is which
ratio of process to measurement noise, a channel has, and how large its measurement noise is. Paper A says
"Kalman filtering" and no more: this way of estimation, and the grid, are our choice.
"""

from __future__ import annotations

import numpy as np

from corpus_tools.cleaning.kalman import filter_gains, kalman_smooth, smooth_channels
from corpus_tools.core import BoolArray, Capture, FloatArray, frozen, step

__all__ = ["CUTOFFS_HZ", "estimated_smooth", "likeliest_cutoffs", "smooth_by_components", "smooth_estimated"]

CUTOFFS_HZ = (1.0, 1.5, 2.2, 3.2, 4.5, 6.0, 8.0, 10.0, 12.5, 16.0, 20.0, 26.0)
"""Cutoffs that are tried, Hz; those above 0.45 of the frame rate are not (our choice: each is a third off the
next, and a cutoff that is that far off costs less than 0.2 dB)."""

STARTING = 3
"""Seen samples that only say where the motion begins: one for each number of the state."""

LEAST_SAMPLES = 24
"""Fewer seen samples tell nothing about noise: the cutoff in the middle of the grid is taken."""


def _likelihoods(
    values: FloatArray, seen: BoolArray, rate_hz: float, cutoff_hz: float
) -> tuple[FloatArray, FloatArray]:
    """Return twice the log-likelihood of every channel and its measurement variance, both (n_channels,)."""
    gains = filter_gains(seen, rate_hz, cutoff_hz)
    rows = np.flatnonzero(seen)
    state = np.zeros((3, values.shape[1]))
    state[0] = values[rows[0]]
    squares, logs, last = np.zeros(values.shape[1]), 0.0, int(rows[0])
    for count, k in enumerate(map(int, rows)):
        for _ in range(k - last):
            state[0] += state[1] + 0.5 * state[2]
            state[1] += state[2]
        last = k
        innovation = values[k] - state[0]
        if count >= STARTING:
            expected = 1.0 / (1.0 - gains[k, 0])
            squares += innovation**2 / expected
            logs += np.log(expected)
        state += gains[k][:, None] * innovation
    n = len(rows) - STARTING
    variance = np.maximum(squares / n, 1e-18)
    return -n * np.log(variance) - logs, variance


def likeliest_cutoffs(
    values: FloatArray, seen: BoolArray, rate_hz: float, cutoffs_hz: tuple[float, ...] = CUTOFFS_HZ
) -> tuple[FloatArray, FloatArray]:
    """Return the cutoff and the measurement noise of every channel.

    Parameters
    ----------
    values : (n_frames, n_channels)
        What stands in unseen frames is not looked at.
    seen : (n_frames,) bool
        Unseen frames are stepped over exactly: the filter expects more after them.
    rate_hz : float
    cutoffs_hz : tuple of float
        To choose from.

    Returns
    -------
    cutoff_hz : (n_channels,) Hz
    noise_sd : (n_channels,)
        In units of the values.
    """
    tried = [c for c in cutoffs_hz if c <= 0.45 * rate_hz] or [0.45 * rate_hz]
    if seen.sum() < LEAST_SAMPLES:
        middle = tried[len(tried) // 2]
        return np.full(values.shape[1], middle), np.zeros(values.shape[1])
    found = [_likelihoods(values, seen, rate_hz, cutoff) for cutoff in tried]
    best = np.argmax([likelihood for likelihood, _ in found], axis=0)
    variances = np.array([variance for _, variance in found])
    return np.array(tried)[best], np.sqrt(variances[best, np.arange(values.shape[1])])


def smooth_estimated(
    values: FloatArray, seen: BoolArray, rate_hz: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Smooth channels that share one pattern of gaps, each with its own noise and cutoff.

    Parameters
    ----------
    values, seen, rate_hz
        As of :func:`likeliest_cutoffs`.

    Returns
    -------
    smoothed : (n_frames, n_channels)
    sd : (n_frames, n_channels)
        One standard deviation of each sample.
    cutoff_hz : (n_channels,) Hz
    """
    cutoff, noise = likeliest_cutoffs(values, seen, rate_hz)
    smoothed, sd = np.empty_like(values), np.empty_like(values)
    for one in np.unique(cutoff):
        columns = np.flatnonzero(cutoff == one)
        smoothed[:, columns], variance = smooth_channels(values[:, columns], seen, rate_hz, float(one))
        sd[:, columns] = np.sqrt(variance)[:, None] * noise[columns]
    return smoothed, sd, frozen(cutoff)


def smooth_by_components(
    values: FloatArray, rate_hz: float, n_components: int = 12
) -> tuple[FloatArray, FloatArray]:
    """Smooth channels through their principal components, each with its own noise and cutoff.

    Many channels show one gesture and each its own noise: in a component the gesture stands out and little is
    taken from it. What the components leave is smoothed too, channel by channel, and put back, so that the
    motion of a single marker is not lost.

    Parameters
    ----------
    values : (n_frames, n_channels)
        Without gaps.
    rate_hz : float
    n_components : int
        At most as many as there are channels.

    Returns
    -------
    smoothed, sd : (n_frames, n_channels)
    """
    mean = values.mean(axis=0)
    centred = values - mean
    _, vectors = np.linalg.eigh(centred.T @ centred)
    basis = vectors[:, ::-1][:, : min(n_components, values.shape[1])]
    seen = np.ones(len(values), dtype=np.bool_)
    weights, weights_sd, _ = smooth_estimated(centred @ basis, seen, rate_hz)
    rest, rest_sd, _ = smooth_estimated(centred - centred @ basis @ basis.T, seen, rate_hz)
    sd = np.sqrt(weights_sd**2 @ (basis**2).T + rest_sd**2)
    return mean + weights @ basis.T + rest, sd


def estimated_smooth(
    capture: Capture, cutoff_hz: float = 10.0, by_components: bool = False
) -> tuple[Capture, FloatArray]:
    """Smooth a capture with noise and cutoff estimated from its own innovations.

    Parameters
    ----------
    capture : Capture
        Gaps that are left in it are bridged, flagged and, at the ends, held as by
        :func:`~corpus_tools.cleaning.kalman.kalman_smooth`.
    cutoff_hz : float
        Where nothing can be estimated: at the ends of what is seen of a marker, Hz.
    by_components : bool
        Through principal components instead of channel by channel.

    Returns
    -------
    Capture, sd_mm
        As of :func:`~corpus_tools.cleaning.kalman.kalman_smooth`.

    Raises
    ------
    MotionError
        No marker is seen in any frame.
    """
    base, base_sd = kalman_smooth(capture, cutoff_hz)
    raw = np.asarray(capture.positions_mm)
    seen = np.asarray(np.isfinite(raw).all(axis=2))
    positions, sd_mm = np.array(base.positions_mm), np.array(base_sd)
    if by_components:
        whole = np.where(seen[..., None], raw, positions).reshape(len(raw), -1)
        smoothed, sd = smooth_by_components(whole, capture.rate_hz)
        positions, sd_mm = smoothed.reshape(raw.shape), np.maximum(sd.reshape(raw.shape), 1e-9)
    else:
        patterns, group = np.unique(seen, axis=1, return_inverse=True)
        for index, pattern in enumerate(np.ascontiguousarray(patterns.T)):
            columns = np.flatnonzero(np.ravel(group) == index)
            if pattern.sum() >= LEAST_SAMPLES:
                inside = slice(int(np.argmax(pattern)), len(pattern) - int(np.argmax(pattern[::-1])))
                values = raw[inside][:, columns].reshape(inside.stop - inside.start, -1)
                smoothed, sd, _ = smooth_estimated(np.nan_to_num(values), pattern[inside], capture.rate_hz)
                positions[inside, columns] = smoothed.reshape(len(smoothed), -1, 3)
                sd_mm[inside, columns] = sd.reshape(len(sd), -1, 3)
    done = step("estimated_smooth", by="components" if by_components else "channels")
    return base.with_step(done, positions_mm=positions), sd_mm
