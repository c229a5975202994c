"""Marker motion written as text tables: wide (a row a frame) and long (a row a marker and frame)."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path

from corpus_tools.core import FloatArray, atomic_file
from corpus_tools.io.formats import MOTION_WRITERS
from corpus_tools.io.writing import cell_text, checked_motion, timed_rows

__all__ = ["write_csv", "write_csv_long"]


def _write(path: str | Path, header: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Write a table; the header is quoted where a name could be taken for several cells."""
    ambiguous = any(";" in cell for cell in header)
    with atomic_file(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as stream:
        csv.writer(
            stream, lineterminator="\n", quoting=csv.QUOTE_ALL if ambiguous else csv.QUOTE_MINIMAL
        ).writerow(header)
        csv.writer(stream, lineterminator="\n").writerows(rows)


@MOTION_WRITERS.register("csv")
def write_csv(path: str | Path, positions_mm: FloatArray, names: Sequence[str], rate_hz: float) -> None:
    """Write a wide table: ``time_s``, then ``NAME_X (mm)``, ``NAME_Y (mm)``, ``NAME_Z (mm)``; NaN is blank.

    Numbers are written so that they come back exactly. A single frame has no rate in this layout.

    Raises
    ------
    MotionError
        The arrays are no motion.
    OutputError
        The file cannot be written.
    """
    positions, labels = checked_motion(path, positions_mm, names, rate_hz)
    header = ["time_s", *(f"{name}_{axis} (mm)" for name in labels for axis in "XYZ")]
    rows = timed_rows(positions, rate_hz)
    _write(path, header, ([repr(time_s), *map(cell_text, row)] for _, time_s, row in rows))


@MOTION_WRITERS.register("csv-long")
def write_csv_long(path: str | Path, positions_mm: FloatArray, names: Sequence[str], rate_hz: float) -> None:
    """Write a long table: ``frame, time_s, marker, x_mm, y_mm, z_mm``, a row for every marker and frame.

    Raises
    ------
    MotionError
        The arrays are no motion.
    OutputError
        The file cannot be written.
    """
    positions, labels = checked_motion(path, positions_mm, names, rate_hz)
    header = ["frame", "time_s", "marker", "x_mm", "y_mm", "z_mm"]
    _write(
        path,
        header,
        (
            [str(i), repr(time_s), name, *map(cell_text, row[3 * k : 3 * k + 3])]
            for i, time_s, row in timed_rows(positions, rate_hz)
            for k, name in enumerate(labels)
        ),
    )
