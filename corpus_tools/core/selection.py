"""Which fragment speaks which span of the target, what it cost, and what was turned down."""

from __future__ import annotations

from dataclasses import dataclass, field

__all__ = ["Candidate", "ChosenUnit", "Costs", "Selection", "UnitRef"]


@dataclass(frozen=True, slots=True, order=True)
class UnitRef:
    """A span of phones inside one recording, both ends included.

    The unit runs from the centre of phone `first` to the centre of phone `last`; `first` < `last`.
    Indices count the phones of that recording's utterance.
    """

    recording: str
    first: int
    last: int

    @property
    def key(self) -> str:
        """``recording:first-last``, as written in configs, pins and bans."""
        return f"{self.recording}:{self.first}-{self.last}"


@dataclass(frozen=True, slots=True)
class Costs:
    """Itemised cost of one unit in its place: (name, weighted value) pairs; target terms, then join terms.

    `target` holds e.g. timing, context, backoff, flagged; `join` holds position, velocity, ... of the join
    with the unit before it.
    """

    target: tuple[tuple[str, float], ...] = ()
    join: tuple[tuple[str, float], ...] = ()

    @property
    def target_total(self) -> float:
        """Sum of the target terms."""
        return float(sum(v for _, v in self.target))

    @property
    def join_total(self) -> float:
        """Sum of the join terms."""
        return float(sum(v for _, v in self.join))

    @property
    def total(self) -> float:
        """Target plus join terms."""
        return self.target_total + self.join_total


@dataclass(frozen=True, slots=True)
class Candidate:
    """A unit that could have stood in a place, and its cost there."""

    unit: UnitRef
    costs: Costs


@dataclass(frozen=True, slots=True)
class ChosenUnit:
    """The unit that speaks target phones `first` to `last` (both included).

    `backoff` lists (target index, target phone, phone used instead) where a viseme class stood in.
    `rejected` holds the best of the others, cheapest first.
    """

    first: int
    last: int
    unit: UnitRef
    costs: Costs
    backoff: tuple[tuple[int, str, str], ...] = ()
    rejected: tuple[Candidate, ...] = ()


@dataclass(frozen=True, slots=True)
class Selection:
    """The units of a whole utterance: neighbours share their boundary phone."""

    utterance: str
    method: str
    chosen: tuple[ChosenUnit, ...]
    settings: tuple[tuple[str, object], ...] = field(default=())

    @property
    def total_cost(self) -> float:
        """Sum over all units, joins included."""
        return float(sum(c.costs.total for c in self.chosen))

    @property
    def n_joins(self) -> int:
        """Number of joins: units minus one."""
        return max(0, len(self.chosen) - 1)
