"""Values and intervals over sentences: one set of resamples for all methods, so that they can be paired.

Means over sentences, quotients of sums and correlations of pooled frames get the percentile interval of the
bootstrap. A distance of distributions cannot: sentences that are drawn twice make a resample narrower than
speech, so that every draw lies further away than all sentences together, and percentiles (and, reflected, the
basic interval) leave out the estimate itself; BCa has no correction for draws that all lie on one side. It
gets a jackknife interval instead: each sentence is left out once, and the spread of the logarithms of what
comes out (our choice: a distance is never negative) is the standard error.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from corpus_tools.core import FloatArray, IntArray
from corpus_tools.evaluate.metrics import Metric
from corpus_tools.evaluate.natural import Natural

__all__ = ["DRAWS", "Drawn", "Estimate", "drawn_values", "estimate", "jackknife_sd", "ratio", "resamples"]

DRAWS = 1000
"""Resamples of the sentences."""

LEVEL = (2.5, 97.5)
"""Percentiles of an interval: 95 %."""

_NORMAL_95 = 1.959964


@dataclass(frozen=True, slots=True)
class Estimate:
    """A value with its 95 % interval, and how many sentences it speaks for."""

    value: float
    low: float
    high: float
    n: int


@dataclass(frozen=True, slots=True, eq=False)
class Drawn:
    """A metric of a method: over all sentences, and over every resample.

    Attributes
    ----------
    value : float
    draws : (n_draws,)
        Empty where the jackknife says the interval.
    n : int
        Sentences that the metric says something about.
    deleted : (n_sentences,), optional
        The metric with one sentence left out each time; None where the bootstrap says the interval.
    groups : (n_sentences,) int64, optional
        Folds of `deleted`.
    """

    value: float
    draws: FloatArray
    n: int
    deleted: FloatArray | None = None
    groups: IntArray | None = None


def resamples(groups: IntArray, seed: int = 0, n_draws: int = DRAWS) -> FloatArray:
    """Return how often each sentence is drawn, (n_draws, n_sentences).

    Sentences are drawn with replacement within their fold, so that every resample has folds of equal size.
    """
    rng = np.random.default_rng([seed, 1])
    counts = np.zeros((n_draws, len(groups)))
    for group in np.unique(groups):
        members = np.flatnonzero(groups == group)
        picks = rng.integers(len(members), size=(n_draws, len(members)))
        for draw in range(n_draws):
            counts[draw, members] = np.bincount(picks[draw], minlength=len(members))
    return counts


def drawn_values(
    metric: Metric, shares: FloatArray, counts: FloatArray, groups: IntArray, naturals: Sequence[Natural]
) -> Drawn:
    """Return a metric over all sentences and over every resample.

    Parameters
    ----------
    metric : Metric
    shares : (n_sentences, k)
        NaN for a sentence that the method or the metric has nothing for.
    counts : (n_draws, n_sentences)
    groups : (n_sentences,) int64
    naturals : sequence of Natural
        One per group.
    """
    once = np.ones((1, len(shares)))
    value = float(metric.combine(shares, once, groups, naturals)[0])
    if metric.interval == "jackknife":
        deleted = metric.combine(shares, 1.0 - np.eye(len(shares)), groups, naturals)
        return Drawn(value, np.zeros(0), metric.sentences(shares), deleted, groups)
    draws = metric.combine(shares, counts, groups, naturals)
    return Drawn(value, draws, metric.sentences(shares))


def jackknife_sd(deleted: FloatArray, groups: IntArray) -> float:
    """Return the standard error of a statistic from its values with one sentence left out.

    ::

        sqrt(sum over folds of (n - 1) / n * sum over its n sentences of (value - mean of the fold)^2)

    Parameters
    ----------
    deleted : (n_sentences,)
        NaN where nothing is left: it does not count.
    groups : (n_sentences,) int64
        Folds, within which sentences are exchanged.
    """
    total = 0.0
    for group in np.unique(groups):
        mine = deleted[(groups == group) & np.isfinite(deleted)]
        if len(mine) > 1:
            total += (len(mine) - 1) / len(mine) * float(((mine - mine.mean()) ** 2).sum())
    return float(np.sqrt(total))


def _jackknife(drawn: Drawn, deleted: FloatArray, groups: IntArray) -> Estimate:
    """Return the value with value / f and value * f, f of the spread of logarithms."""
    if not np.isfinite(drawn.value) or drawn.value <= 0.0:
        return Estimate(drawn.value, drawn.value, drawn.value, drawn.n)
    logs = np.log(np.where(deleted > 0, deleted, np.nan))
    factor = float(np.exp(_NORMAL_95 * jackknife_sd(logs, groups)))
    return Estimate(drawn.value, drawn.value / factor, drawn.value * factor, drawn.n)


def estimate(drawn: Drawn) -> Estimate:
    """Return the value with its interval: percentiles, or the jackknife where sentences were left out."""
    if drawn.deleted is not None and drawn.groups is not None:
        return _jackknife(drawn, drawn.deleted, drawn.groups)
    known = drawn.draws[np.isfinite(drawn.draws)]
    low, high = np.percentile(known, LEVEL) if len(known) else (np.nan, np.nan)
    return Estimate(drawn.value, float(low), float(high), drawn.n)


def ratio(a: Drawn, b: Drawn) -> Estimate:
    """Return a / b, sentences drawn or left out in both together: those that make both large cancel."""
    with np.errstate(divide="ignore", invalid="ignore"):
        value, n = a.value / b.value if b.value else float("nan"), min(a.n, b.n)
        if a.deleted is not None and b.deleted is not None:
            return estimate(Drawn(value, np.zeros(0), n, a.deleted / b.deleted, a.groups))
        draws = np.asarray(a.draws / b.draws)
    return estimate(Drawn(value, np.where(np.isfinite(draws), draws, np.nan), n))
