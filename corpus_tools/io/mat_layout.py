"""MATLAB files of version 5 to 7 looked through before scipy reads them: a damaged one ends its process."""

from __future__ import annotations

import math
import struct
import zlib
from dataclasses import dataclass

from corpus_tools.io.formats import LARGEST_UNPACKED_BYTES

__all__ = ["MatLayoutError", "struct_names"]

_BYTES_OF = {1: 1, 2: 1, 3: 2, 4: 2, 5: 4, 6: 4, 7: 4, 9: 8, 12: 8, 13: 8}
_TEXT_BYTES_OF = {1: 1, 2: 1, 4: 2, 16: 1, 17: 2, 18: 4}
_INT8, _INT32, _UINT32, _MATRIX, _COMPRESSED = 1, 5, 6, 14, 15
_CELL, _STRUCT, _CHAR, _NUMBERS = 1, 2, 4, range(6, 16)
_COMPLEX = 0x0800
_HEADER_BYTES, _DEEPEST, _LONGEST_NAME, _MOST_ARRAYS = 128, 16, 64, 1_000_000


class MatLayoutError(ValueError):
    """What is wrong with the layout, and at which byte."""


@dataclass(frozen=True, slots=True)
class _Part:
    kind: int
    start: int
    end: int
    after: int

    @property
    def size(self) -> int:
        return self.end - self.start


def struct_names(data: bytes, most_bytes: int = LARGEST_UNPACKED_BYTES) -> dict[str, bool]:
    """Return name -> whether it is a struct array, for every variable; the structs are sound in layout.

    Variables that are no struct are not looked into, so that they may be of any kind.

    Parameters
    ----------
    data : bytes
        The whole file; its header of 128 bytes says version 5.
    most_bytes : int
        What may be unpacked, and what the numbers of the structs may take at 8 bytes each.

    Raises
    ------
    MatLayoutError
        A part reaches beyond what holds it, is not of the kind, size or shape that stands there, or there is
        more than `most_bytes`.
    """
    order = "<" if data[126:128] == b"IM" else ">"
    found: dict[str, bool] = {}
    n_unpacked, n_values = 0, 0
    at = _HEADER_BYTES
    while at < len(data):
        # what a compressed variable is followed by is not padded
        part = _Walk(data, order).part(at, len(data), padded=False)
        at = part.after
        inside = data[part.start : part.end]
        if part.kind == _COMPRESSED:
            inside = _unpacked(inside, part.start, most_bytes - n_unpacked)
            n_unpacked += len(inside)
            walk = _Walk(inside, order)
            held = walk.part(0, len(inside))
        else:
            walk, held = _Walk(data, order), part
        if held.kind != _MATRIX:
            raise MatLayoutError(f"no variable at byte {part.start}")
        name, kind = walk.named(held)
        found[name] = kind == _STRUCT
        if kind == _STRUCT:
            n_values += walk.matrix(held, 0)
        if 8 * n_values > most_bytes:
            raise MatLayoutError(f"its numbers take more than {most_bytes / 2**30:.3g} GB")
    return found


def _unpacked(packed: bytes, at: int, most: int) -> bytes:
    stream = zlib.decompressobj()
    try:
        data = stream.decompress(packed, most + 1)
    except zlib.error as error:
        raise MatLayoutError(f"a compressed variable at byte {at} cannot be unpacked, {error}") from None
    if len(data) > most:
        raise MatLayoutError(f"the compressed variable at byte {at} holds more than is unpacked at once")
    if not stream.eof:
        raise MatLayoutError(f"a compressed variable at byte {at} is cut short")
    return data


@dataclass(frozen=True, slots=True)
class _Walk:
    data: bytes
    order: str

    def part(self, at: int, end: int, *, padded: bool = True) -> _Part:
        """Return the part whose tag is at `at`; it must end by `end`."""
        if at + 8 > end:
            raise MatLayoutError(f"it ends within a tag at byte {at}")
        kind, size = struct.unpack_from(f"{self.order}II", self.data, at)
        if kind >> 16:  # up to four bytes, held in the tag itself
            kind, size = kind & 0xFFFF, kind >> 16
            if size > 4:
                raise MatLayoutError(f"a part of {size} bytes in a place for 4 at byte {at}")
            return _Part(kind, at + 4, at + 4 + size, at + 8)
        start = at + 8
        if start + size > end:
            raise MatLayoutError(f"a part of {size} bytes at byte {at}, where {end - start} are left")
        after = start + size + (-size % 8 if padded else 0)
        return _Part(kind, start, start + size, min(after, end))

    def of_kind(self, kind: int, at: int, end: int, sizes: range) -> _Part:
        part = self.part(at, end)
        if part.kind != kind or part.size not in sizes:
            raise MatLayoutError(f"kind {part.kind} with {part.size} bytes at byte {at}, where {kind} is due")
        return part

    def head(self, held: _Part) -> tuple[int, bool, int, int, str]:
        """Return class, whether complex, number of elements, where the head ends, and the name."""
        flags = self.of_kind(_UINT32, held.start, held.end, range(8, 9))
        (word,) = struct.unpack_from(f"{self.order}I", self.data, flags.start)
        shape = self.of_kind(_INT32, flags.after, held.end, range(8, 4 * 32 + 1, 4))
        sizes = struct.unpack_from(f"{self.order}{shape.size // 4}i", self.data, shape.start)
        if min(sizes) < 0:
            raise MatLayoutError(f"a negative size at byte {shape.start}")
        name = self.of_kind(_INT8, shape.after, held.end, range(_LONGEST_NAME))
        text = self.data[name.start : name.end].decode("latin-1")
        return word & 0xFF, bool(word & _COMPLEX), math.prod(sizes), name.after, text

    def named(self, held: _Part) -> tuple[str, int]:
        flags = self.of_kind(_UINT32, held.start, held.end, range(8, 9))
        (word,) = struct.unpack_from(f"{self.order}I", self.data, flags.start)
        if word & 0xFF not in (_STRUCT, _CELL, _CHAR, *_NUMBERS):
            return f"a variable of class {word & 0xFF}", word & 0xFF
        kind, _, _, _, name = self.head(held)
        return name, kind

    def matrix(self, held: _Part, depth: int) -> int:
        """Go through an array with everything in it, and return how many numbers and signs it holds."""
        if not held.size:
            return 0  # an empty array has no head
        if depth > _DEEPEST:
            raise MatLayoutError(f"arrays in arrays more than {_DEEPEST} deep at byte {held.start}")
        kind, complex_, n, at, _ = self.head(held)
        if kind == _STRUCT:
            length = self.of_kind(_INT32, at, held.end, range(4, 5))
            (one,) = struct.unpack_from(f"{self.order}i", self.data, length.start)
            names = self.part(length.after, held.end)
            if names.kind != _INT8 or not 0 < one <= _LONGEST_NAME or names.size % one:
                raise MatLayoutError(f"no names of fields at byte {length.after}")
            return self.inner(names.after, held.end, n * (names.size // one), depth)
        if kind == _CELL:
            return self.inner(at, held.end, n, depth)
        if kind == _CHAR:
            self.numbers(at, held.end, n, _TEXT_BYTES_OF)
            return n
        if kind in _NUMBERS:
            for _ in range(1 + complex_):
                at = self.numbers(at, held.end, n, _BYTES_OF)
            return n * (1 + complex_)
        raise MatLayoutError(f"an array of class {kind} at byte {held.start}")

    def inner(self, at: int, end: int, n: int, depth: int) -> int:
        if n * 8 > end - at:
            raise MatLayoutError(f"{n} arrays are due at byte {at}, where {end - at} bytes are left")
        if n > _MOST_ARRAYS:
            raise MatLayoutError(
                f"{n} arrays at byte {at}, more than the {_MOST_ARRAYS} that are read at once"
            )
        n_values = 0
        for _ in range(n):
            part = self.part(at, end)
            if part.kind != _MATRIX:
                raise MatLayoutError(f"kind {part.kind} at byte {at}, where an array is due")
            n_values += self.matrix(part, depth + 1)
            at = part.after
        return n_values

    def numbers(self, at: int, end: int, n: int, bytes_of: dict[int, int]) -> int:
        part = self.part(at, end)
        if part.kind not in bytes_of or part.size != n * bytes_of[part.kind]:
            raise MatLayoutError(f"kind {part.kind} with {part.size} bytes at byte {at} for {n} values")
        return part.after
