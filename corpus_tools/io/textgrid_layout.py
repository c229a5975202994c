"""The text of a TextGrid: what is written, and what a file declares about itself; no file is touched here."""

from __future__ import annotations

import json
import re

import numpy as np

from corpus_tools.core import Interval, Labels, PointTier, Tier
from corpus_tools.core.labels import TIME_TOLERANCE_S

__all__ = [
    "declared_sizes",
    "has_negative_times",
    "json_text",
    "long_text",
    "masked",
    "odd_line",
    "short_text",
]

_STRING = r'"(?:[^"]|"")*"'
_LONG_STRING = re.compile(rf"(\bclass ?= ?)?({_STRING})")
_TOKEN = re.compile(rf'{_STRING}|[^\s"]+')
_PRAAT_LINE = re.compile(
    r'\s*(File type = "ooTextFile"|Object class = "TextGrid"|(xmin|xmax|number) = [\d.e+-]+|tiers\? <exists>|'
    r'size = \d+|item \[\d*\]:|(class|name|text|mark) = ".*"|(intervals|points): size = \d+|'
    r"(intervals|points) \[\d+\]:)?\s*"
)
_CLASSES = ('"IntervalTier"', '"TextTier"')


def masked(text: str) -> tuple[str, list[str]]:
    """Replace every tier name and label of a TextGrid by its number.

    praatio finds its way by searching for words such as ``intervals [``, ``item [`` and ``"TextTier"``, trims
    labels, and leaves doubled quotes in the marks of points: with numbers in their place no label can
    mislead it and none is changed.

    Parameters
    ----------
    text : str
        A TextGrid in Praat's long or short format, lines ended by line feeds.

    Returns
    -------
    text : str
        With ``"0"``, ``"1"``, ... for names and labels; header and tier classes as they were.
    strings : list of str
        What the numbers stand for, quotes undone.
    """
    header, sign, body = text.partition("<exists>")
    strings: list[str] = []

    def number(string: str) -> str:
        strings.append(string[1:-1].replace('""', '"'))
        return f'"{len(strings) - 1}"'

    if _is_long(body):
        body = _LONG_STRING.sub(lambda m: m[0] if m[1] else number(m[2]), body)
    else:
        keep = _class_positions(body)
        body = re.sub(_STRING, lambda m: m[0] if m.start() in keep else number(m[0]), body)
    return header + sign + body, strings


def _is_long(body: str) -> bool:
    return re.match(r"\s*size ?=", body) is not None


def _class_positions(body: str) -> set[int]:
    """Return where the tier classes of a short TextGrid stand: before a text (the name) and a number."""
    tokens = list(_TOKEN.finditer(body))
    kinds = [t[0][0] == '"' for t in tokens] + [False, False]
    return {
        t.start()
        for i, t in enumerate(tokens)
        if t[0] in _CLASSES and i + 2 < len(tokens) and kinds[i + 1] and not kinds[i + 2]
    }


def declared_sizes(text: str) -> tuple[int, list[int]]:
    """Return how many tiers a masked TextGrid says it has, and how many labels each tier declares."""
    body = text.partition("<exists>")[2]
    if _is_long(body):
        sizes = re.findall(r"(?:intervals|points): ?size ?= ?(\d+)\s", body)
        count = re.match(r"\s*size ?= ?(\d+)\s", body)
    else:
        sizes = re.findall(r'"(?:IntervalTier|TextTier)"\s+"\d+"\s+\S+\s+\S+\s+(\d+)\s', body)
        count = re.match(r"\s*(\d+)\s", body)
    return int(count[1]) if count else 0, [int(n) for n in sizes]


def odd_line(text: str) -> str:
    """Return the first line of a long TextGrid that Praat would not write; empty when there is none."""
    return next((line.strip() for line in text.splitlines() if not _PRAAT_LINE.fullmatch(line)), "")


def has_negative_times(text: str) -> bool:
    """Return whether a masked TextGrid holds times below zero: praatio drops their sign (long format)."""
    return re.search(r"(?:^|=)[ \t]*-[\d.]*[1-9]", text, re.MULTILINE) is not None


def _number(value: float) -> str:
    """Return the shortest digits that give `value` back, without the exponents that praatio cannot read."""
    return str(np.format_float_positional(value + 0.0, trim="-"))


def _plain(value: float) -> float:
    """Return a Python float without a signed zero: equal labels give equal bytes."""
    return float(value) + 0.0


def _quoted(text: str) -> str:
    return '"' + text.replace('"', '""') + '"'


def _rows(tier: Tier, labels: Labels) -> list[Interval]:
    """Return the intervals with blanks in the gaps: a TextGrid tier has no holes."""
    rows: list[Interval] = []
    at = labels.start_s
    for interval in tier:
        if interval.start_s > at + TIME_TOLERANCE_S:
            rows.append(Interval(at, interval.start_s, ""))
        rows.append(interval)
        at = interval.end_s
    if labels.end_s > at + TIME_TOLERANCE_S:
        rows.append(Interval(at, labels.end_s, ""))
    return rows


def _long_tier(tier: Tier | PointTier, labels: Labels) -> list[str]:
    out = [f'        class = "{_kind(tier)}" ', f"        name = {_quoted(tier.name)} "]
    out += [f"        xmin = {_number(labels.start_s)} ", f"        xmax = {_number(labels.end_s)} "]
    if isinstance(tier, PointTier):
        out.append(f"        points: size = {len(tier.points)} ")
        for k, point in enumerate(tier.points, 1):
            out += [f"        points [{k}]:", f"            number = {_number(point.time_s)} "]
            out.append(f"            mark = {_quoted(point.text)} ")
        return out
    rows = _rows(tier, labels)
    out.append(f"        intervals: size = {len(rows)} ")
    for k, row in enumerate(rows, 1):
        out += [f"        intervals [{k}]:", f"            xmin = {_number(row.start_s)} "]
        out += [f"            xmax = {_number(row.end_s)} ", f"            text = {_quoted(row.text)} "]
    return out


def _kind(tier: Tier | PointTier) -> str:
    return "TextTier" if isinstance(tier, PointTier) else "IntervalTier"


def long_text(labels: Labels) -> str:
    """Return Praat's long ("text file") format, line by line as Praat writes it."""
    out = ['File type = "ooTextFile"', 'Object class = "TextGrid"', "", f"xmin = {_number(labels.start_s)} "]
    out += [
        f"xmax = {_number(labels.end_s)} ",
        "tiers? <exists> ",
        f"size = {len(labels.tiers)} ",
        "item []: ",
    ]
    for k, tier in enumerate(labels.tiers, 1):
        out += [f"    item [{k}]:", *_long_tier(tier, labels)]
    return "\n".join(out) + "\n"


def short_text(labels: Labels) -> str:
    """Return Praat's short format."""
    span = [_number(labels.start_s), _number(labels.end_s)]
    out = [
        'File type = "ooTextFile"',
        'Object class = "TextGrid"',
        "",
        *span,
        "<exists>",
        str(len(labels.tiers)),
    ]
    for tier in labels.tiers:
        out += [f'"{_kind(tier)}"', _quoted(tier.name), *span]
        if isinstance(tier, PointTier):
            out.append(str(len(tier.points)))
            for point in tier.points:
                out += [_number(point.time_s), _quoted(point.text)]
        else:
            rows = _rows(tier, labels)
            out.append(str(len(rows)))
            for row in rows:
                out += [_number(row.start_s), _number(row.end_s), _quoted(row.text)]
    return "\n".join(out) + "\n"


def json_text(labels: Labels) -> str:
    """Return praatio's JSON ("textgrid_json") layout."""
    span = {"xmin": _plain(labels.start_s), "xmax": _plain(labels.end_s)}
    tiers = []
    for tier in labels.tiers:
        entries: list[list[float | str]]
        if isinstance(tier, PointTier):
            entries = [[_plain(p.time_s), p.text] for p in tier.points]
        else:
            entries = [[_plain(r.start_s), _plain(r.end_s), r.text] for r in _rows(tier, labels)]
        tiers.append({"class": _kind(tier), "name": tier.name, **span, "entries": entries})
    return json.dumps({**span, "tiers": tiers}, ensure_ascii=False) + "\n"
