"""How values are printed: as many digits as their interval says something about."""

from __future__ import annotations

import math

from corpus_tools.evaluate.bootstrap import Estimate

__all__ = ["MISSING", "NOTHING", "interval_text", "value_text"]

MISSING = "–"
"""Stands where a metric says nothing: no joins, no repetition, the correlation of what does not move."""

NOTHING = 1e-9
"""Below it a value is 0, and an interval has no width: rounding of the machine."""

_MOST = 4


def _decimals(found: Estimate) -> int | None:
    """Return the decimals that hold two digits of the width of an interval; None when it has none."""
    width = found.high - found.low
    if not math.isfinite(width) or width <= NOTHING * max(1.0, abs(found.value)) or width < 10.0**-_MOST:
        return None
    return min(max(1 - math.floor(math.log10(width)), 0), _MOST)


def _plain(value: float, decimals: int) -> str:
    text = f"{value:.{decimals}f}"
    return text.lstrip("-") if float(text) == 0.0 else text


def value_text(found: Estimate | None) -> str:
    """Return a value with the digits of its interval; without one three decimals, or a whole number.

    Parameters
    ----------
    found : Estimate, optional
        :data:`MISSING` when None or not a number.
    """
    if found is None or not math.isfinite(found.value):
        return MISSING
    decimals = _decimals(found)
    if decimals is None:
        nearest = round(found.value)
        return str(nearest) if abs(found.value - nearest) < 0.0005 else _plain(found.value, 3)
    return _plain(found.value, decimals)


def interval_text(found: Estimate) -> str:
    """Return ``low – high`` with the digits of the value; empty when both are the same but for rounding."""
    decimals = _decimals(found)
    return "" if decimals is None else f"{_plain(found.low, decimals)} – {_plain(found.high, decimals)}"
