"""What could speak the place of a fragment: the chosen unit and those that the search turned down."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from corpus_tools.core import Costs, UnitRef
from corpus_tools.pipeline import parse_pin, pin_text
from workbench.state.stages import Result

__all__ = ["Option", "Options", "fragment_at", "options_of", "pin_at", "with_pin", "without_pin"]


@dataclass(frozen=True, slots=True)
class Option:
    """One unit for a place: the target phones it would speak, and its cost as the search saw it."""

    first: int
    last: int
    unit: UnitRef
    costs: Costs

    @property
    def pin(self) -> str:
        """The option as a pin."""
        return pin_text(self.first, self.last, self.unit)


@dataclass(frozen=True, slots=True)
class Options:
    """The options of one place in a fixed order, and which of them is shown.

    A pin changes what the search says of a place; the list stays as it was when the place was selected, so
    that going on and back again meets the same units.
    """

    options: tuple[Option, ...]
    at: int = 0
    tried: bool = False
    """Whether the one that is shown is only tried, until it is kept."""

    @property
    def first(self) -> int:
        """First target phone of the place."""
        return self.options[0].first

    def holds(self, result: Result) -> bool:
        """Tell whether the option that is shown is what a result speaks at the place."""
        option = self.options[self.at]
        chosen = result.selection.chosen[fragment_at(result, option.first)]
        same = chosen.unit.recording == option.unit.recording
        return same and chosen.unit.first - chosen.first == option.unit.first - option.first

    def moved(self, step: int) -> Options:
        """Return the options with the next (or another) one shown, round and round."""
        return replace(self, at=(self.at + step) % len(self.options), tried=True)

    def kept(self) -> Options:
        """Return the options with the one that is shown kept."""
        return replace(self, tried=False)


def options_of(result: Result, index: int) -> Options:
    """Return the options of fragment `index` of a result, the chosen one first."""
    chosen = result.selection.chosen[index]
    others = [
        Option(chosen.first, chosen.first + c.unit.last - c.unit.first, c.unit, c.costs)
        for c in chosen.rejected
    ]
    return Options((Option(chosen.first, chosen.last, chosen.unit, chosen.costs), *others))


def fragment_at(result: Result, phone: int) -> int:
    """Return the index of the fragment that speaks the step from target phone `phone` to the next."""
    chosen = result.selection.chosen
    return next((i for i, c in enumerate(chosen) if c.first <= phone < c.last), len(chosen) - 1)


def _overlaps(pin: str, first: int, last: int) -> bool:
    a, b, _ = parse_pin(pin)
    return a < last and first < b


def without_pin(pins: Iterable[str], first: int, last: int) -> tuple[str, ...]:
    """Return the pins without those that speak any of the target phones `first` to `last`."""
    return tuple(p for p in pins if not _overlaps(p, first, last))


def with_pin(pins: Iterable[str], option: Option) -> tuple[str, ...]:
    """Return the pins with an option pinned, in place of pins that it overlaps; sorted by place."""
    kept = (*without_pin(pins, option.first, option.last), option.pin)
    return tuple(sorted(kept, key=lambda p: parse_pin(p)[:2]))


def pin_at(pins: Iterable[str], first: int, last: int) -> str:
    """Return the pin that lies on any of the target phones `first` to `last`; empty without."""
    return next((p for p in pins if _overlaps(p, first, last)), "")
