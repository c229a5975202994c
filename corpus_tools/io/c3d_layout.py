"""The bytes of a C3D file: header, parameters and points, with every size checked before it is used.

ezc3d reads the same and is the oracle of the tests, but ends the process on some damaged files and never
comes back from others (decision 005), so it is not given files of unknown origin.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from corpus_tools.core import FloatArray, MotionError

__all__ = ["C3dHeader", "Parameters", "c3d_header", "c3d_parameters", "c3d_points", "decoded"]

BLOCK = 512
_SIGN = 0x50
_INTEL, _DEC, _SGI = 84, 85, 86
_TYPES = {-1: 1, 1: 1, 2: 2, 4: 4}

Value = list[str] | list[float]
Parameters = dict[str, Value]
"""``"GROUP:NAME"`` (capitals) -> texts, or numbers in file order."""


@dataclass(frozen=True, slots=True)
class C3dHeader:
    """What the first block says, and the byte order: `order` for struct, `dec` for VAX floats."""

    n_points: int
    n_analog: int
    first_frame: int
    last_frame: int
    scale: float
    data_block: int
    rate_hz: float
    parameter_block: int
    order: str
    dec: bool

    @property
    def n_frames(self) -> int:
        """Number of frames by the header."""
        return self.last_frame - self.first_frame + 1


def _floats(data: bytes, order: str, dec: bool) -> FloatArray:
    """Return 4-byte floats; a DEC float is an IEEE one with its halves swapped, times four."""
    if not dec:
        return np.frombuffer(data, f"{order}f4").astype(np.float64)
    words = np.frombuffer(data, "<u2").reshape(-1, 2).astype(np.uint32)
    with np.errstate(invalid="ignore", over="ignore"):
        values = ((words[:, 0] << 16) | words[:, 1]).view(np.float32).astype(np.float64) / 4.0
    return np.asarray(values)


def c3d_header(data: bytes) -> C3dHeader:
    """Read the header of a C3D file.

    Raises
    ------
    MotionError
        It is none; the message does not name the file.
    """
    if len(data) < 2 * BLOCK or data[1] != _SIGN or data[0] == 0:
        raise MotionError("it does not begin as a C3D file does, or is cut short")
    at = (data[0] - 1) * BLOCK
    if at < BLOCK or at + BLOCK > len(data):
        raise MotionError("its parameters lie outside the file: it is cut short or damaged")
    processor = data[at + 3]
    if processor not in (_INTEL, _DEC, _SGI):
        raise MotionError(f"its parameters name the processor {processor}, where 84, 85 or 86 was expected")
    order, dec = (">" if processor == _SGI else "<"), processor == _DEC
    points, analog, first, last, _ = struct.unpack_from(f"{order}5H", data, 2)
    block, _ = struct.unpack_from(f"{order}2H", data, 16)
    scale, rate = (float(_floats(data[i : i + 4], order, dec)[0]) for i in (12, 20))
    return C3dHeader(points, analog, first, last, scale, block, rate, data[0], order, dec)


def _value(raw: bytes, kind: int, shape: tuple[int, ...], header: C3dHeader) -> Value:
    if kind == -1:
        width = shape[0] if shape else 1
        return [decoded(raw[i : i + width]) for i in range(0, len(raw), width)] if width else []
    if kind == 1:
        return [float(b) for b in raw]
    if kind == 2:
        return [float(v) for v in np.frombuffer(raw, f"{header.order}i2")]
    return [float(v) for v in _floats(raw, header.order, header.dec)]


def decoded(raw: bytes) -> str:
    """Return a text of a C3D file, padding gone; UTF-8, or else Latin-1, which the format leaves open."""
    raw = raw.replace(b"\0", b" ").strip()
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def c3d_parameters(data: bytes, header: C3dHeader) -> Parameters:
    """Read the parameter section.

    Raises
    ------
    MotionError
        An entry reaches beyond the file; the message does not name the file.
    """
    at = (header.parameter_block - 1) * BLOCK + 4
    groups: dict[int, str] = {}
    found: list[tuple[int, str, Value]] = []
    try:
        while data[at]:
            size, group = abs(struct.unpack_from("b", data, at)[0]), struct.unpack_from("b", data, at + 1)[0]
            if not group:
                break
            name = decoded(data[at + 2 : at + 2 + size]).upper()
            at += 2 + size
            offset = struct.unpack_from(f"{header.order}H", data, at)[0]
            if group < 0:
                groups[-group] = name
            else:
                found.append((group, name, _entry(data, at + 2, header)))
            if not offset:
                break
            at += offset
    except (IndexError, struct.error):
        raise MotionError("its parameters reach beyond the end of the file: it is cut short") from None
    return {f"{groups.get(group, group)}:{name}": value for group, name, value in found}


def _entry(data: bytes, at: int, header: C3dHeader) -> Value:
    kind, n_axes = struct.unpack_from("bB", data, at)
    if kind not in _TYPES:
        raise MotionError(f"a parameter has the kind {kind}, where -1, 1, 2 or 4 was expected: it is damaged")
    shape = tuple(data[at + 2 : at + 2 + n_axes])
    size = _TYPES[kind] * math.prod(shape)
    start = at + 2 + n_axes
    if len(shape) != n_axes or start + size > len(data):
        raise MotionError("its parameters reach beyond the end of the file: it is cut short")
    return _value(data[start : start + size], kind, shape, header)


def c3d_points(
    data: bytes, header: C3dHeader, n_frames: int, scale: float, data_block: int
) -> tuple[FloatArray, npt.NDArray[np.bool_]]:
    """Read the points of the first `n_frames` frames.

    Parameters
    ----------
    data : bytes
    header : C3dHeader
    n_frames : int
    scale : float
        Of integer data; negative: the data are floats.
    data_block : int

    Returns
    -------
    positions : (n_frames, n_points, 3) float64, unit of the file
    missing : (n_frames, n_points) bool
        Where the residual is below 0 or a coordinate is not a number.

    Raises
    ------
    MotionError
        The file holds fewer frames.
    """
    width = 4 if scale < 0 else 2
    n_values = 4 * header.n_points + header.n_analog
    start = (data_block - 1) * BLOCK
    held = max(len(data) - start, 0) // (width * n_values) if data_block > 1 else 0
    if held < n_frames:
        raise MotionError(f"its header says {n_frames} frames and it holds {held}: it is cut short")
    raw = data[start : start + width * n_values * n_frames]
    if width == 4:
        values = _floats(raw, header.order, header.dec).reshape(n_frames, n_values)
    else:
        values = np.frombuffer(raw, f"{header.order}i2").astype(np.float64).reshape(n_frames, n_values)
    points = values[:, : 4 * header.n_points].reshape(n_frames, header.n_points, 4)
    positions = points[:, :, :3] * (1.0 if width == 4 else scale)
    return positions, (points[:, :, 3] < 0) | ~np.isfinite(positions).all(axis=2)
