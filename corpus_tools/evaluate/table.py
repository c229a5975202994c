"""The tables of an evaluation: methods by metrics with intervals, sentences, paired ratios."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from corpus_tools.evaluate.bootstrap import Drawn, Estimate, drawn_values, estimate, ratio, resamples
from corpus_tools.evaluate.metrics import METRICS
from corpus_tools.evaluate.metrics.registry import mean_of_sentences
from corpus_tools.evaluate.runner import NATURAL, REPETITION, Evaluation

__all__ = ["PAIRED", "Table", "sentence_rows", "tabulate"]

PAIRED = (
    "rmse",
    "rmse_centred",
    "rmse_face",
    "r_aperture",
    "r_width",
    "r_protrusion",
    "r_jaw",
    "dtw",
    "dynamic_range",
    "frechet",
    "bilabial_closure",
    "acceleration_p95",
    "join_peak",
    "word_rmse",
    "word_r_aperture",
)
"""Metrics by which methods are set against each other."""


SMALLEST_SCALE = 1e-6


@dataclass(frozen=True, slots=True)
class Table:
    """Values of every metric of every method.

    Attributes
    ----------
    methods : tuple of str
    n_sentences : int
    values : dict of (method, metric) -> Estimate
    ratios : dict of (method, other method, metric) -> Estimate
        Of the two values, over the same resamples.
    """

    methods: tuple[str, ...]
    n_sentences: int
    values: dict[tuple[str, str], Estimate]
    ratios: dict[tuple[str, str, str], Estimate]


def _is_scale(found: Drawn | None) -> bool:
    """Whether something can be divided by a value: one that is 0 but for rounding is no scale."""
    return found is not None and abs(found.value) > SMALLEST_SCALE


def tabulate(evaluation: Evaluation, seed: int = 0) -> Table:
    """Return values with 95 % intervals over sentences, and paired ratios of all methods."""
    counts = resamples(evaluation.groups, seed)
    drawn: dict[tuple[str, str], Drawn] = {}
    for key, shares in evaluation.shares.items():
        found = drawn_values(METRICS[key[1]], shares, counts, evaluation.groups, evaluation.naturals)
        if np.isfinite(found.value):
            drawn[key] = found
    ratios = {
        (a, b, metric): ratio(drawn[a, metric], drawn[b, metric])
        for metric in PAIRED
        for a, b in permutations(evaluation.methods, 2)
        if a not in (NATURAL, REPETITION) and (a, metric) in drawn and _is_scale(drawn.get((b, metric)))
    }
    return Table(
        evaluation.methods,
        len(evaluation.sentences),
        {key: estimate(found) for key, found in drawn.items()},
        {key: found for key, found in ratios.items() if np.isfinite(found.value)},
    )


def sentence_rows(evaluation: Evaluation) -> Iterator[tuple[str, int, str, str, float]]:
    """Yield (sentence, fold, method, metric, value) where a single sentence has a value of its own."""
    for (method, name), shares in evaluation.shares.items():
        metric = METRICS[name]
        if metric.combine is not mean_of_sentences and shares.shape[1] != 2:
            continue
        for sentence, group, share in zip(evaluation.sentences, evaluation.groups, shares, strict=True):
            once = np.ones((1, 1))
            value = metric.combine(share[None], once, np.zeros(1, np.int64), evaluation.naturals[:1])[0]
            if np.isfinite(value):
                yield sentence, int(group) + 1, method, name, float(value)
