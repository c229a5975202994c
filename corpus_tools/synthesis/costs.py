"""What a unit costs in its place: timing, context, backoff and flagged frames; and what a join costs.

Paper A section 5.1.1 names two factors, "similarity in the phonetic timing to the target utterance, and
similarity of context". Place and stress, backoff, flagged frames and the join terms are our additions. Every
cost belongs to one diphone or to one join, so that a unit costs the sum of its diphones and both searches are
judged by one and the same number.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from corpus_tools.core import FloatArray, IntArray
from corpus_tools.synthesis.model import SelectionModel
from corpus_tools.synthesis.sound_joins import join_sounds
from corpus_tools.synthesis.target import JOIN_TERMS, TARGET_TERMS, Target

__all__ = ["join_costs", "join_matrix", "span_costs"]


def span_costs(
    model: SelectionModel, target: Target, first: int, rows: npt.NDArray[np.int64], length: int = 1
) -> FloatArray:
    """Cost of units that start at `rows` and speak `length` target diphones from diphone `first` on.

    Returns
    -------
    (n_rows, 6) float64
        The weighted terms of :data:`~corpus_tools.synthesis.target.TARGET_TERMS`, summed over the diphones of
        the unit.
    """
    steps = np.arange(length)
    r = rows[:, None] + steps
    k = first + steps
    codes = model.inventory.codes
    late = np.abs(model.log_durations[r] - target.log_durations[k]) * target.timing[k]
    late_next = np.abs(model.log_durations[r + 1] - target.log_durations[k + 1]) * target.timing[k + 1]
    context = target.context[k, model.left[r]] + target.context[k + 3, model.right[r]]
    backoff = target.backoff[k, codes[r]] + target.backoff[k + 1, codes[r + 1]]
    place, stress = _tabled(target.place, model.place, r, k), _tabled(target.stress, model.stress, r, k)
    terms = np.zeros((len(rows), len(TARGET_TERMS)))
    values = (late + late_next, context, place, stress, backoff, target.flagged * model.flagged[r])
    for column, term in enumerate(values):
        if term is not None:
            term.sum(axis=1, out=terms[:, column])
    return terms


def _tabled(table: FloatArray | None, codes: IntArray, r: IntArray, k: IntArray) -> FloatArray | None:
    """Return the cost of both phones of each diphone by a table of target phones and codes."""
    return None if table is None else table[k, codes[r]] + table[k + 1, codes[r + 1]]


def join_costs(
    model: SelectionModel, target: Target, left_rows: npt.NDArray[np.int64], right_rows: npt.NDArray[np.int64]
) -> FloatArray:
    """Cost of joining units whose last phones are `left_rows` to units whose first phones are `right_rows`.

    Returns
    -------
    (n, 6) float64
        The weighted terms of :data:`~corpus_tools.synthesis.target.JOIN_TERMS`; all 0 where the rows are one
        and the same: speech goes on.
    """
    joins = model.joins
    terms = np.empty((len(right_rows), len(JOIN_TERMS)))
    vectors = (
        (target.join, joins.position),
        (target.velocity, joins.velocity),
        (target.acceleration, joins.acceleration),
    )
    for column, (weight, values) in enumerate(vectors):
        terms[:, column] = weight * _lengths(values[left_rows] - values[right_rows])
    terms[:, 3] = target.aperture * np.abs(joins.aperture[left_rows] - joins.aperture[right_rows])
    if target.sound > 0:
        heard = join_sounds(model.inventory)
        terms[:, 4] = target.sound * _lengths(heard[left_rows] - heard[right_rows])
    else:
        terms[:, 4] = 0.0
    terms[:, 5] = target.each
    terms[left_rows == right_rows] = 0.0
    return terms


def _lengths(vectors: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(np.einsum("ij,ij->i", vectors, vectors)))


def join_matrix(
    model: SelectionModel, target: Target, left_rows: npt.NDArray[np.int64], right_rows: npt.NDArray[np.int64]
) -> FloatArray:
    """Total join cost of every pair, shape (n_left, n_right), as if none went on naturally."""
    joins = model.joins
    total = _distances(joins.position[left_rows], joins.position[right_rows])
    total *= target.join
    for weight, values in ((target.velocity, joins.velocity), (target.acceleration, joins.acceleration)):
        if weight > 0:
            total += weight * _distances(values[left_rows], values[right_rows])
    if target.aperture > 0:
        apart = np.subtract.outer(joins.aperture[left_rows], joins.aperture[right_rows])
        total += target.aperture * np.abs(apart, out=apart)
    if target.sound > 0:
        heard = join_sounds(model.inventory)
        total += target.sound * _distances(heard[left_rows], heard[right_rows])
    total += target.each
    return total


def _distances(a: FloatArray, b: FloatArray) -> FloatArray:
    squares = (-2.0 * a) @ b.T
    squares += np.einsum("ij,ij->i", a, a)[:, None]
    squares += np.einsum("ij,ij->i", b, b)
    np.maximum(squares, 0.0, out=squares)
    return np.asarray(np.sqrt(squares, out=squares))
