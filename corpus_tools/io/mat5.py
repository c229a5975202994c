"""MATLAB files of version 5 to 7: numbers, texts, structs, cells; every size is checked before it is used.

scipy reads the same and is the oracle of the tests, but ends the process on some damaged files.
"""

from __future__ import annotations

import math
import struct
import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from corpus_tools.core import InputError

__all__ = ["read_mat5"]

_NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_TEXTS = {1: "latin-1", 2: "latin-1", 4: "utf-16", 16: "utf-8", 17: "utf-16", 18: "utf-32"}
_MATRIX, _COMPRESSED = 14, 15
_CELL, _STRUCT, _CHAR, _NUMERIC = 1, 2, 4, range(6, 16)
_DEEPEST, _MOST_AXES = 8, 16
_LARGEST_BYTES = 1 << 30
_CUT = "it is cut short or damaged"


@dataclass(slots=True)
class _Reader:
    """A run of elements, and the place that has been read up to."""

    data: bytes
    order: str
    at: int = 0

    def element(self) -> tuple[int, bytes]:
        """Return kind and content of the next element, and step over its padding."""
        if self.at + 8 > len(self.data):
            raise InputError(_CUT)
        word, size = struct.unpack_from(f"{self.order}2I", self.data, self.at)
        if word >> 16:  # small: four bytes at most, in the tag itself
            kind, size, start, end = word & 0xFFFF, word >> 16, self.at + 4, self.at + 8
        else:
            kind, start = word, self.at + 8
            end = start + size + (-size % 8 if kind != _COMPRESSED else 0)
        if start + size > min(len(self.data), end):
            raise InputError(_CUT)
        self.at = end
        return kind, self.data[start : start + size]

    def numbers(self) -> np.ndarray[Any, Any]:
        """Return the next element as numbers."""
        kind, raw = self.element()
        kind_of = np.dtype(self.order + _NUMBERS.get(kind, "V1"))
        if kind not in _NUMBERS or len(raw) % kind_of.itemsize:
            raise InputError(f"an element of kind {kind} stands where numbers were expected: {_CUT}")
        return np.frombuffer(raw, kind_of)

    def integers(self) -> list[int]:
        """Return the next element as whole numbers."""
        values = self.numbers()
        if values.dtype.kind not in "iu":
            raise InputError(_CUT)
        return [int(v) for v in values]


def _text(reader: _Reader) -> str:
    kind, raw = reader.element()
    codec = _TEXTS.get(kind, "latin-1")
    if codec not in ("latin-1", "utf-8"):
        codec += "-le" if reader.order == "<" else "-be"
    return raw.decode(codec, "replace")


def _matrix(data: bytes, order: str, depth: int) -> tuple[str, Any]:
    """Return name and content: an array, a text, a list of records (struct), a list (cell), or None."""
    if not data:
        return "", np.zeros((0, 0))
    if depth > _DEEPEST:
        raise InputError("its structs stand in each other too deeply")
    reader = _Reader(data, order)
    flags, shape = reader.integers(), reader.integers()
    name = _text(reader)
    if not flags or not 2 <= len(shape) <= _MOST_AXES or min(shape) < 0:
        raise InputError(_CUT)
    kind, count = flags[0] & 0xFF, math.prod(shape)
    if kind == _CHAR:
        return name, _text(reader)
    if kind in _NUMERIC:
        values = reader.numbers()
        if len(values) != count:
            raise InputError(_CUT)
        return name, values.reshape(shape, order="F")
    if kind == _CELL:
        return name, [_child(reader, depth) for _ in range(_possible(count, data))]
    if kind == _STRUCT:
        return name, _records(reader, _possible(count, data), depth)
    return name, None


def _possible(count: int, data: bytes) -> int:
    """Return a number of elements, each of which takes eight bytes of the file at least."""
    if count > len(data) // 8:
        raise InputError(_CUT)
    return count


def _records(reader: _Reader, count: int, depth: int) -> list[dict[str, Any]]:
    widths = reader.integers()
    _, raw = reader.element()
    width = widths[0] if widths else 0
    if not 0 < width <= 1024:
        raise InputError(_CUT)
    fields = [raw[i : i + width].split(b"\0")[0].decode("latin-1") for i in range(0, len(raw), width)]
    return [{field: _child(reader, depth) for field in fields} for _ in range(count)]


def _child(reader: _Reader, depth: int) -> Any:
    kind, data = reader.element()
    if kind != _MATRIX:
        raise InputError(f"an element of kind {kind} stands where an array was expected: {_CUT}")
    return _matrix(data, reader.order, depth + 1)[1]


def read_mat5(data: bytes) -> dict[str, Any]:
    """Return the variables of a MATLAB file.

    Parameters
    ----------
    data : bytes
        The whole file.

    Returns
    -------
    dict
        Name -> array, text, list of records (struct array, in MATLAB's order) or list (cell array); None for
        what is none of these.

    Raises
    ------
    InputError
        It is no such file; the message does not name it.
    """
    if len(data) < 128 or data[126:128] not in (b"IM", b"MI"):
        raise InputError("it does not begin as a MATLAB file of version 5 to 7 does")
    reader = _Reader(data, "<" if data[126:128] == b"IM" else ">", 128)
    if data[124 if reader.order == ">" else 125] != 1:
        raise InputError("it is a MATLAB file of version 7.3; save it with '-v7'")
    held: dict[str, Any] = {}
    while reader.at < len(data):
        kind, raw = reader.element()
        if kind == _COMPRESSED:
            kind, raw = _Reader(_unpacked(raw), reader.order).element()
        if kind == _MATRIX:
            name, value = _matrix(raw, reader.order, 0)
            held[name] = value
    return held


def _unpacked(raw: bytes) -> bytes:
    try:
        return zlib.decompressobj().decompress(raw, _LARGEST_BYTES)
    except zlib.error:
        raise InputError(_CUT) from None
