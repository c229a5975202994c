"""Labels in time: intervals and points, checked once, sorted, hashable."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

from corpus_tools.core.errors import LabelError

__all__ = ["TIME_TOLERANCE_S", "Interval", "Labels", "Point", "PointTier", "Tier"]

TIME_TOLERANCE_S = 1e-6
"""Two times closer than this are one boundary (our choice: below a sample of any speech recording)."""


@dataclass(frozen=True, slots=True, order=True)
class Interval:
    """A label with a start and an end, in seconds; the end lies after the start."""

    start_s: float
    end_s: float
    text: str

    def __post_init__(self) -> None:
        if not (math.isfinite(self.start_s) and math.isfinite(self.end_s)):
            raise LabelError(f"The interval '{self.text}' has a time that is not a number.")
        if not self.end_s > self.start_s:
            raise LabelError(
                f"The interval '{self.text}' at {self.start_s:g} s ends at {self.end_s:g} s: "
                "an interval must end after it starts."
            )

    @property
    def duration_s(self) -> float:
        """Length in seconds, positive."""
        return self.end_s - self.start_s

    @property
    def centre_s(self) -> float:
        """Middle of the interval in seconds."""
        return 0.5 * (self.start_s + self.end_s)


@dataclass(frozen=True, slots=True, order=True)
class Point:
    """A label at one time, in seconds."""

    time_s: float
    text: str


def _check_order(name: str, intervals: tuple[Interval, ...]) -> None:
    for before, after in itertools.pairwise(intervals):
        if after.start_s < before.end_s - TIME_TOLERANCE_S:
            raise LabelError(
                f"Tier '{name}': '{after.text}' starts at {after.start_s:g} s, before '{before.text}' "
                f"ends at {before.end_s:g} s; intervals of a tier must not overlap."
            )


@dataclass(frozen=True, slots=True)
class Tier:
    """Intervals of one kind, sorted and without overlap; gaps between them are allowed."""

    name: str
    intervals: tuple[Interval, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "intervals", tuple(self.intervals))
        _check_order(self.name, self.intervals)

    def __iter__(self) -> Iterator[Interval]:
        return iter(self.intervals)

    def __len__(self) -> int:
        return len(self.intervals)

    def at(self, time_s: float) -> Interval | None:
        """Return the interval that holds `time_s` (start included, end excluded), or None."""
        for interval in self.intervals:
            if interval.start_s <= time_s < interval.end_s:
                return interval
        return None


@dataclass(frozen=True, slots=True)
class PointTier:
    """Points of one kind, sorted in time."""

    name: str
    points: tuple[Point, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", tuple(sorted(self.points)))


@dataclass(frozen=True, slots=True)
class Labels:
    """All tiers of one recording, over [start_s, end_s]."""

    tiers: tuple[Tier | PointTier, ...]
    start_s: float
    end_s: float

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the tiers, in order."""
        return tuple(tier.name for tier in self.tiers)

    def tier(self, name: str) -> Tier:
        """Return the interval tier called `name`.

        Raises
        ------
        LabelError
            There is none; the message lists the tiers that are there.
        """
        for tier in self.tiers:
            if tier.name == name and isinstance(tier, Tier):
                return tier
        have = ", ".join(repr(n) for n in self.names) or "none"
        raise LabelError(f"There is no interval tier '{name}'; the tiers are: {have}.")
