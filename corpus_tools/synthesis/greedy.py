"""Longest-first selection (paper A section 5.1.1, "Fragment Selection Algorithm"): as printed, and mended."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

import numpy as np

from corpus_tools.core import IntArray, Selection, UnitRef, Utterance
from corpus_tools.synthesis.backoff import Candidates, Pin, find_candidates
from corpus_tools.synthesis.chosen import selection_from_path
from corpus_tools.synthesis.costs import span_costs
from corpus_tools.synthesis.model import SelectionModel
from corpus_tools.synthesis.target import Target, prepare_target

__all__ = ["greedy_as_printed", "greedy_path", "select_greedy"]


def greedy_as_printed(
    find_unit: Callable[[int, int], bool], n_phones: int
) -> Iterator[tuple[int, int, bool]]:
    """Run the algorithm of paper A section 5.1.1 word for word, one FIND-UNIT at a time.

    ::

        frags <- [];  i <- 1;  j <- numPhones
        while i < numPhones do
            while not FIND-UNIT(phones, i, j) do  j <- j - 1  end while
            APPEND-UNIT(frags, phones, i, j)
            i <- j;  j <- numPhones
        end while

    Where the diphone (i, i + 1) is missing, j falls to i. The single phone is found, so that i <- j changes
    nothing and the loop never ends; where single phones are no units, j falls past the start instead.
    Being a generator, it can be stopped; :func:`select_greedy` is the mended one.

    Parameters
    ----------
    find_unit : callable
        ``find_unit(i, j)``: whether a fragment spans target phones i to j, both included, counted from 1.
    n_phones : int

    Yields
    ------
    (i, j, found)
        Every call of FIND-UNIT; those that found something are the appended units.
    """
    i, j = 1, n_phones
    while i < n_phones:
        while not find_unit(i, j):
            yield i, j, False
            j = j - 1
        yield i, j, True
        i, j = j, n_phones


def greedy_path(model: SelectionModel, target: Target, candidates: Candidates) -> IntArray:
    """Choose one inventory row per diphone, longest run first.

    Among runs of the same length the least target cost decides: "similarity in the phonetic timing to the
    target utterance, and similarity of context" (paper A section 5.1.1); among equals, the first recording by
    name and the first place in it. Spans are closed under taking parts, so that this has the fewest joins
    that any selection from the same candidates can have.
    """
    path = np.empty(target.n_diphones, dtype=np.int64)
    k = 0
    while k < target.n_diphones:
        length = int(candidates.reach[k].max())
        rows = candidates.rows[k][candidates.reach[k] == length]
        best = rows[span_costs(model, target, k, rows, length).sum(axis=1).argmin()]
        path[k : k + length] = best + np.arange(length)
        k += length
    return path


def select_greedy(
    model: SelectionModel,
    utterance: Utterance,
    *,
    exclude: Iterable[str] = (),
    pins: Iterable[Pin] = (),
    bans: Iterable[UnitRef | str] = (),
    allow_backoff: bool = True,
    n_rejected: int = 7,
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
    """Select units longest first (paper A section 5.1.1), its endless loop mended.

    Where a diphone is missing, another stands in for it, of the same viseme classes if there is one, and the
    search goes on; with `allow_backoff` off, or where nothing stands in, an error names the missing diphones.

    Parameters
    ----------
    model : SelectionModel
    utterance : Utterance
    exclude : iterable of str
        Recordings kept out of the inventory.
    pins : iterable of (first, last, unit)
        Units that must speak target phones `first` to `last`, both included.
    bans : iterable of UnitRef or str
        Units whose diphones, or recordings, must not be used.
    allow_backoff : bool
    n_rejected : int
        Alternatives listed with each unit.
    duration, context, position, stress, backoff, flagged : float
        Weights of the target terms; `backoff` is the cost of a phone replaced by another of its class.
    join, velocity, acceleration, aperture, sound, per_join : float
        Weights of the join terms; they are reported, but do not steer this search.

    Returns
    -------
    Selection

    Raises
    ------
    NoUnitError, InputError, LabelError
    """
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
        greedy_path(model, target, candidates),
        utterance=utterance,
        method="greedy",
        n_rejected=n_rejected,
        settings={**weights, "allow_backoff": allow_backoff},
    )
