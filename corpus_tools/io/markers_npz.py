"""Marker motion in numpy archives: arrays ``xyz`` (frames, markers, 3), ``fps``, ``names``."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from corpus_tools.core import Capture, MotionError, atomic_file
from corpus_tools.io.formats import MOTION_READERS

__all__ = ["read_markers_npz", "write_markers_npz"]

_EXPECTED = "a numpy archive with xyz (frames, markers, 3), fps and names was expected"


@MOTION_READERS.register(".npz")
def read_markers_npz(path: Path) -> Capture:
    """Read marker motion from a numpy archive; nothing in it is ever unpickled.

    Parameters
    ----------
    path : Path
        Arrays ``xyz`` (n_frames, n_markers, 3), ``fps`` (a number, Hz), ``names`` (n_markers,).

    Raises
    ------
    MotionError
        It is no such archive, or its arrays are no motion; the message says what was found.
    """
    if not zipfile.is_zipfile(path):
        raise MotionError(f"'{path}' is no numpy archive, or one cut short: {_EXPECTED}.")
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as archive:
            missing = [k for k in ("xyz", "fps", "names") if k not in archive.files]
            if missing:
                raise MotionError(
                    f"'{path}' has no array {missing[0]} (it has {', '.join(archive.files)}): {_EXPECTED}."
                )
            xyz, fps, names = archive["xyz"], archive["fps"], archive["names"]
        if not all(isinstance(a, np.ndarray) for a in (xyz, fps, names)):
            raise MotionError(f"'{path}' holds something else under the names of its arrays: {_EXPECTED}.")
    except MotionError:
        raise
    except Exception as error:  # zipfile, zlib and numpy raise a dozen kinds on a broken archive
        reason = " ".join(str(error).split())[:120].rstrip(".") or type(error).__name__
        raise MotionError(f"'{path}' cannot be read as marker motion ({reason}): {_EXPECTED}.") from None
    return _capture(path, xyz, fps, names)


def _capture(path: Path, xyz: npt.NDArray[Any], fps: npt.NDArray[Any], names: npt.NDArray[Any]) -> Capture:
    """Make a :class:`Capture` of the three arrays, refusing what is no motion."""
    if xyz.dtype.kind not in "fiu" or fps.size != 1 or fps.dtype.kind not in "fiu":
        raise MotionError(
            f"'{path}' holds xyz of {xyz.dtype} and fps of {fps.dtype} {fps.shape}: {_EXPECTED}."
        )
    if names.dtype.kind != "U" or names.ndim != 1:
        raise MotionError(
            f"'{path}' holds names of {names.dtype} {names.shape}; a row of texts was expected."
        )
    rate_hz = float(fps.reshape(()))
    if not np.isfinite(rate_hz) or rate_hz <= 0:
        raise MotionError(f"'{path}' says fps = {rate_hz:g}; a positive frame rate in Hz was expected.")
    if not xyz.size:
        raise MotionError(f"'{path}' holds no frames or no markers (xyz has shape {xyz.shape}).")
    try:
        capture = Capture(xyz, rate_hz, tuple(str(n) for n in names))
    except MotionError as error:
        raise MotionError(f"'{path}': {error}") from None
    frames, markers, _ = np.nonzero(np.isinf(capture.positions_mm))
    if len(frames):
        raise MotionError(
            f"'{path}': marker '{capture.names[markers[0]]}' is infinitely far off in frame {frames[0]}; "
            "a missing position must be NaN."
        )
    return capture


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
