"""The diphones of a corpus as a picture: rows the first phone, columns the second, dark where many."""

from __future__ import annotations

import html
import math
from collections.abc import Mapping

__all__ = ["FEW", "diphone_map_svg"]

FEW = 3
"""Below this many recordings of a diphone a cell is marked (our choice: nothing to choose from)."""
_CELL, _MARGIN = 11, 30


def _cell(row: int, column: int, name: str, n: int, most: int) -> str:
    strength = 0.18 + 0.82 * math.log1p(n) / math.log1p(most)
    x, y = _MARGIN + _CELL * column, _MARGIN + _CELL * row
    few = ' class="few"' if n < FEW else ""
    return (
        f'<g{few}><rect x="{x + 1}" y="{y + 1}" width="{_CELL - 2}" height="{_CELL - 2}" '
        f'fill-opacity="{strength:.2f}"/><title>{name}: {n} recorded</title></g>'
    )


def diphone_map_svg(counts: Mapping[str, int]) -> str:
    """Return the map as SVG; phones that occur in no diphone are left out.

    Parameters
    ----------
    counts : mapping of "A-B" -> times recorded
    """
    pairs = {tuple(name.split("-", 1)): n for name, n in counts.items()}
    phones = sorted({phone for pair in pairs for phone in pair})
    at = {phone: i for i, phone in enumerate(phones)}
    most = max(pairs.values(), default=1)
    size = _MARGIN + _CELL * len(phones)
    parts = []
    for phone, i in at.items():
        middle, label = _MARGIN + _CELL * i + _CELL / 2, html.escape(phone)
        parts.append(f'<text x="{_MARGIN - 4}" y="{middle + 3}" text-anchor="end">{label}</text>')
        parts.append(f'<text transform="translate({middle + 3} {_MARGIN - 4}) rotate(-90)">{label}</text>')
    for (a, b), n in pairs.items():
        parts.append(_cell(at[a], at[b], html.escape(f"{a}-{b}"), n, most))
    return (
        f'<svg class="diphones" viewBox="0 0 {size} {size}" role="img" aria-label="{len(pairs)} diphones '
        f'recorded, of {len(phones)} x {len(phones)} pairs of phones">{"".join(parts)}</svg>'
    )
