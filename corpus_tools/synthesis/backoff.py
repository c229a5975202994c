"""Which rows of the inventory may speak each diphone of a target: exact, by viseme class, pinned, banned.

Paper A section 5.1.1 assumes that every diphone of the target domain was captured. Where one was not,
phones of the same viseme class stand in (our addition): first with one phone exact, then with both by class.
Where the corpus has no transition between the two classes at all, one phone is kept, exact or by class, and
what replaces the other does with the lips what that does, if any can: closed lips are given up last, then
the lip on the teeth, then rounding. Among those that are left, backoff and join costs find the nearest. Both
searches run on the same candidates, so that neither can win by a wider choice.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from corpus_tools.core import BoolArray, InputError, IntArray, NoUnitError, UnitRef
from corpus_tools.fragments import diphone_keys, diphone_rows, recording_mask
from corpus_tools.synthesis.model import SelectionModel
from corpus_tools.synthesis.target import Target
from corpus_tools.synthesis.visible import SAME_CLASS, visible_losses

__all__ = ["Candidates", "Pin", "find_candidates", "run_lengths"]

Pin = tuple[int, int, UnitRef]
"""Target phones `first` to `last` (both included) and the unit that must speak them."""


@dataclass(frozen=True, slots=True, eq=False)
class Candidates:
    """Rows that may speak each diphone of a target, ascending, and how far each could go on.

    Attributes
    ----------
    rows : tuple of (n_candidates,) int64, one per diphone
        With pins applied: a pinned diphone has one row.
    reach : tuple of (n_candidates,) int64
        How many diphones in a row the recording goes on from each of `rows` as the target does; at least 1.
    open_rows, open_reach : the same without pins
        What could have been chosen; empty where only a pin covers a diphone.
    """

    rows: tuple[IntArray, ...]
    reach: tuple[IntArray, ...]
    open_rows: tuple[IntArray, ...]
    open_reach: tuple[IntArray, ...]


def find_candidates(
    model: SelectionModel,
    target: Target,
    *,
    exclude: Iterable[str] = (),
    pins: Iterable[Pin] = (),
    bans: Iterable[UnitRef | str] = (),
    allow_backoff: bool = True,
) -> Candidates:
    """Find the rows that may speak each diphone of the target.

    Parameters
    ----------
    model, target
    exclude : iterable of str
        Recordings kept out; unknown names change nothing.
    pins : iterable of (first, last, unit)
        Win over bans, but cannot bring an excluded recording back.
    bans : iterable of UnitRef or str
        A unit: none of its diphones may be used; a name: that whole recording.
    allow_backoff : bool
        Let other phones stand in, the same viseme class first, where a diphone is missing.

    Raises
    ------
    InputError
        A pin or a ban does not fit the target or the inventory.
    NoUnitError
        Diphones that nothing covers; all of them are named.
    """
    excluded = frozenset(exclude)
    pinned = _pinned_rows(model, target, pins, excluded)
    usable, banned = _usable(model, excluded, bans)
    keys = diphone_keys(model.inventory, target.codes)
    rows = [_keep(model, found, usable, banned) for found in diphone_rows(model.inventory, keys)]
    missing = [k for k, found in enumerate(rows) if len(found) == 0]
    for k in missing if allow_backoff else ():
        rows[k] = _class_rows(model, target, k, usable, banned)
    lost = [k for k in missing if len(rows[k]) == 0 and k not in pinned]
    if lost:
        raise _no_unit(model, target, lost, excluded, allow_backoff)
    reach = run_lengths(rows, model.inventory.n_phones)
    if not pinned:
        return Candidates(tuple(rows), tuple(reach), tuple(rows), tuple(reach))
    fixed = [pinned.get(k, found) for k, found in enumerate(rows)]
    fixed_reach = run_lengths(fixed, model.inventory.n_phones)
    return Candidates(tuple(fixed), tuple(fixed_reach), tuple(rows), tuple(reach))


def _no_unit(
    model: SelectionModel, target: Target, lost: Sequence[int], excluded: frozenset[str], by_class: bool
) -> NoUnitError:
    """Return the error for diphones without a row, with what keeps them from having one."""
    none = np.zeros(0, dtype=np.int64)

    def covered(usable: BoolArray) -> bool:
        found = diphone_rows(model.inventory, diphone_keys(model.inventory, target.codes)[list(lost)])
        if by_class:
            found = [_class_rows(model, target, k, usable, none) for k in lost]
        return all(len(_keep(model, rows, usable, none)) for rows in found)

    banned = covered(recording_mask(model.inventory, excluded))
    held_out = not banned and covered(recording_mask(model.inventory, ()))
    names = dict.fromkeys((target.labels[k], target.labels[k + 1]) for k in lost)
    return NoUnitError(names, by_class=by_class, banned=banned, held_out=held_out)


def run_lengths(rows: Sequence[IntArray], n_phones: int) -> list[IntArray]:
    """Return for each row of each diphone how many diphones go on naturally from it, itself included."""
    ahead = np.zeros(n_phones + 1, dtype=np.int64)
    lengths: list[IntArray] = []
    for k in range(len(rows) - 1, -1, -1):
        run = ahead[rows[k] + 1] + 1
        if k + 1 < len(rows):
            ahead[rows[k + 1]] = 0
        ahead[rows[k]] = run
        lengths.append(run)
    return lengths[::-1]


def _usable(
    model: SelectionModel, excluded: frozenset[str], bans: Iterable[UnitRef | str]
) -> tuple[BoolArray, IntArray]:
    usable = recording_mask(model.inventory, excluded)
    banned: list[IntArray] = [np.zeros(0, dtype=np.int64)]
    for ban in bans:
        if isinstance(ban, UnitRef):
            first, last = _rows_of(model, ban, "ban")
            banned.append(np.arange(first, last))
        else:
            usable[model.inventory.recording_index(ban)] = False
    return usable, np.unique(np.concatenate(banned))


def _rows_of(model: SelectionModel, unit: UnitRef, what: str) -> tuple[int, int]:
    first, last = model.inventory.rows(unit)
    index = model.inventory.recording_index(unit.recording)
    inside = unit.first >= 0 and last < model.inventory.offsets[index + 1]
    if not (inside and first < last and bool((model.inventory.keys[first:last] >= 0).all())):
        raise InputError(f"The {what} '{unit.key}' is no run of at least two phones of that recording.")
    return first, last


def _keep(model: SelectionModel, rows: IntArray, usable: BoolArray, banned: IntArray) -> IntArray:
    if not usable.all():
        rows = rows[usable[model.inventory.recording_of[rows]]]
    return rows[~np.isin(rows, banned)] if len(banned) else rows


def _class_rows(
    model: SelectionModel, target: Target, k: int, usable: BoolArray, banned: IntArray
) -> IntArray:
    """Rows that stand in for diphone `k`, from the narrowest backoff that has any."""
    n_codes = len(model.inventory.phone_set)
    left, right = (
        visible_losses(model.phones, p, model.inventory.phone_set) for p in target.labels[k : k + 2]
    )
    for pairs in _backoff_steps(left, right):
        keys = np.array([a * n_codes + b for a, b in pairs], dtype=np.int64)
        found = [_keep(model, rows, usable, banned) for rows in diphone_rows(model.inventory, keys)]
        rows = np.sort(np.concatenate([np.zeros(0, dtype=np.int64), *found]))
        if len(rows):
            return rows
    return np.zeros(0, dtype=np.int64)


def _backoff_steps(left: Sequence[int], right: Sequence[int]) -> Iterator[list[tuple[int, int]]]:
    """Pairs of codes, ever wider: by the greater loss of the two phones, then by the sum.

    One phone always stays in its class: of a pair that shares neither, nothing would be left to see.
    """
    steps: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for (a, lost), (b, lost_too) in product(enumerate(left), enumerate(right)):
        if min(lost, lost_too) <= SAME_CLASS:
            steps.setdefault((max(lost, lost_too), lost + lost_too), []).append((a, b))
    for step in sorted(steps):
        yield steps[step]


def _pinned_rows(
    model: SelectionModel, target: Target, pins: Iterable[Pin], excluded: frozenset[str]
) -> dict[int, IntArray]:
    pinned: dict[int, IntArray] = {}
    for first, last, unit in pins:
        row, last_row = _rows_of(model, unit, "pin")
        if not 0 <= first < last <= target.n_diphones or last - first != last_row - row:
            raise InputError(
                f"The pin '{unit.key}' has {last_row - row + 1} phones and was put on target phones {first} "
                f"to {last} of 0 to {target.n_diphones}; both must be equally long and inside the target."
            )
        if unit.recording in excluded:
            raise InputError(
                f"The pin '{unit.key}' comes from a recording that is held out; "
                "unpin it or include the recording."
            )
        for step in range(last - first):
            if first + step in pinned:
                raise InputError(
                    f"Two pins speak target phones {first + step} and {first + step + 1}; unpin one."
                )
            pinned[first + step] = np.array([row + step], dtype=np.int64)
    return pinned
