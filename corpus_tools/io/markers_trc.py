"""Marker motion in TRC files (Motion Analysis, OpenSim): strict tabs, and a header that must be true."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from corpus_tools.core import Capture, FloatArray, MotionError, atomic_file
from corpus_tools.io.formats import MOTION_READERS, MOTION_WRITERS
from corpus_tools.io.motion_clock import frames_of_times, placed
from corpus_tools.io.motion_parts import Notes, capture_of, chosen_rate, unit_factor
from corpus_tools.io.table import Table, decimals, numbers, text_of
from corpus_tools.io.writing import cell_text, checked_motion, timed_rows

__all__ = ["read_trc", "write_trc"]

_EXPECTED = "a TRC file with tabs between the columns was expected; export it again"
_KEYS = ("DataRate", "NumFrames", "NumMarkers")
_RATE_TOLERANCE = 0.005
"""Part by which the times may disagree with DataRate (our choice)."""


class _LayoutError(MotionError):
    """Something in the layout; the message names no file yet."""


@dataclass(frozen=True, slots=True)
class _Head:
    """What the first five lines say."""

    said: dict[str, str]
    names: list[str]
    first_row: int

    def number(self, key: str) -> float:
        try:
            return float(self.said[key].replace(",", "."))
        except KeyError:
            raise _LayoutError(f"its header has no {key}") from None
        except ValueError:
            raise _LayoutError(f"its header says {key} is '{self.said[key][:20]}', no number") from None


@MOTION_READERS.register(".trc")
def read_trc(path: Path, *, rate_hz: float | None = None, units: str = "") -> Capture:
    """Read marker motion from a TRC file; blank cells are missing positions, each in its own column.

    Parameters
    ----------
    path : Path
    rate_hz, units
        As in :func:`~corpus_tools.io.formats.read_markers`.

    Raises
    ------
    MotionError
        It is no TRC file, its columns are not separated by tabs, or its header says something else than the
        file holds; the message says both.
    """
    lines = text_of(path).split("\n")
    if not lines[0].startswith("PathFileType"):
        raise MotionError(f"'{path}' does not begin with 'PathFileType': {_EXPECTED}.")
    try:
        _refuse_other_delimiters(lines)
        return _capture(path, _table(path, lines, "\t"), rate_hz, units)
    except _LayoutError as error:
        raise MotionError(f"'{path}' cannot be read as TRC: {error}; {_EXPECTED}.") from None


def _capture(path: Path, table: Table, rate_hz: float | None, units: str) -> Capture:
    notes: Notes = []
    head = _head(table)
    positions, times = _numbers(table, head)
    lines = table.lines[head.first_row :]
    frames, by_times_hz = frames_of_times(path, times, decimals(table, head.first_row, 1), lines)
    stated_hz = _stated_rate(path, head, by_times_hz, rate_hz)
    rate = chosen_rate(path, stated_hz, rate_hz, notes)
    factor = unit_factor(path, head.said.get("Units"), units, notes)
    positions = placed(path, positions, frames, notes) * factor
    return capture_of(path, positions, head.names, rate, format="trc", notes=notes)


def _table(path: Path, lines: Sequence[str], delimiter: str) -> Table:
    """Return the rows that hold anything, cells split at every single delimiter."""
    rows = [(i, line.split(delimiter)) for i, line in enumerate(lines, 1) if line.strip(delimiter + " ")]
    return Table(path, [[c.strip() for c in row] for _, row in rows], [i for i, _ in rows], delimiter)


def _refuse_other_delimiters(lines: Sequence[str]) -> None:
    """Say what separates the columns instead of tabs, and whether the header would be true at that."""
    if "\t" in lines[0] or any("\t" in line for line in lines[1:4]):
        return
    delimiter = max(",; ", key="\n".join(lines[:4]).count)
    if not any(delimiter in line for line in lines[:4]):
        raise _LayoutError("there are no tabs in its first lines, nor anything else between columns")
    word = {",": "commas", ";": "semicolons", " ": "spaces"}[delimiter]
    lie = ""
    try:
        table = _table(Path(), lines, delimiter)
        lie = "; besides, " + "; ".join(_lies(table, _head(table)))
    except _LayoutError:
        pass
    raise _LayoutError(f"its columns are separated by {word}" + (lie if len(lie) > 12 else ""))


def _head(table: Table) -> _Head:
    """Read the lines before the numbers.

    Raises
    ------
    MotionError
        They are not whole.
    """
    rows = table.rows
    if len(rows) < 5 or not rows[3][0].lower().startswith("frame"):
        raise _LayoutError("its header is not whole: 'Frame#', 'Time' and names were expected in line 4")
    said = {k: v for k, v in zip(rows[1], rows[2], strict=False) if k}
    cells = rows[3][2:]
    while cells and not cells[-1]:
        cells.pop()
    stray = [c for i, c in enumerate(cells) if c and i % 3]
    if stray:
        raise _LayoutError(f"the marker name '{stray[0][:40]}' does not stand over an x column (every third)")
    names = cells[::3]
    blank = [i for i, n in enumerate(names) if not n]
    if blank:
        raise _LayoutError(f"marker {blank[0] + 1} has no name in line {table.lines[3]}")
    axes = [c[:1].lower() for c in rows[4][2:] if c]
    if axes != list("xyz") * len(names):
        raise _LayoutError(
            f"line {table.lines[4]} names {len(axes)} coordinates, where X1, Y1, Z1, ... of {len(names)} "
            "markers were expected"
        )
    return _Head(said, names, 5)


def _lies(table: Table, head: _Head) -> list[str]:
    """Return what the header says that the file does not hold, each with both numbers."""
    n_rows = len(table.rows) - head.first_row
    said = {key: head.number(key) for key in _KEYS}
    lies = []
    if said["NumFrames"] != n_rows:
        lies.append(f"its header says {said['NumFrames']:g} frames and {n_rows} rows follow")
    if said["NumMarkers"] != len(head.names):
        lies.append(f"its header says {said['NumMarkers']:g} markers and names {len(head.names)}")
    return lies


def _numbers(table: Table, head: _Head) -> tuple[FloatArray, FloatArray]:
    """Return positions (n_frames, n_markers, 3) and times (n_frames,) as they stand in the file."""
    lies = _lies(table, head)
    if lies:
        raise _LayoutError("; ".join(lies))
    if len(table.rows) == head.first_row:
        raise _LayoutError("it holds no frames")
    width = 2 + 3 * len(head.names)
    for row, line in zip(table.rows[head.first_row :], table.lines[head.first_row :], strict=True):
        if len(row) < width or any(row[width:]):
            raise _LayoutError(f"line {line} has {len(row)} cells, where {width} were expected")
    values = numbers(table, head.first_row, range(1, width))
    return values[:, 1:].reshape(len(values), len(head.names), 3), values[:, 0]


def _stated_rate(path: Path, head: _Head, by_times_hz: float | None, rate_hz: float | None) -> float:
    stated = head.number("DataRate")
    differs = by_times_hz is not None and abs(by_times_hz - stated) > _RATE_TOLERANCE * abs(stated)
    if differs and rate_hz is None:
        raise MotionError(
            f"'{path}': its header says DataRate is {stated:g} Hz and its times run at {by_times_hz:.6g} Hz; "
            "correct the one that is wrong, or set 'rate_hz' in corpus.toml."
        )
    return stated


@MOTION_WRITERS.register("trc")
def write_trc(path: str | Path, positions_mm: FloatArray, names: Sequence[str], rate_hz: float) -> None:
    """Write marker motion as TRC: mm to six decimals, missing positions blank; equal motion, equal bytes.

    Raises
    ------
    MotionError
        The arrays are no motion.
    OutputError
        The file cannot be written.
    """
    positions, labels = checked_motion(path, positions_mm, names, rate_hz)
    rate, n = repr(float(rate_hz)), len(positions)
    out = [
        f"PathFileType\t4\t(X/Y/Z)\t{Path(path).name}",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        f"{rate}\t{rate}\t{n}\t{len(labels)}\tmm\t{rate}\t1\t{n}",
        "Frame#\tTime\t" + "\t\t\t".join(labels) + "\t\t",
        "\t\t" + "\t".join(f"{a}{i}" for i in range(1, len(labels) + 1) for a in "XYZ"),
        "",
    ]
    for i, time_s, row in timed_rows(positions, rate_hz):
        cells = "\t".join(cell_text(v, digits=6) for v in row)
        out.append(f"{i + 1}\t{time_s:.9f}\t{cells}")
    with atomic_file(path) as temporary:
        temporary.write_text("\n".join(out) + "\n", encoding="utf-8", newline="\n")
