"""Praat TextGrids through praatio, which only this module knows: short, long, JSON; blank intervals kept."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

from praatio.utilities import errors as praat_errors
from praatio.utilities import textgrid_io

from corpus_tools.core import InputError, Interval, LabelError, Labels, Point, PointTier, Tier, atomic_file
from corpus_tools.core.errors import suggestion
from corpus_tools.core.labels import TIME_TOLERANCE_S
from corpus_tools.io.formats import LABEL_READERS
from corpus_tools.io.textgrid_layout import (
    declared_sizes,
    has_negative_times,
    json_text,
    long_text,
    masked,
    odd_line,
    short_text,
)

__all__ = ["read_textgrid", "write_textgrid"]

Format = Literal["long", "short", "json"]

_WRITERS = {"long": long_text, "short": short_text, "json": json_text}
_ADVICE = "a whole Praat TextGrid was expected; save it again in Praat"
_BROKEN = (
    praat_errors.PraatioException,
    ValueError,  # UnicodeError is one
    KeyError,
    IndexError,
    TypeError,
    AttributeError,
    OverflowError,
    RecursionError,
    OSError,
)

_NO_NUMBER = re.compile(r"(?:invalid literal|could not convert).*?: ['\"](.*)['\"]$")


@LABEL_READERS.register(".textgrid")
@LABEL_READERS.register(".json")
def read_textgrid(path: Path) -> Labels:
    """Read a TextGrid in Praat's long or short format, or praatio's JSON.

    Parameters
    ----------
    path : Path
        UTF-8, or UTF-16 with a byte-order mark, as Praat writes it.

    Returns
    -------
    Labels
        Every tier in s, blank intervals included, names and labels as they stand in the file.

    Raises
    ------
    LabelError
        The file is cut or is none, two tiers share a name, or times are negative, out of order or no
        numbers; the message names the file.
    """
    try:
        text = _decoded(path.read_bytes())
        return _parsed_json(text) if text.lstrip().startswith("{") else _parsed(text)
    except LabelError as error:
        raise LabelError(f"'{path}': {error}") from None
    except _BROKEN as error:
        raise LabelError(f"'{path}' cannot be read as a TextGrid ({_reason(error)}): {_ADVICE}.") from None


def _reason(error: Exception) -> str:
    """Return what is wrong with a file in words of labels, for what praatio and Python raise."""
    said = " ".join(str(error).split())
    if isinstance(error, UnicodeError):
        return "it is neither UTF-8 nor UTF-16 text"
    if isinstance(error, RecursionError):
        return "its brackets are too deep"
    if isinstance(error, OSError):
        return error.strerror or "it cannot be opened"
    if isinstance(error, praat_errors.PraatioException) and said:
        return said[:120].rstrip(".")
    if isinstance(error, OverflowError) or "digits" in said:
        return "a number in it is too long"
    if found := _NO_NUMBER.search(said):
        return f"'{found[1][:40]}' stands where a number was expected"
    return "a part of it is missing, or stands where it should not"


def _decoded(data: bytes) -> str:
    wide = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    text = data.decode("utf-16" if wide else "utf-8-sig")
    return text.replace("\r\n", "\n").replace("\r", "\n") + "\n"


def _parsed(text: str) -> Labels:
    if "ooTextFile" not in text[:200] or "TextGrid" not in text[:200]:
        raise LabelError(f"it does not begin with 'ooTextFile' and 'TextGrid': {_ADVICE}.")
    safe, strings = masked(text)
    if has_negative_times(safe):
        raise LabelError("it holds times below 0 s; shift its times in Praat so that they start at 0.")
    try:
        labels = _labels(textgrid_io.parseTextgridStr(safe, includeEmptyIntervals=True), strings)
    except praat_errors.PraatioException:
        if line := odd_line(safe):
            raise LabelError(f"the line '{line[:80]}' is not as Praat writes it: {_ADVICE}.") from None
        raise
    _check_complete(labels, *declared_sizes(safe))
    return labels


def _parsed_json(text: str) -> Labels:
    try:
        return _labels(textgrid_io.parseTextgridStr(text, includeEmptyIntervals=True), None)
    except (KeyError, TypeError, AttributeError, IndexError):
        raise LabelError("it is no JSON with xmin, xmax and tiers, as praatio writes TextGrids.") from None


def _labels(grid: Mapping[str, Any], strings: list[str] | None) -> Labels:
    """Make :class:`Labels` of praatio's dictionary; `strings` undoes the numbers of :func:`masked`."""
    tiers: list[Tier | PointTier] = []
    span = [float(grid["xmin"]), float(grid["xmax"])]
    for tier in grid["tiers"]:
        name = _word(tier["name"], strings)
        if name in (t.name for t in tiers):
            raise LabelError(f"two tiers are called '{name}'; rename one of them.")
        if tier["class"] == "IntervalTier":
            rows = [Interval(float(a), float(b), _word(s, strings)) for a, b, s in tier["entries"]]
            tiers.append(Tier(name, tuple(rows)))
        else:
            points = [Point(float(t), _word(s, strings)) for t, s in tier["entries"]]
            tiers.append(PointTier(name, tuple(points)))
        span = [min(span[0], float(tier["xmin"])), max(span[1], float(tier["xmax"]))]
    labels = Labels(tuple(tiers), *span)
    _check_times(labels)
    return labels


def _word(text: object, strings: list[str] | None) -> str:
    if not isinstance(text, str):
        raise LabelError(f"the label {text!r} is no text.")
    if strings is None:
        return text
    if not (text.isdecimal() and int(text) < len(strings)):
        raise LabelError(f"a quotation mark within a label is not doubled, as Praat writes it: {_ADVICE}.")
    return strings[int(text)]


def _check_times(labels: Labels) -> None:
    """Refuse what no TextGrid can hold: no tiers, times that are no numbers or outside the file's range."""
    if not labels.tiers:
        raise LabelError(f"there are no tiers: {_ADVICE}.")
    if not (math.isfinite(labels.end_s) and 0 <= labels.start_s < labels.end_s):
        raise LabelError(
            f"it spans {labels.start_s:g} to {labels.end_s:g} s; a range from 0 s up was expected."
        )
    for tier in labels.tiers:
        if isinstance(tier, PointTier):
            spans = [(p.time_s, p.time_s, p.text) for p in tier.points]
        else:
            spans = [(i.start_s, i.end_s, i.text) for i in tier]
        for start, end, text in spans:
            if not labels.start_s - TIME_TOLERANCE_S <= start <= end <= labels.end_s + TIME_TOLERANCE_S:
                raise LabelError(
                    f"tier '{tier.name}': '{text}' at {start:g} s lies outside the range "
                    f"{labels.start_s:g} to {labels.end_s:g} s of the file."
                )


def _check_complete(labels: Labels, n_tiers: int, sizes: list[int]) -> None:
    """Compare what was read with what the file declares: a file cut short must not pass as a shorter one."""
    if not len(labels.tiers) == len(sizes) == n_tiers:
        raise LabelError(f"it says it has {n_tiers} tiers and holds {len(sizes)} whole ones: {_ADVICE}.")
    for tier, size in zip(labels.tiers, sizes, strict=True):
        count = len(tier.points) if isinstance(tier, PointTier) else len(tier)
        if count != size:
            raise LabelError(f"tier '{tier.name}' says it has {size} labels and holds {count}: {_ADVICE}.")


def write_textgrid(path: str | Path, labels: Labels, format: Format = "long") -> None:
    """Write labels as a TextGrid (UTF-8); holes in a tier become blank intervals.

    Written by us and not by praatio, whose writer merges short intervals: a round trip gives equal times and
    labels, and equal labels give equal bytes.

    Parameters
    ----------
    path : path
    labels : Labels
    format : {"long", "short", "json"}

    Raises
    ------
    InputError
        There is no such format.
    LabelError
        No tiers, two tiers of one name, a label outside the range of the file or before 0 s, or text that
        cannot be encoded.
    OutputError
        The file cannot be written.
    """
    if format not in _WRITERS:
        hint = suggestion(str(format), _WRITERS)
        raise InputError(f"There is no TextGrid format '{format}'{hint or '; known: long, short, json.'}")
    try:
        _check_times(labels)
        twice = next((n for n in labels.names if labels.names.count(n) > 1), None)
        if twice is not None:
            raise LabelError(f"two tiers are called '{twice}'; rename one of them.")
        data = _WRITERS[format](labels).encode("utf-8")
    except UnicodeEncodeError as error:
        raise LabelError(f"Cannot write '{path}': a label holds text that is no Unicode ({error}).") from None
    except LabelError as error:
        raise LabelError(f"Cannot write '{path}': {error}") from None
    with atomic_file(path) as temporary:
        temporary.write_bytes(data)
