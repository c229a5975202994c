"""Marker motion in numpy archives: arrays ``xyz`` (frames, markers, 3), ``fps``, ``names``."""

from __future__ import annotations

import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from corpus_tools.core import Capture, FloatArray, MotionError, atomic_file
from corpus_tools.io.formats import MOTION_READERS, MOTION_WRITERS, check_unpacked
from corpus_tools.io.motion_parts import Notes, capture_of, chosen_rate, unit_factor
from corpus_tools.io.writing import checked_motion

__all__ = ["read_markers_npz", "write_markers_npz"]

_ARRAYS = ("xyz", "fps", "names", "units")
_EXPECTED = "a numpy archive with xyz (frames, markers, 3), fps and names was expected"


@MOTION_READERS.register(".npz")
def read_markers_npz(path: Path, *, rate_hz: float | None = None, units: str = "") -> Capture:
    """Read marker motion from a numpy archive; nothing in it is ever unpickled.

    Parameters
    ----------
    path : Path
        Arrays ``xyz`` (n_frames, n_markers, 3), ``fps`` (a number, Hz), ``names`` (n_markers,), and, when the
        positions are not in mm, ``units`` (a text that begins with the unit).
    rate_hz, units
        As in :func:`~corpus_tools.io.formats.read_markers`.

    Raises
    ------
    MotionError
        It is no such archive, or its arrays are no motion; the message says what was found.
    """
    if not zipfile.is_zipfile(path):
        raise MotionError(f"'{path}' is no numpy archive, or one cut short: {_EXPECTED}.")
    try:
        check_unpacked(path, _unpacked_bytes(path))
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as archive:
            missing = [k for k in _ARRAYS[:3] if k not in archive.files]
            if missing:
                raise MotionError(
                    f"'{path}' has no array {missing[0]} (it has {', '.join(archive.files)}): {_EXPECTED}."
                )
            xyz, fps, names = archive["xyz"], archive["fps"], archive["names"]
            unit = archive["units"] if "units" in archive.files else np.array("mm")
        if not all(isinstance(a, np.ndarray) for a in (xyz, fps, names, unit)):
            raise MotionError(f"'{path}' holds something else under the names of its arrays: {_EXPECTED}.")
    except MotionError:
        raise
    except Exception as error:  # zipfile, zlib and numpy raise a dozen kinds on a broken archive
        reason = " ".join(str(error).split())[:120].rstrip(".") or type(error).__name__
        raise MotionError(f"'{path}' cannot be read as marker motion ({reason}): {_EXPECTED}.") from None
    _check(path, xyz, fps, names)
    notes: Notes = []
    rate = chosen_rate(path, float(fps.reshape(())), rate_hz, notes)
    factor = unit_factor(path, _stated_unit(unit), units, notes)
    labels = [str(n) for n in names]
    return capture_of(path, xyz.astype(np.float64) * factor, labels, rate, format="npz", notes=notes)


def _unpacked_bytes(path: Path) -> int:
    """Return what the arrays that are read take when unpacked, by the list of contents of the archive."""
    with zipfile.ZipFile(path) as archive:
        return sum(i.file_size for i in archive.infolist() if i.filename.removesuffix(".npy") in _ARRAYS)


def _stated_unit(unit: npt.NDArray[Any]) -> str:
    """Return the first word of the array ``units``: "mm (file unit cm x10)" means mm."""
    words = str(unit.reshape(-1)[0]).split() if unit.dtype.kind == "U" and unit.size == 1 else []
    return words[0] if words else "mm"


def _check(path: Path, xyz: npt.NDArray[Any], fps: npt.NDArray[Any], names: npt.NDArray[Any]) -> None:
    """Refuse arrays that are no motion."""
    if xyz.dtype.kind not in "fiu" or fps.size != 1 or fps.dtype.kind not in "fiu":
        raise MotionError(
            f"'{path}' holds xyz of {xyz.dtype} and fps of {fps.dtype} {fps.shape}: {_EXPECTED}."
        )
    if names.dtype.kind != "U" or names.ndim != 1:
        raise MotionError(
            f"'{path}' holds names of {names.dtype} {names.shape}; a row of texts was expected."
        )
    if not xyz.size:
        raise MotionError(f"'{path}' holds no frames or no markers (xyz has shape {xyz.shape}).")
    check_unpacked(path, 8 * xyz.size)
    if xyz.ndim != 3 or xyz.shape[2] != 3:
        raise MotionError(f"'{path}' holds xyz of shape {xyz.shape}; (frames, markers, 3) was expected.")
    if xyz.shape[1] != len(names):
        raise MotionError(f"'{path}': there are {xyz.shape[1]} markers and {len(names)} marker names.")


@MOTION_WRITERS.register("npz")
def _write_npz(path: str | Path, positions_mm: FloatArray, names: Sequence[str], rate_hz: float) -> None:
    positions, labels = checked_motion(path, positions_mm, names, rate_hz)
    write_markers_npz(path, Capture(positions, rate_hz, tuple(labels)))


def write_markers_npz(path: str | Path, capture: Capture) -> None:
    """Write a capture as a numpy archive that :func:`read_markers_npz` reads; equal captures, equal bytes.

    Positions are kept as float32 (a rounding below 1e-4 mm for a face within a metre of the origin), missing
    ones as NaN; flags, history, audio and ``start_s`` have no place in this layout.

    Parameters
    ----------
    path : path
    capture : Capture

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    with atomic_file(path) as temporary, temporary.open("wb") as stream:
        np.savez_compressed(
            stream,
            xyz=capture.positions_mm.astype(np.float32),
            fps=np.float64(capture.rate_hz),
            names=np.array(capture.names),
        )
