"""The cheapest path through the inventory: target costs and join costs together (beyond paper A)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from corpus_tools.core import FloatArray, InputError, IntArray, Selection, UnitRef, Utterance
from corpus_tools.synthesis.backoff import Candidates, Pin, find_candidates, run_lengths
from corpus_tools.synthesis.chosen import selection_from_path
from corpus_tools.synthesis.costs import join_matrix, span_costs
from corpus_tools.synthesis.greedy import greedy_path
from corpus_tools.synthesis.model import SelectionModel
from corpus_tools.synthesis.target import Target, prepare_target

__all__ = ["select_viterbi", "viterbi_path"]

TYPICAL_JOIN = 0.5
"""Join avoided by one more diphone of natural run, in units of the spread of postures; only ranks candidates
for pruning (our choice: the least loss against the unpruned search on simulated corpora)."""


def viterbi_path(
    model: SelectionModel, target: Target, candidates: Candidates, prune: int | None = 100
) -> IntArray:
    """Choose one inventory row per diphone so that the total cost is least.

    Candidates are pruned by target cost minus a bonus for each diphone that goes on naturally. The rows of
    the longest-first path always stay, so that the result is never dearer than :func:`greedy_path`.

    Parameters
    ----------
    model, target, candidates
    prune : int, optional
        Candidates kept per diphone; all when None.
    """
    costs = [span_costs(model, target, k, rows).sum(axis=1) for k, rows in enumerate(candidates.rows)]
    rows: Sequence[IntArray] = candidates.rows
    if prune is not None and max(len(r) for r in rows) > prune:
        rows, costs = _pruned(model, target, candidates, costs, prune)
    total, pointers = costs[0], []
    for k in range(1, target.n_diphones):
        total, pointer = _advance(model, target, rows[k - 1], rows[k], total)
        total = total + costs[k]
        pointers.append(pointer)
    best = int(total.argmin())
    path = [int(rows[-1][best])]
    for k in range(target.n_diphones - 2, -1, -1):
        best = int(pointers[k][best])
        path.append(int(rows[k][best]))
    return np.array(path[::-1], dtype=np.int64)


def _advance(
    model: SelectionModel, target: Target, before: IntArray, after: IntArray, total: FloatArray
) -> tuple[FloatArray, IntArray]:
    """One step of the recursion: least cost up to each row of `after`, and where it came from."""
    reached = join_matrix(model, target, before + 1, after)
    reached += total[:, None]
    pointer = reached.argmin(axis=0)
    least = reached[pointer, np.arange(len(after))]
    place = np.minimum(np.searchsorted(before, after - 1), len(before) - 1)
    natural = np.where(before[place] == after - 1, total[place], np.inf)
    goes_on = natural <= least
    return np.where(goes_on, natural, least), np.where(goes_on, place, pointer)


def _pruned(
    model: SelectionModel, target: Target, candidates: Candidates, costs: list[FloatArray], prune: int
) -> tuple[list[IntArray], list[FloatArray]]:
    n_phones = model.inventory.n_phones
    kept = greedy_path(model, target, candidates)
    back = run_lengths([n_phones - 1 - r for r in candidates.rows[::-1]], n_phones)[::-1]
    bonus = TYPICAL_JOIN * target.typical_join + target.each
    rows, left = [], []
    for k, found in enumerate(candidates.rows):
        rank = costs[k] - bonus * (candidates.reach[k] + back[k])
        rank[np.searchsorted(found, kept[k])] = -np.inf
        best = (
            np.sort(np.argsort(rank, kind="stable")[:prune]) if len(found) > prune else np.arange(len(found))
        )
        rows.append(found[best])
        left.append(costs[k][best])
    return rows, left


def select_viterbi(
    model: SelectionModel,
    utterance: Utterance,
    *,
    exclude: Iterable[str] = (),
    pins: Iterable[Pin] = (),
    bans: Iterable[UnitRef | str] = (),
    allow_backoff: bool = True,
    n_rejected: int = 7,
    prune: int | None = 100,
    duration: float = 1.0,
    context: float = 0.3,
    position: float = 0.0,
    stress: float = 0.0,
    backoff: float = 2.0,
    flagged: float = 1.0,
    join: float = 1.0,
    velocity: float = 0.3,
    acceleration: float = 0.0,
    aperture: float = 0.0,
    sound: float = 0.0,
    per_join: float = 0.0,
) -> Selection:
    """Select units at least total cost: timing, context, backoff, flagged frames, and joins.

    Parameters
    ----------
    model : SelectionModel
    utterance : Utterance
    exclude, pins, bans, allow_backoff, n_rejected
        As in :func:`~corpus_tools.synthesis.greedy.select_greedy`.
    prune : int, optional
        Candidates kept per diphone; all when None.
    duration, context, position, stress, backoff, flagged : float
        Weights of the target terms; `position`: place in syllable, word and phrase.
    join : float
        Weight of the posture distance at a join.
    velocity, acceleration, aperture, sound : float
        Weights of the distance in velocity, acceleration, lip aperture and sound, relative to `join`.
    per_join : float
        Cost of every join as such.

    Returns
    -------
    Selection
        Never dearer than that of :func:`~corpus_tools.synthesis.greedy.select_greedy` with the same weights.

    Raises
    ------
    NoUnitError, InputError, LabelError
    """
    if prune is not None and prune < 1:
        raise InputError(f"'prune' is {prune}; at least 1 candidate must be kept.")
    weights = {
        "duration": duration,
        "context": context,
        "position": position,
        "stress": stress,
        "backoff": backoff,
        "flagged": flagged,
        "join": join,
        "velocity": velocity,
        "acceleration": acceleration,
        "aperture": aperture,
        "sound": sound,
        "per_join": per_join,
    }
    target = prepare_target(model, utterance, **weights)
    candidates = find_candidates(
        model, target, exclude=exclude, pins=pins, bans=bans, allow_backoff=allow_backoff
    )
    return selection_from_path(
        model,
        target,
        candidates,
        viterbi_path(model, target, candidates, prune),
        utterance=utterance,
        method="viterbi",
        n_rejected=n_rejected,
        settings={**weights, "allow_backoff": allow_backoff, "prune": prune},
    )
