"""Every settled change of a session, in order, with what it did; the stack behind undo and redo."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

__all__ = ["Entry", "History", "change_text"]

_TARGET = ("target_kind", "sentence", "text")

TOGETHER_S = 1.2
"""A slider that moves again within this time goes on with the same entry."""

_NAMES = {
    "method": "method",
    "weighting": "g(u)",
    "shape": "crossover",
    "overlap_s": "overlap",
    "inertial_s": "inertial duration",
    "rule": "overlap rule",
    "mesh": "head",
    "deformer": "deformer",
    "sentence": "sentence",
    "text": "text",
    "target_kind": "target",
    "held_out": "held out",
    "mode": "join",
    "curve_weights": "own curve",
}
_CURVE = {"curve_weights", "weighting", "shape"}
_SLIDES = ({"shape"}, {"overlap_s"}, {"inertial_s"})


@dataclass(frozen=True, slots=True)
class Entry:
    """One state of the session.

    Attributes
    ----------
    number : int
        Counted from 0; the order in which the states came about.
    parent : int or None
        The state that was changed; undo goes there.
    when_s : float
        Seconds since the epoch.
    what : str
        The change in words.
    keys : frozenset of str
        What was changed.
    values : mapping
        Every editable value of the state.
    effect : float
        Largest join of the result (peak acceleration / natural stretches' p95); NaN while it is not known.
    """

    number: int
    parent: int | None
    when_s: float
    what: str
    keys: frozenset[str]
    values: Mapping[str, Any]
    effect: float = math.nan


def _value_text(name: str, value: Any) -> str:
    if name in ("overlap_s", "inertial_s"):
        return f"{1000 * value:.0f} ms"
    if name == "shape":
        return f"{value:+.2f}"
    if name == "curve_weights":
        return "moved"
    if name == "held_out":
        return "yes" if value else "no"
    text = str(value) or "none"
    return text if len(text) <= 28 else f"{text[:27]}…"


def _place_text(pin: str, phones: Sequence[str]) -> tuple[str, str]:
    """Return the place of a pin by its first and last phone, and the unit that speaks it."""
    place, _, unit = pin.partition("=")
    first, last = (int(n) for n in place.split("-"))
    if last < len(phones):
        return f"{phones[first]}–{phones[last]}", unit
    return f"phones {first}–{last}", unit


def _picks_text(before: Mapping[str, Any], after: Mapping[str, Any], phones: Sequence[str]) -> list[str]:
    """Return which pins and bans came and went; the pins of another target are no change."""
    parts = []
    if all(before.get(n) == after.get(n) for n in _TARGET):
        old, new = before.get("pins", ()), after.get("pins", ())
        again = {p.partition("=")[0] for p in new}
        gone = [p for p in old if p not in new and p.partition("=")[0] not in again]
        parts += ["pin {} → {}".format(*_place_text(p, phones)) for p in new if p not in old]
        parts += ["unpin {} ({})".format(*_place_text(p, phones)) for p in gone]
    old, new = before.get("bans", ()), after.get("bans", ())
    parts += [f"ban {b}" for b in new if b not in old]
    return parts + [f"allow {b}" for b in old if b not in new]


def change_text(before: Mapping[str, Any], after: Mapping[str, Any], phones: Sequence[str] = ()) -> str:
    """Return a change in words, empty when nothing changed: "overlap 120 ms → 80 ms".

    Parameters
    ----------
    before, after : mapping of parameter -> value
    phones : sequence of str
        Of the target, to name the place of a pin; without them it is named by numbers.
    """
    parts = []
    for name, label in _NAMES.items():
        if before.get(name) == after.get(name):
            continue
        old, new = _value_text(name, before.get(name)), _value_text(name, after.get(name))
        parts.append(f"{label} {new}" if name in ("curve_weights", "text") else f"{label} {old} → {new}")
    return ", ".join(parts + _picks_text(before, after, phones))


class History:
    """A tree of states: a change after an undo begins another branch, and nothing is ever lost.

    Parameters
    ----------
    most : int
        Entries kept; the oldest go first.
    """

    def __init__(self, most: int = 200) -> None:
        self._most = most
        self._next = 0
        self._at: int | None = None
        self._entries: dict[int, Entry] = {}

    @classmethod
    def of(cls, entries: Iterable[Entry], at: int) -> History:
        """Return a history that holds entries and stands on number `at`; KeyError without it."""
        made = cls()
        made._entries = {e.number: e for e in entries}
        made._at = made._entries[at].number
        made._next = max(made._entries) + 1
        return made

    @property
    def entries(self) -> tuple[Entry, ...]:
        """All entries, the oldest first."""
        return tuple(self._entries.values())

    @property
    def at(self) -> int | None:
        """Number of the entry that the session stands on."""
        return self._at

    @property
    def can_undo(self) -> bool:
        """Whether there is a state before this one."""
        return self._at is not None and self._entries[self._at].parent in self._entries

    @property
    def can_redo(self) -> bool:
        """Whether an undone state can be taken again."""
        return self._child() is not None

    @property
    def line(self) -> frozenset[int]:
        """Numbers of the entries that led to the state the session stands on, itself among them."""
        found, number = set(), self._at
        while number is not None and number in self._entries:
            found.add(number)
            number = self._entries[number].parent
        return frozenset(found)

    def record(
        self, values: Mapping[str, Any], now_s: float, what: str = "", phones: Sequence[str] = ()
    ) -> Entry | None:
        """Enter a state; None when it equals the one the session stands on.

        Parameters
        ----------
        values : mapping
            Every editable value.
        now_s : float
            Seconds since the epoch.
        what : str
            The change in words; found from the values when empty.
        phones : sequence of str
            Of the target, to name the place of a pin.
        """
        here = self._entries.get(self._at) if self._at is not None else None
        before = here.values if here else {}
        keys = frozenset(k for k in values if before.get(k) != values[k]) if here else frozenset[str]()
        if here is not None and not keys:
            return None
        if here is not None and self._goes_on(here, keys, now_s):
            parent = self._entries.get(here.parent) if here.parent is not None else None
            text = change_text(parent.values, values, phones) if parent else here.what
            entry = replace(here, when_s=now_s, what=text, values=dict(values), effect=math.nan)
        else:
            text = what or (change_text(before, values, phones) if here else "opened")
            entry = Entry(self._next, self._at, now_s, text, keys, dict(values))
            self._next += 1
        self._entries[entry.number] = entry
        self._at = entry.number
        for number in list(self._entries)[: -self._most]:
            del self._entries[number]
        return entry

    def _goes_on(self, here: Entry, keys: frozenset[str], now_s: float) -> bool:
        slider = set(keys) in _SLIDES and keys == here.keys
        curve = keys == {"curve_weights"} and "curve_weights" in here.keys and here.keys <= _CURVE
        same = slider or curve
        return same and now_s - here.when_s <= TOGETHER_S and self._child() is None

    def settle(self, effect: float) -> None:
        """Say what the state that the session stands on does."""
        if self._at is not None:
            self._entries[self._at] = replace(self._entries[self._at], effect=effect)

    def go(self, number: int) -> Mapping[str, Any] | None:
        """Stand on an entry; return its values, None when it is not there."""
        if number not in self._entries:
            return None
        self._at = number
        return self._entries[number].values

    def undo(self) -> Mapping[str, Any] | None:
        """Stand on the state before; return its values, None at the first."""
        parent = self._entries[self._at].parent if self._at is not None else None
        return self.go(parent) if parent is not None else None

    def redo(self) -> Mapping[str, Any] | None:
        """Stand on the latest state that came from this one; return its values, None when there is none."""
        child = self._child()
        return self.go(child) if child is not None else None

    def _child(self) -> int | None:
        children = [e.number for e in self._entries.values() if e.parent == self._at and e.number != self._at]
        return children[-1] if children and self._at is not None else None
