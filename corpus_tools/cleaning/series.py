"""What a gap in a few channels may have held: cosines, a process, and a process led by the other markers."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.linalg import lapack

from corpus_tools.core import BoolArray, FloatArray, IntArray

__all__ = ["fill_dct", "fill_led", "fill_process"]

MOST_ROWS = 48
"""Seen frames that are looked at, the nearest to the gap."""

MOST_LED_ROWS = 72
"""The same where the other markers lead: these frames also tell how to follow them."""

NOISES = (1e-6, 1e-4, 1e-3, 3e-2)
"""Shares of noise in the variance that are tried."""

LENGTHS_S = (0.05, 0.1, 0.2, 0.4, 0.8)
"""Memories of a process that are tried, s."""

BENDS_HZ = (0.5, 1.0, 2.0, 4.0, 8.0)
"""Frequencies that are tried beyond which the cosines of a motion grow smaller, Hz."""

SLOPES = (4, 8, 16)
"""Powers of the frequency with which they do."""

FOLLOWING = (0.0, 0.01, 0.1, 0.5)
"""Variances that are tried for what the leaders do here and not in the corpus as a whole."""

AVERAGED = 8.0
"""Log-likelihood (doubled) below the best within which models are averaged."""

Kernel = Callable[[FloatArray, float], FloatArray]


def _squared_exponential(apart_s: FloatArray, length_s: float) -> FloatArray:
    return np.asarray(np.exp(-0.5 * (apart_s / length_s) ** 2))


def _rational(apart_s: FloatArray, length_s: float) -> FloatArray:
    """Return squared exponentials of many lengths in one: motion that is now quick and now slow."""
    return np.asarray(1.0 / (1.0 + 0.5 * (apart_s / length_s) ** 2))


KERNELS: tuple[Kernel, ...] = (_squared_exponential, _rational)


def _nearest(seen: BoolArray, hidden: BoolArray, most: int = MOST_ROWS) -> IntArray:
    """Return the rows of at most `most` seen frames, the nearest to the hidden ones."""
    rows, wanted = np.flatnonzero(seen), np.flatnonzero(hidden)
    far = np.maximum(wanted[0] - rows, rows - wanted[-1])
    return np.asarray(np.sort(rows[np.argsort(far, kind="stable")[:most]]))


def _rows(seen: BoolArray, hidden: BoolArray, most: int = MOST_ROWS) -> tuple[IntArray, IntArray, IntArray]:
    """Return the rows that a filling looks at, and which of these are known and which asked for."""
    rows = np.sort(np.concatenate([_nearest(seen, hidden, most), np.flatnonzero(hidden)]))
    return rows, np.flatnonzero(~hidden[rows]), np.flatnonzero(hidden[rows])


def _likelihood(covariance: FloatArray, noise: float, values: FloatArray) -> tuple[float, float]:
    """Return twice the log-likelihood of channels, their variance profiled out, and that variance.

    `covariance` is without the noise, whose variance is added on the diagonal.
    """
    noisy = covariance.copy()
    noisy.flat[:: len(noisy) + 1] += noise
    factor, wrong = lapack.dpotrf(noisy.T, lower=1, clean=0, overwrite_a=1)
    if wrong:
        raise np.linalg.LinAlgError("the covariance of what is seen is not positive definite")
    white, _ = lapack.dtrtrs(factor, values, lower=1)
    variance = max(float((white**2).mean()), 1e-12)
    return -values.size * np.log(variance) - 2 * values.shape[1] * np.log(np.diag(factor)).sum(), variance


def _posterior(
    whole: FloatArray, noise: float, variance: float, values: FloatArray, known: IntArray, asked: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return mean (n_asked, n_channels) and variance (n_asked,) given the known rows."""
    noisy = whole[np.ix_(known, known)] + noise * np.eye(len(known))
    across = whole[np.ix_(asked, known)]
    factor = np.linalg.solve(noisy, across.T).T
    left = np.maximum(np.diag(whole)[asked] - (factor * across).sum(axis=1), 0.0)
    return factor @ values, variance * (left + noise)


def _averaged(
    covariances: Iterable[FloatArray], values: FloatArray, known: IntArray, asked: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return mean and standard deviation of the asked rows, over the likely ones of the covariances."""
    tried = []
    for whole in covariances:
        among = whole[np.ix_(known, known)]
        for noise in NOISES:
            score, variance = _likelihood(among, noise, values)
            tried.append((score, whole, noise, variance))
    best = max(score for score, *_ in tried)
    mean, square, total = (
        np.zeros((len(asked), values.shape[1])),
        np.zeros((len(asked), values.shape[1])),
        0.0,
    )
    for score, whole, noise, variance in tried:
        if score >= best - AVERAGED:
            weight = float(np.exp(0.5 * (score - best)))
            one, spread = _posterior(whole, noise, variance, values, known, asked)
            total += weight
            mean += weight * one
            square += weight * (one**2 + spread[:, None])
    mean = mean / total
    return mean, np.sqrt(np.maximum((square / total - mean**2).mean(axis=1), 1e-12))


def fill_process(
    times_s: FloatArray, values: FloatArray, seen: BoolArray, hidden: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Bridge a gap by a Gaussian process that returns to the mean.

    Its covariance is squared-exponential or rational, with the memory of :data:`LENGTHS_S` and the noise that
    explain best what is seen around the gap.

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
    rows, known, asked = _rows(seen, hidden)
    mean = values[seen].mean(axis=0)
    times, values = times_s[rows], values[rows]
    apart = np.abs(times[:, None] - times)
    covariances = (kernel(apart, length) for kernel, length in product(KERNELS, LENGTHS_S))
    filled, sd = _averaged(covariances, values[known] - mean, known, asked)
    return mean + filled, sd


@dataclass(frozen=True, slots=True)
class _Led:
    """A model of :func:`fill_led`: whether the others lead, how the rest remembers, how freely it follows."""

    led: bool
    kernel: Kernel
    length_s: float
    follow: float
    noise: float

    def covariance(self, remembered: FloatArray, alike: FloatArray) -> FloatArray:
        """Return the covariance; `remembered` is its kernel at the times."""
        return remembered + self.follow * alike if self.led and self.follow else remembered


def _first() -> list[_Led]:
    tried = product((True, False), KERNELS, LENGTHS_S, NOISES[1::2])
    return [_Led(led, kernel, length, 0.03, noise) for led, kernel, length, noise in tried]


def fill_led(
    times_s: FloatArray,
    values: FloatArray,
    seen: BoolArray,
    hidden: BoolArray,
    guess: FloatArray,
    leaders: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Bridge a gap by what the other markers say, and by a process for what they do not.

    ``value = guess + leaders @ own weights + process``: the guess is what the corpus as a whole makes of the
    others, the weights (normal, around 0) are how this marker follows them here; or ``value = process`` where
    its own motion explains itself better. The likeliest of these is taken, its memory first, then how freely
    it follows and its noise (our choice: a search in two steps tries 56 models instead of 200).

    Parameters
    ----------
    times_s, values, seen, hidden
        As of :func:`fill_process`.
    guess : (n_frames, n_channels)
    leaders : (n_frames, n_leaders)
        Weights of the posture, of variance 1.

    Returns
    -------
    As of :func:`fill_process`.
    """
    rows, known, asked = _rows(seen, hidden, MOST_LED_ROWS)
    times, values, guess, leaders = times_s[rows], values[rows], guess[rows], leaders[rows]
    apart = np.abs(times[:, None] - times)
    alike = leaders @ leaders.T / leaders.shape[1]
    alike_known, apart_known = alike[np.ix_(known, known)], apart[np.ix_(known, known)]
    kernels = {(k, length): k(apart_known, length) for k, length in product(KERNELS, LENGTHS_S)}
    rest = {True: (values - guess)[known], False: values[known]}
    means = {led: r.mean(axis=0) for led, r in rest.items()}

    def likeliest(models: Iterable[_Led]) -> tuple[_Led, float]:
        scored = []
        for model in models:
            among = model.covariance(kernels[model.kernel, model.length_s], alike_known)
            scored.append((*_likelihood(among, model.noise, rest[model.led] - means[model.led]), model))
        _, variance, model = max(scored, key=lambda row: row[0])
        return model, variance

    first, _ = likeliest(_first())
    finer = product(FOLLOWING if first.led else (0.0,), NOISES)
    model, variance = likeliest(replace(first, follow=follow, noise=noise) for follow, noise in finer)
    covariance = model.covariance(model.kernel(apart, model.length_s), alike)
    known_rest = rest[model.led] - means[model.led]
    filled, spread = _posterior(covariance, model.noise, variance, known_rest, known, asked)
    return (guess[asked] if model.led else 0.0) + means[model.led] + filled, np.sqrt(spread)


def fill_dct(
    times_s: FloatArray, values: FloatArray, seen: BoolArray, hidden: BoolArray, cutoff_hz: float
) -> tuple[FloatArray, FloatArray]:
    """Bridge a gap by the cosines below a frequency that fit what is seen best (paper A section 4).

    Least squares with a ridge, which keeps the cosines no larger than the motion is: without it a gap of
    0.4 s is filled with metres. The ridge grows with the frequency: beyond one of :data:`BENDS_HZ`, and by
    one of :data:`SLOPES`, whatever explains best what is seen (our choice: motion has less of what is fast,
    and articulators have hardly anything beyond some hertz).

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
    rows, known, asked = _rows(seen, hidden)
    cosines, values = cosines[rows], values[rows]
    mean = values[known].mean(axis=0)

    def covariance(bend_hz: float, slope: int) -> FloatArray:
        power = 1.0 / (1.0 + (hz / bend_hz) ** slope)
        return np.asarray(1.0 + (cosines * (power / power.sum() * 2.0)) @ cosines.T)

    covariances = (covariance(*setting) for setting in product(BENDS_HZ, SLOPES))
    filled, sd = _averaged(covariances, values[known] - mean, known, asked)
    return mean + filled, sd
