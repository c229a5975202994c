"""From one inventory row per diphone to a selection: units, itemised costs, alternatives."""

from __future__ import annotations

import itertools

import numpy as np

from corpus_tools.core import Candidate, ChosenUnit, Costs, FloatArray, IntArray, Selection, Utterance
from corpus_tools.synthesis.backoff import Candidates
from corpus_tools.synthesis.costs import join_costs, span_costs
from corpus_tools.synthesis.model import SelectionModel
from corpus_tools.synthesis.target import JOIN_TERMS, TARGET_TERMS, Target

__all__ = ["path_cost", "path_runs", "selection_from_path"]


def path_runs(path: IntArray) -> list[tuple[int, int]]:
    """Return (first diphone, length) of each run of rows that follow one another: the units of a path."""
    breaks = np.flatnonzero(np.diff(path) != 1) + 1
    edges = [0, *breaks.tolist(), len(path)]
    return [(a, b - a) for a, b in itertools.pairwise(edges)]


def path_cost(model: SelectionModel, target: Target, path: IntArray) -> float:
    """Return the total cost of a path: every diphone and every join; what both searches minimise."""
    diphones = sum(span_costs(model, target, k, path[k : k + 1]).sum() for k in range(len(path)))
    return float(diphones + join_costs(model, target, path[:-1] + 1, path[1:]).sum())


def selection_from_path(
    model: SelectionModel,
    target: Target,
    candidates: Candidates,
    path: IntArray,
    *,
    utterance: Utterance,
    method: str,
    n_rejected: int,
    settings: dict[str, object],
) -> Selection:
    """Name the units of a path, itemise their costs and list the best of the others.

    The rejected of a unit are the cheapest others that speak the same span, costs with the join to the unit
    before. Where fewer than `n_rejected` speak the whole span, units that speak its beginning follow, the
    longest first: such a unit speaks as many phones from `first` on as it has.
    """
    chosen = []
    for first, length in path_runs(path):
        row = int(path[first])
        before = int(path[first - 1]) + 1 if first else None
        rows, lengths, terms = _ranked(model, target, candidates, (first, length, row, before), n_rejected)
        spans = zip(rows.tolist(), lengths.tolist(), strict=True)
        units = [model.inventory.unit(r, r + n) for r, n in spans]
        costs = _named(terms, target.unasked, has_join=before is not None)
        chosen.append(
            ChosenUnit(
                first=first,
                last=first + length,
                unit=units[0],
                costs=costs[0],
                backoff=_substitutions(model, target, first, row, length),
                rejected=tuple(Candidate(u, c) for u, c in zip(units[1:], costs[1:], strict=True)),
            )
        )
    return Selection(utterance.name, method, tuple(chosen), tuple(sorted(settings.items())))


def _ranked(
    model: SelectionModel,
    target: Target,
    candidates: Candidates,
    place: tuple[int, int, int, int | None],
    n_rejected: int,
) -> tuple[IntArray, IntArray, FloatArray]:
    """Rows, lengths and cost terms of the chosen unit and of the others, the longest and cheapest first."""
    first, length, row, before = place
    rows = candidates.open_rows[first]
    reach = np.minimum(candidates.open_reach[first], length)
    others = rows != row
    rows, reach = rows[others], reach[others]
    kept = [np.array([row], dtype=np.int64)]
    lengths = [np.array([length], dtype=np.int64)]
    terms = [_priced(model, target, first, kept[0], length, before)]
    wanted = n_rejected
    for n in np.unique(reach)[::-1].tolist() if wanted else ():
        same = rows[reach == n]
        table = _priced(model, target, first, same, n, before)
        best = np.argsort(table.sum(axis=1), kind="stable")[:wanted]
        kept.append(same[best])
        lengths.append(np.full(len(best), n))
        terms.append(table[best])
        wanted -= len(best)
        if wanted == 0:
            break
    return np.concatenate(kept), np.concatenate(lengths), np.concatenate(terms)


def _priced(
    model: SelectionModel, target: Target, first: int, rows: IntArray, length: int, before: int | None
) -> FloatArray:
    """Target terms, then join terms with the phone row `before` (0 where nothing comes before)."""
    terms = np.zeros((len(rows), len(TARGET_TERMS) + len(JOIN_TERMS)))
    terms[:, : len(TARGET_TERMS)] = span_costs(model, target, first, rows, length)
    if before is not None:
        terms[:, len(TARGET_TERMS) :] = join_costs(model, target, np.full(len(rows), before), rows)
    return terms


def _named(terms: FloatArray, unasked: frozenset[str], has_join: bool) -> list[Costs]:
    """Name the terms; a first unit has no join terms, and some stand only where they were asked for."""
    n = len(TARGET_TERMS)
    target = [(name, k) for k, name in enumerate(TARGET_TERMS) if name not in unasked]
    join = [(name, n + k) for k, name in enumerate(JOIN_TERMS) if has_join and name not in unasked]
    return [
        Costs(tuple((name, v[k]) for name, k in target), tuple((name, v[k]) for name, k in join))
        for v in terms.tolist()
    ]


def _substitutions(
    model: SelectionModel, target: Target, first: int, row: int, length: int
) -> tuple[tuple[int, str, str], ...]:
    spoken = model.inventory.codes[row : row + length + 1].tolist()
    phones = model.inventory.phone_set
    return tuple(
        (first + step, target.labels[first + step], phones[code])
        for step, code in enumerate(spoken)
        if phones[code] != target.labels[first + step]
    )
