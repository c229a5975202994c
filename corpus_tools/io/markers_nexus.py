"""Trajectories as Vicon Nexus exports them to text: a title, the rate, names, axes, units, frames."""

from __future__ import annotations

from itertools import takewhile

import numpy as np

from corpus_tools.core import Capture, MotionError
from corpus_tools.io.motion_clock import frames_of_numbers, placed
from corpus_tools.io.motion_parts import Notes, capture_of, chosen_rate, unit_factor
from corpus_tools.io.table import Table, numbers

__all__ = ["is_nexus", "read_nexus"]

_TITLE = "trajectories"
_EXPECTED = (
    "the rows rate, names, 'Frame, Sub Frame, X, Y, Z, ...' and units were expected after 'Trajectories'"
)


def _title_row(table: Table) -> int | None:
    """Return the row that begins the trajectories; other sections (devices, joints) may stand before it."""
    for i, row in enumerate(table.rows):
        if row[0].lower() == _TITLE and not any(row[1:]):
            return i
    return None


def is_nexus(table: Table) -> bool:
    """Return whether a table is such an export."""
    return _title_row(table) is not None


def _markers(names: list[str], axes: list[str]) -> dict[str, int]:
    """Return the first column of every marker that has X, Y, Z; velocities (X', X'') are left alone."""
    found: dict[str, int] = {}
    for i, name in enumerate(names):
        if name and [a.upper() for a in axes[i : i + 3]] == ["X", "Y", "Z"]:
            if name in found and not name.rpartition(":")[2].startswith("*"):
                raise MotionError(f"the marker name '{name}' stands twice; rename one of the two")
            found[name] = i
    return found


def _is_frame(row: list[str]) -> bool:
    return row[0].lstrip("-").isdigit()


def read_nexus(table: Table, *, rate_hz: float | None = None, units: str = "") -> Capture:
    """Read the section "Trajectories".

    Parameters
    ----------
    table : Table
    rate_hz, units
        As in :func:`~corpus_tools.io.formats.read_markers`.

    Raises
    ------
    MotionError
        The section is not whole.
    """
    path, title = table.path, _title_row(table)
    assert title is not None
    head = table.rows[title + 1 : title + 5]
    if len(head) == 4 and _is_frame(head[3]):
        head[3] = []  # a row of blank units is none
    try:
        if len(head) < 4 or head[2][0].lower() != "frame":
            raise MotionError("its head is not whole")
        markers = _markers(head[1], head[2])
        if not markers:
            raise MotionError("it names no markers with X, Y and Z")
    except MotionError as error:
        raise MotionError(f"'{path}' is no whole Vicon export: {error}; {_EXPECTED}.") from None
    start = title + (5 if head[3] else 4)
    rows = list(takewhile(_is_frame, table.rows[start:]))
    if not rows:
        raise MotionError(f"'{path}' holds no frames under 'Trajectories'; export it again.")
    stop = start + len(rows)
    return _capture(table, head, markers, (start, stop), rate_hz, units)


def _capture(
    table: Table,
    head: list[list[str]],
    markers: dict[str, int],
    span: tuple[int, int],
    rate_hz: float | None,
    units: str,
) -> Capture:
    path, notes = table.path, Notes()
    start, stop = span
    used = {head[3][i + k].lower() for i in markers.values() for k in range(3) if i + k < len(head[3])} - {""}
    if len(used) > 1:
        raise MotionError(f"'{path}' mixes the units {', '.join(sorted(used))[:60]}; export it in one.")
    factor = unit_factor(path, next(iter(used), ""), units, notes)
    rate = chosen_rate(path, _rate(table, head[0][0]), rate_hz, notes)
    frames = frames_of_numbers(path, numbers(table, start, [0], stop)[:, 0], table.lines[start:stop])
    columns = [i + k for i in markers.values() for k in range(3)]
    positions = numbers(table, start, columns, stop).reshape(-1, len(markers), 3)
    positions = placed(path, positions, frames, notes) * factor
    return capture_of(path, np.asarray(positions), list(markers), rate, format="nexus", notes=notes)


def _rate(table: Table, cell: str) -> float:
    try:
        return float(cell.replace(",", "."))
    except ValueError:
        raise MotionError(
            f"'{table.path}': '{cell[:40]}' stands under 'Trajectories', where the frame rate was expected."
        ) from None
