"""Text tables as they are met: byte-order marks, semicolons, decimal commas, quoted names, blank rows."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from corpus_tools.core import FloatArray, MotionError

__all__ = ["Table", "decimals", "is_missing", "numbers", "read_table", "text_of"]

_MISSING = frozenset(("", "na", "nan", "n/a", "null", "none", "-", "#n/a"))
_DELIMITERS = ";\t,"


@dataclass(frozen=True, slots=True)
class Table:
    """The rows of a file that hold anything, each with its line number (from 1)."""

    path: Path
    rows: list[list[str]]
    lines: list[int]
    delimiter: str

    @property
    def width(self) -> int:
        """Number of columns of the first row."""
        return len(self.rows[0])


def text_of(path: Path) -> str:
    """Return the text of a file: UTF-8, or UTF-16 with its byte-order mark; lines ended by line feeds.

    Raises
    ------
    MotionError
        It is no such text.
    """
    data = path.read_bytes()
    wide = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    try:
        text = data.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError as error:
        raise MotionError(
            f"'{path}' is no UTF-8 text (byte {error.start}); save it again as UTF-8, or check what it is."
        ) from None
    if "\0" in text:
        raise MotionError(f"'{path}' is no text: it holds NUL characters; a table of positions was expected.")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _delimiter(text: str) -> str:
    """Return what separates the cells: the most frequent candidate in the first line that has one."""
    for line in text[:100_000].split("\n"):
        outside = "".join(line.split('"')[::2])
        if any(d in outside for d in _DELIMITERS):
            return max(_DELIMITERS, key=outside.count)
    return ","


def read_table(path: Path) -> Table:
    """Read a table of text.

    Raises
    ------
    MotionError
        It is no text, has quotes that do not close, or nothing in it.
    """
    text = text_of(path)
    delimiter = _delimiter(text)
    reader = csv.reader(io.StringIO(text), delimiter=delimiter, strict=True)
    rows, lines = [], []
    try:
        for row in reader:
            if any(cell.strip() for cell in row):
                rows.append([cell.strip() for cell in row])
                lines.append(reader.line_num)
    except csv.Error as error:
        raise MotionError(f"'{path}', line {reader.line_num + 1}: {error}; check its quotes.") from None
    if not rows:
        raise MotionError(f"'{path}' holds nothing but blank lines.")
    return Table(path, rows, lines, delimiter)


def is_missing(cell: str) -> bool:
    """Return whether a cell stands for no value."""
    return cell.lower() in _MISSING


def _value(cell: str, comma: bool) -> float:
    if is_missing(cell):
        return float("nan")
    if comma:
        if "." in cell:
            raise ValueError(cell)
        cell = cell.replace(",", ".")
    if "_" in cell:  # Python takes 1_000 for a number
        raise ValueError(cell)
    return float(cell)


def numbers(table: Table, start: int, columns: Sequence[int], stop: int | None = None) -> FloatArray:
    """Return columns of the rows from `start` on as numbers, NaN where a cell is blank or NA.

    Raises
    ------
    MotionError
        A cell that is no number, or a row too short or too long; the message says in which line.
    """
    rows, lines = table.rows[start:stop], table.lines[start:stop]
    comma = table.delimiter != "," and any("," in row[c] for row in rows for c in columns if c < len(row))
    out = np.empty((len(rows), len(columns)))
    top = max(columns)
    for i, row in enumerate(rows):
        if len(row) <= top:
            raise MotionError(
                f"'{table.path}', line {lines[i]}: {len(row)} cells, where {top + 1} were expected; it may "
                "be cut short: export it again."
            )
        try:
            out[i] = [_value(row[c], comma) for c in columns]
        except ValueError:
            bad = next(row[c] for c in columns if not _is_number(row[c], comma))
            raise MotionError(
                f"'{table.path}', line {lines[i]}: '{bad[:40]}' is no number; a position, a time or a blank "
                "cell was expected."
            ) from None
    return out


def _is_number(cell: str, comma: bool) -> bool:
    try:
        _value(cell, comma)
    except ValueError:
        return False
    return True


def decimals(table: Table, start: int, column: int) -> int:
    """Return with how many decimals the numbers of a column are written, at most."""
    found = [row[column].replace(",", ".").lower() for row in table.rows[start:] if column < len(row)]
    return max((17 if "e" in c else len(c.partition(".")[2]) for c in found), default=0)
