"""Marker motion in text tables: wide, long, and Vicon Nexus exports; which one it is, its header says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from corpus_tools.core import Capture, FloatArray, IntArray, MotionError
from corpus_tools.io.csv_columns import Columns, long_columns, wide_columns
from corpus_tools.io.formats import MOTION_READERS
from corpus_tools.io.markers_nexus import is_nexus, read_nexus
from corpus_tools.io.motion_clock import frames_of_numbers, frames_of_times, placed
from corpus_tools.io.motion_parts import Notes, capture_of, chosen_rate, unit_factor
from corpus_tools.io.table import Table, decimals, is_missing, numbers, read_table

__all__ = ["read_csv"]

_EXPECTED = (
    "a wide table (time_s, NAME_x, NAME_y, NAME_z), a long one (time_s, marker, x, y, z) or a Vicon export "
    "of trajectories was expected"
)
_SMALLEST_FACE_MM = 5.0
_CLOUD = 20
"""A long table with so many times more (frame, marker) places than rows is none (our choice)."""


@dataclass(frozen=True, slots=True)
class _Raw:
    """Positions (n_rows, n_markers, 3) as they stand, with times and frame numbers (n_rows, 2) and lines."""

    positions: FloatArray
    names: list[str]
    clock: FloatArray
    lines: list[int]


@MOTION_READERS.register(".csv")
@MOTION_READERS.register(".tsv")
def read_csv(path: Path, *, rate_hz: float | None = None, units: str = "") -> Capture:
    """Read marker motion from a table, columns by name and never by position.

    Parameters
    ----------
    path : Path
        Separated by commas, semicolons or tabs (then decimal commas are taken too); UTF-8 or UTF-16.
    rate_hz, units
        As in :func:`~corpus_tools.io.formats.read_markers`. Without a unit anywhere mm are taken, and told.

    Raises
    ------
    MotionError
        It is no such table; the message says in which line, what was found and what was expected.
    """
    table = read_table(path)
    if is_nexus(table):
        return read_nexus(table, rate_hz=rate_hz, units=units)
    _refuse_coefficients(path, table.rows[0])
    for find, gather, layout in ((long_columns, _long, "csv-long"), (wide_columns, _wide, "csv")):
        columns = find(path, table.rows[0])
        if columns is not None:
            _check_widths(table)
            start, unit = _start(table, columns)
            raw = gather(table, columns, start)
            return _capture(table, columns, start, raw, unit, layout, rate_hz, units)
    shown = ", ".join(c[:20] for c in table.rows[0][:6]) + (", ..." if table.width > 6 else "")
    raise MotionError(
        f"'{path}' is no table of marker positions (its first row: {shown[:120]}): {_EXPECTED}."
    )


def _capture(
    table: Table,
    columns: Columns,
    start: int,
    raw: _Raw,
    unit: str,
    layout: str,
    rate_hz: float | None,
    units: str,
) -> Capture:
    """Put what was gathered on a uniform clock and into mm."""
    path = table.path
    notes: Notes = []
    frames, stated_hz = _frames(table, columns, start, raw)
    rate = chosen_rate(path, stated_hz, rate_hz, notes)
    if columns.time is not None:
        _note_start(float(raw.clock[0, 0]), rate, notes)
    stated = unit or columns.stated_unit(path)
    factor = unit_factor(path, stated, units, notes, default="mm")
    positions = placed(path, raw.positions, frames, notes) * factor
    if not stated and not units:
        _note_size(positions, notes)
    settings = {"columns_left_out": ", ".join(columns.others)[:200]} if columns.others else {}
    return capture_of(path, positions, raw.names, rate, format=layout, notes=notes, **settings)


def _refuse_coefficients(path: Path, header: Sequence[str]) -> None:
    names = {c.lower() for c in header}
    if "blendshapecount" in names or {"jawopen", "mouthclose", "eyeblinkleft"} <= names:
        raise MotionError(
            f"'{path}' holds blendshape coefficients of Live Link Face (as JawOpen, from 0 to 1), no marker "
            f"positions: {_EXPECTED}."
        )


def _start(table: Table, columns: Columns) -> tuple[int, str]:
    """Return the first row of numbers, and the unit that a row under the header gives."""
    row = table.rows[1] if len(table.rows) > 1 else []
    places = [i for axes in columns.axes.values() for i in axes.values() if i < len(row)]
    words = {row[i].strip("()[] ").lower() for i in places} - {""}
    has_units = bool(words) and all(w.isalpha() and not is_missing(w) for w in words)
    if has_units and len(words) > 1:
        raise MotionError(
            f"'{table.path}', line {table.lines[1]}: several units ({', '.join(sorted(words)[:4])}); "
            "export it in one."
        )
    start = 2 if has_units else 1
    if len(table.rows) <= start:
        raise MotionError(f"'{table.path}' holds no frames under its header.")
    return start, words.pop() if has_units else ""


def _check_widths(table: Table) -> None:
    """Refuse rows with more cells than the header has names, as decimal commas between commas give."""
    for row, line in zip(table.rows, table.lines, strict=True):
        if len(row) > table.width and any(row[table.width :]):
            hint = "; decimal commas need semicolons between the columns" if table.delimiter == "," else ""
            raise MotionError(
                f"'{table.path}', line {line}: {len(row)} cells, where the header has {table.width}{hint}."
            )


def _clock(table: Table, columns: Columns, start: int) -> FloatArray:
    """Return times (s) and frame numbers of the rows, (n_rows, 2), NaN where there is no such column."""
    out = np.full((len(table.rows) - start, 2), np.nan)
    for i, (column, scale) in enumerate(((columns.time, columns.time_scale), (columns.frame, 1.0))):
        if column is not None:
            out[:, i] = numbers(table, start, [column])[:, 0] * scale
    return out


def _wide(table: Table, columns: Columns, start: int) -> _Raw:
    places = [axes[a] for axes in columns.axes.values() for a in "xyz"]
    positions = numbers(table, start, places).reshape(-1, len(columns.axes), 3)
    return _Raw(positions, list(columns.axes), _clock(table, columns, start), table.lines[start:])


def _long(table: Table, columns: Columns, start: int) -> _Raw:
    """Gather the rows of every frame; a marker that has no row in a frame is missing there."""
    assert columns.marker is not None
    path, clock = table.path, _clock(table, columns, start)
    which = 1 if columns.frame is not None else 0
    if columns.frame is None and columns.time is None:
        raise MotionError(f"'{path}' has a row for each marker and no times or frames: {_EXPECTED}.")
    if np.isnan(clock[:, which]).any():
        at = int(np.argmax(np.isnan(clock[:, which])))
        raise MotionError(f"'{path}', line {table.lines[start + at]}: there is no time or frame number.")
    labels = [row[columns.marker] if columns.marker < len(row) else "" for row in table.rows[start:]]
    names = list(dict.fromkeys(labels))
    column = {name: i for i, name in enumerate(names)}
    _, first, row_of = np.unique(clock[:, which], return_index=True, return_inverse=True)
    marker_of = np.array([column[label] for label in labels], dtype=np.int64)
    _check_long(table, start, len(first), row_of, marker_of, names)
    _check_times_agree(table, columns, start, clock[:, 0], clock[first, 0][row_of])
    positions = np.full((len(first), len(names), 3), np.nan)
    positions[row_of, marker_of] = numbers(table, start, [columns.axes[""][a] for a in "xyz"])
    return _Raw(positions, names, clock[first], [table.lines[start + i] for i in first])


def _check_long(
    table: Table, start: int, n_frames: int, row_of: IntArray, marker_of: IntArray, names: Sequence[str]
) -> None:
    """Refuse two rows for one marker in one frame, and a column of markers that holds something else."""
    n_rows = len(marker_of)
    if n_frames * len(names) > _CLOUD * n_rows + 1000:
        raise MotionError(
            f"'{table.path}' names {len(names)} markers in {n_frames} frames in {n_rows} rows: {_EXPECTED}."
        )
    place = row_of * len(names) + marker_of
    _, firsts = np.unique(place, return_index=True)
    if len(firsts) < n_rows:
        again = int(np.setdiff1d(np.arange(n_rows), firsts)[0])
        raise MotionError(
            f"'{table.path}', line {table.lines[start + again]}: marker '{names[marker_of[again]]}' stands "
            "twice in one frame; one recording, with one row a marker and frame, was expected."
        )


def _check_times_agree(
    table: Table, columns: Columns, start: int, times_s: FloatArray, of_frame_s: FloatArray
) -> None:
    if columns.time is None or columns.frame is None:
        return
    differs = np.abs(times_s - of_frame_s) > 1e-6 + 1e-6 * np.abs(of_frame_s)
    if differs.any():
        at = int(np.argmax(differs))
        raise MotionError(
            f"'{table.path}', line {table.lines[start + at]}: the time {times_s[at]:g} s, where other rows "
            f"of its frame have {of_frame_s[at]:g} s."
        )


def _frames(table: Table, columns: Columns, start: int, raw: _Raw) -> tuple[IntArray, float | None]:
    """Return frame numbers from 0, and the rate when there are times."""
    if columns.time is not None:
        n_decimals = decimals(table, start, columns.time) + (3 if columns.time_scale < 1 else 0)
        return frames_of_times(table.path, raw.clock[:, 0], n_decimals, raw.lines)
    if columns.frame is not None:
        return frames_of_numbers(table.path, raw.clock[:, 1], raw.lines), None
    return np.arange(len(raw.positions)), None


def _note_start(first_s: float, rate_hz: float, notes: Notes) -> None:
    if abs(first_s) * rate_hz > 1.0 + 1e-6:
        notes.append(
            f"its times start at {first_s:g} s and are moved to 0 s; if the sound starts at 0 s, set "
            f"audio_offset_s = {first_s:g} in corpus.toml."
        )


def _note_size(positions_mm: FloatArray, notes: Notes) -> None:
    """Tell of markers that lie too near to each other for a face in mm, when no unit was given."""
    seen = np.isfinite(positions_mm).all(axis=2)
    if not seen.any():
        return
    shown = positions_mm[int(np.argmax(seen.sum(axis=1)))]
    shown = shown[np.isfinite(shown).all(axis=1)]
    size = float(np.ptp(shown, axis=0).max())
    if len(shown) > 2 and size < _SMALLEST_FACE_MM:
        notes.append(f"the markers lie within {size:.3g} mm, which is no face: check 'marker_units'.")
