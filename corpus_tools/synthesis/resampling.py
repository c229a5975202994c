"""Resampling of fragments by radial basis functions of time (paper A section 5.1.2, eq. (1))."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import lapack, lu_factor, lu_solve

from corpus_tools.core import FloatArray, SynthesisError

__all__ = ["COND_LIMIT", "TimeRbf", "fit_time_rbf", "fit_uniform_rbf", "resample_uniform"]

COND_LIMIT = 1e12
"""Condition number above which an interpolant is refused."""

BLOCK = 512
BLOCK_MARGIN = 64


@dataclass(frozen=True, slots=True, eq=False)
class TimeRbf:
    """An inverse-multiquadric interpolant with a linear polynomial: eq. (1) of paper A over time.

    ``f(t) = a + b x + sum_i alpha_i / sqrt(1 + (eps |t - c_i|)^2)``, with x the time scaled to [-1, 1].

    Attributes
    ----------
    centres_s : (n,) s
    weights : (n + 2, ...) float64
        alpha, then a and b.
    eps_hz : float
    cond : float
        Estimated condition number (1-norm) of the system that was solved.
    """

    centres_s: FloatArray
    weights: FloatArray
    eps_hz: float
    cond: float

    def __call__(self, times_s: FloatArray) -> FloatArray:
        """Return values at `times_s`, shape (n_times, ...)."""
        t = np.asarray(times_s, dtype=np.float64)
        kernel = 1.0 / np.sqrt(1.0 + (self.eps_hz * (t[:, None] - self.centres_s[None])) ** 2)
        basis = np.concatenate([kernel, _polynomial(t, self.centres_s)], axis=1)
        flat = self.weights.reshape(len(self.weights), -1)
        return np.asarray((basis @ flat).reshape(len(t), *self.weights.shape[1:]))


def _polynomial(t: FloatArray, centres: FloatArray) -> FloatArray:
    middle, half = 0.5 * (centres[0] + centres[-1]), 0.5 * (centres[-1] - centres[0])
    return np.stack([np.ones_like(t), (t - middle) / half], axis=1)


def _factor(centres: FloatArray, eps: float) -> tuple[Any, float]:
    n = len(centres)
    system = np.zeros((n + 2, n + 2))
    system[:n, :n] = 1.0 / np.sqrt(1.0 + (eps * (centres[:, None] - centres[None])) ** 2)
    system[:n, n:] = _polynomial(centres, centres)
    system[n:, :n] = system[:n, n:].T
    factors = lu_factor(system)
    reciprocal, _ = lapack.dgecon(factors[0], np.abs(system).sum(0).max())
    cond = 1.0 / max(float(reciprocal), 1e-300)
    if cond > COND_LIMIT:
        raise SynthesisError(
            f"Resampling {n} samples is ill-conditioned (condition number {cond:.1e}): "
            "raise alignment.shape_c in the config, or use resampling = 'inverse'."
        )
    return factors, cond


@functools.lru_cache(maxsize=128)
def _uniform_factor(n: int, c: float) -> tuple[Any, float]:
    """Return the factors for n samples one unit of time apart: the same for every fragment of that length."""
    return _factor(np.arange(n, dtype=np.float64), c)


def _solve(factors: Any, values: FloatArray) -> FloatArray:
    flat = np.asarray(values, dtype=np.float64).reshape(len(values), -1)
    right = np.concatenate([flat, np.zeros((2, flat.shape[1]))])
    return np.asarray(lu_solve(factors, right).reshape(len(values) + 2, *np.shape(values)[1:]))


def fit_uniform_rbf(start_s: float, rate_hz: float, values: FloatArray, c: float = 0.2) -> TimeRbf:
    """Fit uniform samples: the well-posed way, whose factors are kept per length.

    Parameters
    ----------
    start_s : float
        Time of the first sample, s.
    rate_hz : float
    values : (n, ...) float64
        At least 2 samples.
    c : float
        Shape: eps = c * rate. For 400 samples the condition number is 7e10 at .15, 4e8 at .2, 3e6 at .3.

    Raises
    ------
    SynthesisError
        The system is ill-conditioned (c too small).
    """
    factors, cond = _uniform_factor(len(values), float(c))
    centres = start_s + np.arange(len(values)) / rate_hz
    return TimeRbf(centres, _solve(factors, values), c * rate_hz, cond)


def resample_uniform(
    start_s: float, rate_hz: float, values: FloatArray, times_s: FloatArray, c: float = 0.2
) -> tuple[FloatArray, float]:
    """Fit uniform samples and read them at `times_s`; long recordings in blocks, so that cost stays linear.

    A block reaches :data:`BLOCK_MARGIN` samples beyond the times that are read from it; what is read differs
    from one fit of all samples by less than 1e-4 of their range with c = 0.2 (our measurement).

    Parameters
    ----------
    start_s, rate_hz, values, c
        As of :func:`fit_uniform_rbf`.
    times_s : (n_times,) s
        Increasing, within the samples.

    Returns
    -------
    values : (n_times, ...) float64
    cond : float
        The largest condition number of the systems solved.
    """
    n = len(values)
    if n <= BLOCK + 2 * BLOCK_MARGIN:
        curve = fit_uniform_rbf(start_s, rate_hz, values, c)
        return curve(times_s), curve.cond
    block_of = np.clip((times_s - start_s) * rate_hz // BLOCK, 0, (n - 1) // BLOCK).astype(np.int64)
    read, cond = [], 0.0
    for block in np.unique(block_of):
        low = max(0, min(int(block) * BLOCK - BLOCK_MARGIN, n - BLOCK - 2 * BLOCK_MARGIN))
        part = values[low : low + BLOCK + 2 * BLOCK_MARGIN]
        curve = fit_uniform_rbf(start_s + low / rate_hz, rate_hz, part, c)
        read.append(curve(times_s[block_of == block]))
        cond = max(cond, curve.cond)
    return np.concatenate([*read, np.zeros((0, *values.shape[1:]))]), cond


def fit_time_rbf(times_s: FloatArray, values: FloatArray, c: float = 0.2) -> TimeRbf:
    """Fit scattered samples, as printed: one centre at each warped sample.

    The shape follows the smallest spacing, eps = c / min(diff(times)) (our choice; the mean spacing fails
    after uneven warps). Samples closer than a tenth of the median spacing are merged.

    Parameters
    ----------
    times_s : (n,) s
        Increasing.
    values : (n, ...) float64
    c : float

    Raises
    ------
    SynthesisError
        The system is ill-conditioned.
    """
    t = np.asarray(times_s, dtype=np.float64)
    least = 0.1 * float(np.median(np.diff(t)))
    keep = [0]
    for i in range(1, len(t)):
        if t[i] - t[keep[-1]] >= least:
            keep.append(i)
    t, kept = t[keep], np.asarray(values)[keep]
    eps = c / float(np.diff(t).min())
    factors, cond = _factor(t, eps)
    return TimeRbf(t, _solve(factors, kept), eps, cond)
