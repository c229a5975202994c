"""Pins and bans as a config writes them, and as the search takes them."""

from __future__ import annotations

import itertools
import re

from corpus_tools.config import ConfigBase
from corpus_tools.core import InputError, UnitRef

__all__ = ["ban_of", "banned_pins", "overrides_of", "parse_pin", "pin_text"]

_UNIT = re.compile(r"(.+):(\d+)-(\d+)")
_PIN = re.compile(r"(\d+)-(\d+)=(.+)")


def _unit(text: str) -> UnitRef | None:
    match = _UNIT.fullmatch(text)
    return UnitRef(match[1], int(match[2]), int(match[3])) if match else None


def pin_text(first: int, last: int, unit: UnitRef) -> str:
    """Return a pin as a config writes it: ``first-last=recording:i-j``."""
    return f"{first}-{last}={unit.key}"


def parse_pin(text: str) -> tuple[int, int, UnitRef]:
    """Return (first, last, unit) of a pin.

    Raises
    ------
    InputError
        The text is no pin.
    """
    match = _PIN.fullmatch(text)
    unit = _unit(match[3]) if match else None
    if match is None or unit is None:
        raise InputError(
            f"'{text}' in overrides.pins is no pin; 'first-last=recording:i-j' was expected, "
            "for example '3-6=bbaf2n:4-7'."
        )
    return int(match[1]), int(match[2]), unit


def ban_of(text: str) -> UnitRef | str:
    """Return what a ban names: a unit (``recording:i-j``), or a whole recording."""
    return _unit(text) or text


def banned_pins(config: ConfigBase) -> tuple[tuple[str, str], ...]:
    """Return (pin, ban) of every pin whose unit is banned, wholly or in part: such a pin holds."""
    found = []
    for pin, text in itertools.product(config.overrides.pins, config.overrides.bans):
        unit, ban = parse_pin(pin)[2], ban_of(text)
        if isinstance(ban, str):
            against = ban == unit.recording
        else:
            against = ban.recording == unit.recording and ban.first < unit.last and unit.first < ban.last
        if against:
            found.append((pin, text))
    return tuple(found)


def overrides_of(
    config: ConfigBase,
) -> tuple[tuple[tuple[int, int, UnitRef], ...], tuple[UnitRef | str, ...]]:
    """Return (pins, bans) of a config, as the search takes them."""
    section = config.overrides
    return tuple(parse_pin(p) for p in section.pins), tuple(ban_of(b) for b in section.bans)
