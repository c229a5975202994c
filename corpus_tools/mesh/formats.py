"""Surfaces of common mesh files, each read whole: OBJ, PLY (text and binary)."""

from __future__ import annotations

import itertools
import struct
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from corpus_tools.core import FloatArray, IntArray, Registry

__all__ = ["SURFACE_READERS", "RawSurface", "read_obj", "read_ply"]


@dataclass(frozen=True, slots=True, eq=False)
class RawSurface:
    """What a mesh file holds, in its own unit.

    Attributes
    ----------
    points : (n_vertices, 3) float64, unit of the file
    faces : (n_faces, 3) int64
    face_part : (n_faces,) int64
        Index into `part_names`.
    part_names : tuple of str
    """

    points: FloatArray
    faces: IntArray
    face_part: IntArray
    part_names: tuple[str, ...]


SURFACE_READERS: Registry[Callable[[Path], RawSurface]] = Registry("mesh format")

_PLY_KINDS = {
    **{"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"},
    **{"float": "f4", "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2"},
    **{"int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8"},
}


@SURFACE_READERS.register(".obj")
def read_obj(file: Path) -> RawSurface:
    """Read vertices and polygons; groups and objects become parts, polygons fans of triangles."""
    points: list[list[float]] = []
    faces: list[list[int]] = []
    face_part: list[int] = []
    names: list[str] = []
    current = "skin"
    for line in file.read_text(encoding="utf-8", errors="replace").splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == "v":
            points.append([float(x) for x in words[1:4]])
        elif words[0] in ("g", "o") and len(words) > 1:
            current = words[1]
        elif words[0] == "f":
            if current not in names:
                names.append(current)
            fan = _fan([_corner(w, len(points)) for w in words[1:]])
            faces += fan
            face_part += [names.index(current)] * len(fan)
    return _surface(points, faces, face_part, names or ["skin"])


@SURFACE_READERS.register(".ply")
def read_ply(file: Path) -> RawSurface:
    """Read the elements vertex (x, y, z) and face (list of vertices); all else in the file is passed over."""
    data = file.read_bytes()
    end = data.index(b"end_header")
    start = data.index(b"\n", end) + 1
    header = [line.split() for line in data[:end].decode("ascii").splitlines()]
    if not header or header[0] != ["ply"]:
        raise ValueError("it does not begin with 'ply'")
    kind = next(words[1] for words in header if words[:1] == ["format"])
    take = _text_taker(data[start:]) if kind == "ascii" else _byte_taker(data, start, kind)
    points: list[list[float]] = []
    faces: list[list[int]] = []
    for name, count, properties in _ply_elements(header):
        for _ in range(count):
            row = {p[-1]: _ply_value(p, take) for p in properties}
            if name == "vertex":
                points.append([float(row[axis]) for axis in "xyz"])
            elif name == "face":
                corners = row["vertex_indices" if "vertex_indices" in row else "vertex_index"]
                faces += _fan([int(c) for c in corners])
    return _surface(points, faces, [0] * len(faces), ["skin"])


def _surface(points: list[Any], faces: list[Any], part: list[int], names: list[str]) -> RawSurface:
    triangles = np.array(faces, np.int64).reshape(-1, 3)
    return RawSurface(np.array(points, float), triangles, np.array(part, np.int64), tuple(names))


def _fan(corners: list[int]) -> list[list[int]]:
    return [[corners[0], a, b] for a, b in itertools.pairwise(corners[1:])]


def _corner(word: str, n_points: int) -> int:
    """Return the vertex index from 0 of "7/1/3" (from 1) or "-1" (from the end)."""
    number = int(word.split("/")[0])
    return number - 1 if number > 0 else n_points + number


def _ply_elements(header: list[list[str]]) -> list[tuple[str, int, list[list[str]]]]:
    found: list[tuple[str, int, list[list[str]]]] = []
    for words in header:
        if words[:1] == ["element"]:
            found.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            found[-1][2].append(words[1:])
    return found


def _ply_value(words: list[str], take: Callable[[str, int], list[Any]]) -> Any:
    if words[0] != "list":
        return take(_PLY_KINDS[words[0]], 1)[0]
    return take(_PLY_KINDS[words[2]], int(take(_PLY_KINDS[words[1]], 1)[0]))


def _text_taker(data: bytes) -> Callable[[str, int], list[Any]]:
    words = iter(data.split())
    return lambda _, n: [float(next(words, b"")) for _ in range(n)]


def _byte_taker(data: bytes, start: int, kind: str) -> Callable[[str, int], list[Any]]:
    order, place = "<" if kind == "binary_little_endian" else ">", start
    letters = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "f4": "f", "f8": "d"}

    def take(code: str, n: int) -> list[Any]:
        nonlocal place
        layout = f"{order}{n}{letters[code]}"
        if place + struct.calcsize(layout) > len(data):
            raise ValueError("it ends too early")
        values = struct.unpack_from(layout, data, place)
        place += struct.calcsize(layout)
        return list(values)

    return take
