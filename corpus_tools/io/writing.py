"""Motion written to files: what every writer checks, and one function for every format."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from corpus_tools.core import Capture, FloatArray, MotionError, Trajectory
from corpus_tools.io.formats import MOTION_WRITERS
from corpus_tools.io.motion_parts import RATES_HZ

__all__ = ["cell_text", "checked_motion", "timed_rows", "write_motion_file"]


def checked_motion(
    path: str | Path, positions_mm: FloatArray, names: Sequence[str], rate_hz: float
) -> tuple[FloatArray, list[str]]:
    """Return positions and names as a writer takes them.

    Raises
    ------
    MotionError
        Shapes that do not fit, infinite positions, a bad rate, names that are blank, doubled or of two lines.
    """
    where = f"Cannot write '{path}'"
    positions = np.asarray(positions_mm, dtype=np.float64)
    labels = [str(n) for n in names]
    if positions.ndim != 3 or positions.shape[1:] != (len(labels), 3) or not positions.size:
        raise MotionError(
            f"{where}: positions of shape {positions.shape} with {len(labels)} names; "
            "(frames, markers, 3) was expected."
        )
    if np.isinf(positions).any():
        raise MotionError(f"{where}: a position is infinite; a missing one must be NaN.")
    slowest, fastest = RATES_HZ
    if not slowest <= rate_hz <= fastest:
        raise MotionError(
            f"{where}: the frame rate is {rate_hz:g}; {slowest:g} to {fastest:g} Hz was expected."
        )
    for name in labels:
        if name != name.strip() or not name or not name.isprintable() or labels.count(name) > 1:
            raise MotionError(
                f"{where}: the marker name {name[:40]!r} is blank, doubled, or holds blanks at its ends or "
                "characters that cannot be printed; rename it."
            )
    return positions, labels


def cell_text(value: float, digits: int | None = None) -> str:
    """Return a number as a cell of a text table: blank for NaN.

    Without `digits` it is the shortest text that gives the number back.
    """
    if value != value:
        return ""
    return repr(value) if digits is None else f"{value:.{digits}f}"


def timed_rows(positions_mm: FloatArray, rate_hz: float) -> Iterator[tuple[int, float, list[float]]]:
    """Yield (frame from 0, time in s, x y z of every marker, mm) of each frame, as text tables hold them."""
    for index, row in enumerate(positions_mm.reshape(len(positions_mm), -1).tolist()):
        yield index, index / rate_hz, row


def write_motion_file(path: str | Path, motion: Capture | Trajectory, format: str | None = None) -> None:
    """Write a capture or a trajectory in the format of its suffix, or in another one.

    Parameters
    ----------
    path : path
    motion : Capture or Trajectory
    format : str, optional
        A name of :data:`~corpus_tools.io.formats.MOTION_WRITERS`: npz, c3d, trc, csv (wide), csv-long.

    Raises
    ------
    InputError
        There is no such format.
    MotionError
        The motion cannot be kept in it.
    OutputError
        The file cannot be written.
    """
    writer = MOTION_WRITERS[format or Path(path).suffix.lower().lstrip(".")]
    positions = motion.positions_mm if isinstance(motion, Capture) else motion.values_mm
    writer(path, positions, motion.names, motion.rate_hz)
