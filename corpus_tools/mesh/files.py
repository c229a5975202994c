"""Mesh files: .npz of our own layout, and .obj with the markers in NAME.markers.json beside it."""

from __future__ import annotations

import itertools
import json
import os
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from corpus_tools.core import Mesh, MeshError, atomic_file
from corpus_tools.mesh.bundle import CHARACTERS, bundled_head

__all__ = ["mesh_by_name_or_file", "read_mesh", "write_mesh"]

ARRAYS = ("vertices_mm", "faces", "part", "part_names", "marker_names", "marker_vertices", "lip_pairs")


def mesh_by_name_or_file(text: str) -> Mesh:
    """Return a bundled head by name, or read a mesh file.

    Raises
    ------
    MeshError
        Neither a bundled head nor a readable mesh file.
    """
    if text in CHARACTERS:
        return bundled_head(text)
    path = Path(text)
    if path.suffix.lower() in (".npz", ".obj") or path.exists():
        return read_mesh(path)
    raise MeshError(
        f"There is no mesh '{text}'; give one of {', '.join(CHARACTERS)}, or the path of an .npz or .obj."
    )


def read_mesh(path: str | os.PathLike[str]) -> Mesh:
    """Read a mesh, mm, y up, z out of the face, mouth closed.

    ``.npz``: arrays vertices_mm (n, 3), faces (m, 3), part (n,), part_names, marker_names, marker_vertices,
    lip_pairs (k, 2), as :func:`write_mesh` writes them. ``.obj``: vertices and polygons, groups or objects as
    parts; beside it NAME.markers.json: {"markers": {name: vertex from 0}, "lip_pairs": [[upper, lower], ...],
    "scale_to_mm": 1.0}.

    Raises
    ------
    MeshError
        The file is missing, cut, of another kind, or names vertices it does not have.
    """
    file = Path(path)
    if file.is_dir():
        raise MeshError(f"'{file}' is a folder, and an .npz or .obj file was expected; name a mesh in it.")
    if not file.is_file():
        raise MeshError(f"There is no mesh file '{file}'; check the path.")
    readers = {".npz": _read_npz, ".obj": _read_obj}
    if file.suffix.lower() not in readers:
        raise MeshError(f"The mesh file '{file}' ends in '{file.suffix}'; .npz or .obj was expected.")
    try:
        fields = readers[file.suffix.lower()](file)
    except (
        OSError,
        ValueError,
        KeyError,
        IndexError,
        TypeError,
        AttributeError,
        zipfile.BadZipFile,
    ) as error:
        raise MeshError(f"The mesh file '{file}' cannot be read ({error}); export it again.") from error
    mesh = Mesh(name=file.stem, **fields)
    _check(mesh, file)
    return mesh


def write_mesh(path: str | os.PathLike[str], mesh: Mesh) -> None:
    """Write a mesh as ``.npz``; :func:`read_mesh` gives it back exactly."""
    with atomic_file(path) as temporary, temporary.open("wb") as stream:
        np.savez_compressed(
            stream,
            vertices_mm=mesh.vertices_mm,
            faces=mesh.faces,
            part=mesh.part,
            part_names=np.array(mesh.part_names),
            marker_names=np.array(list(mesh.markers), dtype=np.str_),
            marker_vertices=np.array(list(mesh.markers.values()), np.int64),
            lip_pairs=mesh.lip_pairs,
        )


def _check(mesh: Mesh, file: Path) -> None:
    n = mesh.n_vertices
    if mesh.vertices_mm.ndim != 2 or mesh.vertices_mm.shape[1] != 3 or not n:
        raise MeshError(f"The mesh file '{file}' has no vertices of shape (n, 3); export it again.")
    if not np.isfinite(mesh.vertices_mm).all():
        raise MeshError(f"The mesh file '{file}' has vertices that are not finite; export it again.")
    wrong = [name for name, vertex in mesh.markers.items() if not 0 <= vertex < n]
    if wrong:
        raise MeshError(
            f"In '{file}' the marker '{wrong[0]}' stands at vertex {mesh.markers[wrong[0]]}; there are {n}."
        )
    pairs = mesh.lip_pairs
    if pairs.size and (pairs.ndim != 2 or pairs.shape[1] != 2 or pairs.min() < 0 or pairs.max() >= n):
        raise MeshError(f"The lip pairs of '{file}' are not pairs of its {n} vertices; correct them.")


def _read_npz(file: Path) -> dict[str, Any]:
    with file.open("rb") as stream, np.load(stream, allow_pickle=False) as data:
        missing = [name for name in ARRAYS[:2] if name not in data.files]
        if missing:
            raise MeshError(
                f"The mesh file '{file}' has no array '{missing[0]}'; {', '.join(ARRAYS)} are known."
            )
        vertices = data["vertices_mm"]
        names = [str(n) for n in data["marker_names"]] if "marker_names" in data.files else []
        places = data["marker_vertices"].tolist() if names else []
        return {
            "vertices_mm": vertices,
            "faces": data["faces"],
            "part": data["part"] if "part" in data.files else np.zeros(len(vertices), np.int8),
            "part_names": tuple(map(str, data["part_names"])) if "part_names" in data.files else ("skin",),
            "markers": dict(zip(names, places, strict=True)),
            "lip_pairs": data["lip_pairs"] if "lip_pairs" in data.files else np.zeros((0, 2), np.int64),
        }


def _read_obj(file: Path) -> dict[str, Any]:
    points, faces, face_part, part_names = _parse_obj(file)
    beside = file.with_suffix(".markers.json")
    if not beside.is_file():
        raise MeshError(f"Beside '{file}' there is no '{beside.name}'; it must name the marker vertices.")
    table = json.loads(beside.read_text(encoding="utf-8"))
    part = np.zeros(len(points), np.int8)
    triangles = np.array(faces, np.int32).reshape(-1, 3)
    part[triangles] = np.array(face_part, np.int8)[:, None]
    return {
        "vertices_mm": np.array(points, float) * float(table.get("scale_to_mm", 1.0)),
        "faces": triangles,
        "part": part,
        "part_names": tuple(part_names),
        "markers": {str(k): int(v) for k, v in table["markers"].items()},
        "lip_pairs": np.array(table.get("lip_pairs", []), np.int64).reshape(-1, 2),
    }


def _parse_obj(file: Path) -> tuple[list[list[float]], list[list[int]], list[int], list[str]]:
    """Return points, triangles, part of each triangle and part names; polygons become fans."""
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
            corners = [_corner(w, len(points)) for w in words[1:]]
            for a, b in itertools.pairwise(corners[1:]):
                faces.append([corners[0], a, b])
                face_part.append(names.index(current))
    return points, faces, face_part, names or ["skin"]


def _corner(word: str, n_points: int) -> int:
    """Return the vertex index from 0 of "7/1/3" (from 1) or "-1" (from the end)."""
    number = int(word.split("/")[0])
    return number - 1 if number > 0 else n_points + number
