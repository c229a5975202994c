"""The same word said again: how far a speaker is from himself, and methods in the same frames."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from corpus_tools.core import FloatArray, IntArray
from corpus_tools.evaluate.comparison import Comparison
from corpus_tools.evaluate.metrics.error import STILL_MM
from corpus_tools.evaluate.metrics.registry import metric, root_quotient
from corpus_tools.evaluate.natural import Natural

__all__: list[str] = []

_WORDS = "lips and chin, captured frames of words that others hold between the same neighbours"


@metric("word_rmse", unit="mm", better="low", mask=_WORDS, combine=root_quotient, words_only=True)
def _error(comparison: Comparison) -> FloatArray:
    """RMSE in repeated words: sqrt(mean over frames and markers of |made - recorded|²), pooled."""
    here, columns = comparison.in_words, comparison.natural.columns
    error = comparison.made_mm[here][:, columns] - comparison.truth_mm[here][:, columns]
    seen = comparison.measured[here][:, columns]
    return np.array([((error**2).sum(axis=2) * seen).sum(), float(seen.sum())])


def _pearson(
    shares: FloatArray, counts: FloatArray, groups: IntArray, naturals: Sequence[Natural]
) -> FloatArray:
    """Return Pearson's r of pooled frames from (n, sum x, sum y, sum x x, sum y y, sum x y)."""
    known = np.asarray(np.isfinite(shares).all(axis=1))
    sums = counts @ np.where(known[:, None], shares, 0.0)
    n, x, y, xx, yy, xy = sums.T
    n = np.maximum(n, 1.0)
    above = xy / n - x / n * y / n
    below = np.sqrt(np.maximum((xx / n - (x / n) ** 2) * (yy / n - (y / n) ** 2), 0.0))
    return np.asarray(np.divide(above, below, out=np.full(len(above), np.nan), where=below > 1e-9))


@metric(
    "word_r_aperture",
    better="high",
    mask="lip aperture, captured frames of words that others hold between the same neighbours",
    combine=_pearson,
    per=0,
    words_only=True,
)
def _correlation(comparison: Comparison) -> FloatArray:
    """Pearson correlation of the lip aperture in repeated words, frames of all sentences pooled.

    A sentence in which the prediction does not move has no correlation, and does not count.
    """
    here = comparison.in_words & comparison.whole
    x, y = comparison.made_articulators[here, 0], comparison.truth_articulators[here, 0]
    if len(x) > 1 and x.std() < STILL_MM:
        return np.full(6, np.nan)
    return np.array([len(x), x.sum(), y.sum(), x @ x, y @ y, x @ y])
