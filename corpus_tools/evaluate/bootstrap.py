"""Values and intervals over sentences: one set of resamples for all methods, so that they can be paired."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from corpus_tools.core import FloatArray, IntArray
from corpus_tools.evaluate.metrics import Metric
from corpus_tools.evaluate.natural import Natural

__all__ = ["DRAWS", "Drawn", "Estimate", "drawn_values", "estimate", "ratio", "resamples"]

DRAWS = 1000
"""Resamples of the sentences."""

LEVEL = (2.5, 97.5)
"""Percentiles of an interval: 95 %."""


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
    n : int
        Sentences that the metric says something about.
    """

    value: float
    draws: FloatArray
    n: int


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
    draws = metric.combine(shares, counts, groups, naturals)
    return Drawn(value, draws, metric.sentences(shares))


def estimate(drawn: Drawn) -> Estimate:
    """Return the value with its percentile interval."""
    known = drawn.draws[np.isfinite(drawn.draws)]
    low, high = np.percentile(known, LEVEL) if len(known) else (np.nan, np.nan)
    return Estimate(drawn.value, float(low), float(high), drawn.n)


def ratio(a: Drawn, b: Drawn) -> Estimate:
    """Return a / b, resampled together: the sentences that make both large cancel."""
    with np.errstate(divide="ignore", invalid="ignore"):
        value = a.value / b.value if b.value else float("nan")
        draws = np.asarray(a.draws / b.draws)
    return estimate(Drawn(value, np.where(np.isfinite(draws), draws, np.nan), min(a.n, b.n)))
