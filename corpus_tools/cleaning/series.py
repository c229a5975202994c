"""What a gap in a few channels may have held, from the channels alone: two ways, with their uncertainty."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from corpus_tools.core import BoolArray, FloatArray, IntArray

__all__ = ["fill_dct", "fill_process"]

MOST_ROWS = 48
"""Seen frames that are looked at, the nearest to the gap."""

NOISES = (1e-5, 1e-3, 3e-2)
"""Shares of noise in the variance that are tried."""

LENGTHS_S = (0.05, 0.1, 0.2, 0.4)
"""Memories of a process that are tried, s."""

BENDS_HZ = (0.5, 1.0, 2.0, 4.0, 8.0)
"""Frequencies that are tried beyond which the cosines of a motion grow smaller as 1/f^2, Hz."""


def _nearest(seen: BoolArray, hidden: BoolArray) -> IntArray:
    """Return the rows of at most :data:`MOST_ROWS` seen frames, the nearest to the hidden ones."""
    rows, wanted = np.flatnonzero(seen), np.flatnonzero(hidden)
    far = np.maximum(wanted[0] - rows, rows - wanted[-1])
    return np.asarray(np.sort(rows[np.argsort(far, kind="stable")[:MOST_ROWS]]))


def _likelihood(covariance: FloatArray, values: FloatArray) -> tuple[float, float]:
    """Return the log-likelihood of channels, their variance profiled out, and that variance."""
    factor = np.linalg.cholesky(covariance)
    white = np.linalg.solve(factor, values)
    variance = max(float((white**2).mean()), 1e-12)
    return -values.size * np.log(variance) - 2 * values.shape[1] * np.log(np.diag(factor)).sum(), variance


def _conditioned(
    covariances: Iterable[FloatArray], values: FloatArray, known: IntArray, asked: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return mean and standard deviation of the asked rows, by the likeliest of the covariances."""
    best = (-np.inf, values[:0], values[:0, 0])
    for whole in covariances:
        among, across = whole[np.ix_(known, known)], whole[np.ix_(asked, known)]
        for noise in NOISES:
            noisy = among + noise * np.eye(len(known))
            score, variance = _likelihood(noisy, values)
            if score > best[0]:
                factor = np.linalg.solve(noisy, across.T).T
                left = np.maximum(np.diag(whole)[asked] - (factor * across).sum(axis=1), 0.0)
                best = (score, factor @ values, np.sqrt(variance * (left + noise)))
    return best[1], best[2]


def fill_process(
    times_s: FloatArray, values: FloatArray, seen: BoolArray, hidden: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Bridge a gap by a Gaussian process that returns to the mean.

    Its covariance is squared-exponential, with the memory of :data:`LENGTHS_S` and the noise that explain
    best what is seen around the gap.

    Parameters
    ----------
    times_s : (n_frames,) s
    values : (n_frames, n_channels)
    seen, hidden : (n_frames,) bool
        What is known, and what is asked for.

    Returns
    -------
    filled : (n_hidden, n_channels)
    sd : (n_hidden,)
        In units of the values, one for all channels.
    """
    known, asked = _nearest(seen, hidden), np.flatnonzero(hidden)
    mean = values[seen].mean(axis=0)
    apart = (times_s[:, None] - times_s) ** 2
    covariances = (np.exp(-0.5 * apart / length**2) for length in LENGTHS_S)
    filled, sd = _conditioned(covariances, values[known] - mean, known, asked)
    return mean + filled, sd


def fill_dct(
    times_s: FloatArray, values: FloatArray, seen: BoolArray, hidden: BoolArray, cutoff_hz: float
) -> tuple[FloatArray, FloatArray]:
    """Bridge a gap by the cosines below a frequency that fit what is seen best (paper A section 4).

    Least squares with a ridge, which keeps the cosines no larger than the motion is: without it a gap of
    0.4 s is filled with metres. The ridge grows with the frequency beyond the one of :data:`BENDS_HZ` that
    explains best what is seen (our choice: motion has less of what is fast).

    Parameters
    ----------
    times_s : (n_frames,) s
        Evenly spaced.
    values, seen, hidden
        As of :func:`fill_process`.
    cutoff_hz : float
        Highest frequency of the cosines, Hz.

    Returns
    -------
    As of :func:`fill_process`.
    """
    n, length_s = len(times_s), float(times_s[-1] - times_s[0]) * len(times_s) / (len(times_s) - 1)
    hz = np.arange(1, int(np.clip(2.0 * cutoff_hz * length_s, 2, n - 1)) + 1) / (2.0 * length_s)
    cosines = np.cos(np.pi * np.outer(np.arange(n) + 0.5, 2.0 * length_s * hz) / n)
    known, asked = _nearest(seen, hidden), np.flatnonzero(hidden)
    mean = values[known].mean(axis=0)

    def covariance(bend_hz: float) -> FloatArray:
        power = 1.0 / (1.0 + (hz / bend_hz) ** 4)
        return np.asarray(1.0 + (cosines * (power / power.sum() * 2.0)) @ cosines.T)

    filled, sd = _conditioned(map(covariance, BENDS_HZ), values[known] - mean, known, asked)
    return mean + filled, sd
