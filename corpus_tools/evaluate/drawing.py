"""Small SVG pictures of an evaluation: intervals by method, and two metrics against each other."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np

from corpus_tools.core import FloatArray
from corpus_tools.evaluate.bootstrap import Estimate

__all__ = ["interval_plot", "scatter_plot", "ticks"]

_INK, _GRID, _MARK = "#1c2127", "#dde2e7", "#1f6feb"
_FONT = 'font-family="system-ui,sans-serif" font-size="12"'
_LETTER = 7.6
"""Room for a letter of a name, px; names start at the left edge, so that no font cuts them off there."""


def ticks(low: float, high: float, n: int = 5) -> FloatArray:
    """Return about `n` round numbers from below `low` to above `high`, at least two of them."""
    span = max(high - low, 1e-9, 0.02 * abs(high))
    high = max(high, low + span)
    raw = span / n
    power = 10.0 ** np.floor(np.log10(raw))
    step = power * min((1, 2, 5, 10), key=lambda m: abs(m * power - raw))
    return np.asarray(np.arange(np.floor(low / step), np.ceil(high / step) + 0.5) * step)


def _text(x: float, y: float, text: str, anchor: str = "middle", extra: str = "") -> str:
    place = f'x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"'
    return f'<text {place} fill="{_INK}" {_FONT} {extra}>{escape(text)}</text>'


def _line(
    x1: float, y1: float, x2: float, y2: float, colour: str, width: float = 1.0, dashes: str = "none"
) -> str:
    place = f'x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"'
    return f'<line {place} stroke="{colour}" stroke-width="{width}" stroke-dasharray="{dashes}"/>'


def _dot(x: float, y: float) -> str:
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{_MARK}"/>'


def _svg(width: float, height: float, title: str, parts: Sequence[str]) -> str:
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" role="img" '
        f'aria-label="{escape(title)}"><title>{escape(title)}</title>{"".join(parts)}</svg>'
    )


def interval_plot(rows: Sequence[tuple[str, Estimate]], title: str, natural: float | None = None) -> str:
    """Return a dot with its interval for every row, the axis below, and a dashed line at natural speech."""
    left, width, pitch, top = 20 + _LETTER * max(len(name) for name, _ in rows), 300.0, 22.0, 26.0
    marks = [] if natural is None else [natural]
    at = ticks(min([e.low for _, e in rows] + marks), max([e.high for _, e in rows] + marks))
    scale = width / (at[-1] - at[0])
    bottom = top + pitch * len(rows)

    def x(value: float) -> float:
        return float(left + (value - at[0]) * scale)

    parts = [_text(left, 14, title, "start", 'font-weight="600"')]
    for tick in at:
        parts += [_line(x(tick), top, x(tick), bottom, _GRID), _text(x(tick), bottom + 16, f"{tick:.4g}")]
    if natural is not None:
        parts.append(_line(x(natural), top, x(natural), bottom, _INK, 1, "4 3"))
    for k, (name, found) in enumerate(rows):
        y = top + pitch * (k + 0.5)
        parts += [
            _text(4, y + 4, name, "start"),
            _line(x(found.low), y, x(found.high), y, _MARK, 2),
            _dot(x(found.value), y),
        ]
    return _svg(left + width + 24, bottom + 24, title, parts)


def scatter_plot(
    points: Sequence[tuple[str, float, float]], x_title: str, y_title: str, natural_y: float
) -> str:
    """Return numbered points, their names beside the picture, and a dashed line at natural speech."""
    left, top, width, height = 56.0, 12.0, 380.0, 300.0
    xs = ticks(min(x for _, x, _ in points), max(x for _, x, _ in points))
    ys = ticks(min([y for _, _, y in points] + [natural_y]), max(y for _, _, y in points))
    parts = []
    for value in xs:
        x = left + (value - xs[0]) / (xs[-1] - xs[0]) * width
        parts += [_line(x, top, x, top + height, _GRID), _text(x, top + height + 16, f"{value:.4g}")]
    for value in ys:
        y = top + height - (value - ys[0]) / (ys[-1] - ys[0]) * height
        parts += [_line(left, y, left + width, y, _GRID), _text(left - 6, y + 4, f"{value:.4g}", "end")]
    level = top + height - (natural_y - ys[0]) / (ys[-1] - ys[0]) * height
    parts.append(_line(left, level, left + width, level, _INK, 1, "4 3"))
    taken: list[tuple[float, float]] = []
    key = left + width + 24.0
    for number, (name, value_x, value_y) in enumerate(points, 1):
        x = left + (value_x - xs[0]) / (xs[-1] - xs[0]) * width
        y = top + height - (value_y - ys[0]) / (ys[-1] - ys[0]) * height
        label = y + 4
        while any(abs(label - other) < 12 and abs(x - there) < 14 for there, other in taken):
            label -= 12
        taken.append((x, label))
        if label < y:
            parts.append(_line(x, y, x + 8, label - 2, _INK, 0.6))
        parts += [_dot(x, y), _text(x + 7, label, str(number), "start")]
        parts.append(_text(key, top + 16.0 * number, f"{number}  {name}", "start"))
    parts += [
        _text(left + width / 2, top + height + 34, x_title),
        _text(0, 0, y_title, "middle", f'transform="translate(14 {top + height / 2:.0f}) rotate(-90)"'),
    ]
    whole = key + 30 + _LETTER * max(len(name) for name, _, _ in points)
    tall = max(top + height + 42, top + 16.0 * (len(points) + 1))
    return _svg(whole, tall, f"{y_title} against {x_title}", parts)
