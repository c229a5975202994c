"""What the columns of a marker table are, from their names alone; never from their order."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from corpus_tools.core import MotionError

__all__ = ["Columns", "long_columns", "wide_columns"]

_UNIT = r"(?:[ _]?[\(\[](?P<unit>[a-zA-Z]+)[\)\]]|_(?P<word>mm|cm|m|inch))?"
_WIDE = re.compile(rf"(?P<name>.+?)[ _.:\-](?P<axis>[xyzXYZ]){_UNIT}")
_LONG_AXIS = re.compile(rf"(?:pos|position)?[ _.]?(?P<axis>[xyzXYZ]){_UNIT}")
_TIME = re.compile(
    r"(?:time|times|t|timestamp)[ _]?[\(\[]?(?P<unit>s|sec|seconds|ms|msec|milliseconds)?[\)\]]?"
)
_FRAME = re.compile(r"frames?(?:[ _]?(?:#|no\.?|number|index|id))?|index|sample|field|#")
_MARKER = re.compile(r"markers?(?:[ _]?(?:name|label|id))?|name|label|point|landmark|sensor|channel")
_NOTHING = re.compile(r"|unnamed: ?\d+")


@dataclass(slots=True)
class Columns:
    """Where in a row what stands: the axes of each marker (long: of the one marker), time, frame number."""

    axes: dict[str, dict[str, int]] = field(default_factory=dict)
    units: set[str] = field(default_factory=set)
    time: int | None = None
    time_scale: float = 1.0
    frame: int | None = None
    marker: int | None = None
    others: list[str] = field(default_factory=list)

    def clock(self, path: Path, index: int, header: str) -> bool:
        """Enter a column of times or frame numbers; false when it is neither."""
        word = header.strip().lower()
        match = _TIME.fullmatch(word)
        if match:
            if self.time is not None:
                raise MotionError(f"'{path}' has two columns of times; keep one.")
            self.time, self.time_scale = index, 1e-3 if (match["unit"] or "").startswith("m") else 1.0
        elif _FRAME.fullmatch(word):
            if self.frame is not None:
                raise MotionError(f"'{path}' has two columns of frame numbers; keep one.")
            self.frame = index
        return bool(match) or self.frame == index

    def axis(self, path: Path, name: str, match: re.Match[str], index: int) -> None:
        """Enter the column of one coordinate of a marker."""
        axis = match["axis"].lower()
        found = self.axes.setdefault(name, {})
        if axis in found:
            raise MotionError(
                f"'{path}' has two columns for {axis} of '{name}' ({match[0]}); rename one of the markers."
            )
        found[axis] = index
        self.units |= {u.lower() for u in (match["unit"], match["word"]) if u}

    def whole(self, path: Path) -> Columns:
        """Return itself when each marker has x, y and z.

        Raises
        ------
        MotionError
            A marker lacks an axis.
        """
        for name, found in self.axes.items():
            lacking = [a for a in "xyz" if a not in found]
            if lacking:
                of = f"marker '{name}' has" if name else "there is"
                raise MotionError(
                    f"'{path}': {of} no column for {' and '.join(lacking)}; x, y and z were expected."
                )
        return self

    def stated_unit(self, path: Path) -> str:
        """Return the unit that column names give, empty when none.

        Raises
        ------
        MotionError
            They give several.
        """
        if len(self.units) > 1:
            raise MotionError(f"'{path}' mixes the units {', '.join(sorted(self.units))}; export it in one.")
        return next(iter(self.units), "")


def wide_columns(path: Path, header: Sequence[str]) -> Columns | None:
    """Return the columns ``NAME_x``, ``NAME_y``, ``NAME_z`` of a wide table, None when there are none.

    Raises
    ------
    MotionError
        A column twice, or a marker without one of its axes.
    """
    columns = Columns()
    for index, cell in enumerate(header):
        if columns.clock(path, index, cell):
            continue
        match = _WIDE.fullmatch(cell)
        if match:
            columns.axis(path, match["name"], match, index)
        elif not _NOTHING.fullmatch(cell.lower()):
            columns.others.append(cell)
    return columns.whole(path) if columns.axes else None


def long_columns(path: Path, header: Sequence[str]) -> Columns | None:
    """Return the columns of a long table (marker, x, y, z, and time or frame), None when it is none.

    Raises
    ------
    MotionError
        A column twice, or x, y or z missing.
    """
    columns = Columns()
    for index, cell in enumerate(header):
        if columns.clock(path, index, cell):
            continue
        match = _LONG_AXIS.fullmatch(cell)
        if match:
            columns.axis(path, "", match, index)
        elif _MARKER.fullmatch(cell.lower()) and columns.marker is None:
            columns.marker = index
        elif not _NOTHING.fullmatch(cell.lower()):
            columns.others.append(cell)
    return columns.whole(path) if columns.marker is not None and columns.axes else None
