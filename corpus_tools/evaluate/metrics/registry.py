"""Metrics by id: what a sentence contributes, and how sentences are put together.

A metric turns a :class:`~corpus_tools.evaluate.comparison.Comparison` into a short row of numbers, its
*share*; a value for many sentences is a function of their shares and of how often each is counted. So a mean
over sentences, a quotient of sums and a distance of distributions are resampled by the same bootstrap.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from corpus_tools.core import FloatArray, IntArray, Registry
from corpus_tools.evaluate.comparison import Comparison
from corpus_tools.evaluate.natural import Natural

__all__ = ["METRICS", "Combine", "Metric", "mean_of_sentences", "metric", "quotient", "root_quotient"]

Share = Callable[[Comparison], FloatArray]
Combine = Callable[[FloatArray, FloatArray, IntArray, Sequence[Natural]], FloatArray]
"""``combine(shares (n_sentences, k), counts (n_draws, n_sentences), group of each, natural of each group)``
returns one value per draw, (n_draws,); rows of NaN are sentences that the metric says nothing about."""


@dataclass(frozen=True, slots=True)
class Metric:
    """A number that says one thing about a method.

    Attributes
    ----------
    name : str
        Id, as in tables.
    unit : str
        Empty for a ratio.
    better : {"low", "high", "one", ""}
        What is wished for; "one": as in natural speech.
    mask : str
        The markers and frames that it looks at.
    share : callable
        ``share(comparison) -> (k,)``.
    combine : callable
    per : int or None
        The number of a share that says how much is in it: a sentence with 0 there does not count. None: every
        sentence counts whose share is a number.
    words_only : bool
        It looks at repeated words only, so that a natural repetition can be measured by it too.
    interval : {"bootstrap", "jackknife"}
        How its 95 % interval is found; "jackknife" where resampling itself makes the value larger.
    """

    name: str
    unit: str
    better: str
    mask: str
    share: Share
    combine: Combine
    per: int | None = None
    words_only: bool = False
    interval: str = "bootstrap"

    @property
    def summary(self) -> str:
        """The first line of the docstring of the formula."""
        return (self.share.__doc__ or "").strip().splitlines()[0]

    def sentences(self, shares: FloatArray) -> int:
        """Return of how many sentences shares (n_sentences, k) tell anything."""
        known = np.asarray(np.isfinite(shares).all(axis=1))
        if self.per is not None:
            known &= shares[:, self.per] > 0
        return int(known.sum())


METRICS: Registry[Metric] = Registry("metric")


def mean_of_sentences(
    shares: FloatArray, counts: FloatArray, groups: IntArray, naturals: Sequence[Natural]
) -> FloatArray:
    """Return the mean of the sentences' values; a sentence without one does not count."""
    known = np.isfinite(shares[:, 0])
    return _divided(counts @ np.where(known, shares[:, 0], 0.0), counts @ known.astype(np.float64))


def quotient(
    shares: FloatArray, counts: FloatArray, groups: IntArray, naturals: Sequence[Natural]
) -> FloatArray:
    """Return the sum of the first numbers over the sum of the second."""
    known = np.asarray(np.isfinite(shares).all(axis=1))
    sums = counts @ np.where(known[:, None], shares, 0.0)
    return _divided(sums[:, 0], sums[:, 1])


def root_quotient(
    shares: FloatArray, counts: FloatArray, groups: IntArray, naturals: Sequence[Natural]
) -> FloatArray:
    """Return the square root of :func:`quotient`."""
    return np.asarray(np.sqrt(quotient(shares, counts, groups, naturals)))


def _divided(above: FloatArray, below: FloatArray) -> FloatArray:
    return np.asarray(np.divide(above, below, out=np.full(len(above), np.nan), where=below > 0))


def metric(
    name: str,
    *,
    unit: str = "",
    better: str,
    mask: str,
    combine: Combine = mean_of_sentences,
    per: int | None = None,
    words_only: bool = False,
    interval: str = "bootstrap",
) -> Callable[[Share], Share]:
    """Return a decorator that enters a share as a metric; its docstring holds the formula."""

    def enter(share: Share) -> Share:
        amount = 1 if combine in (quotient, root_quotient) else per
        METRICS.add(name, Metric(name, unit, better, mask, share, combine, amount, words_only, interval))
        return share

    return enter
