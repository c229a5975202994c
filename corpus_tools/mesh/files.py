"""Mesh files: .npz of our own layout; .obj, .ply, .glb with NAME.markers.json beside."""

from __future__ import annotations

import json
import os
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from corpus_tools.core import FloatArray, IntArray, Mesh, MeshError, atomic_file
from corpus_tools.mesh.bundle import CHARACTERS, bundled_head
from corpus_tools.mesh.formats import SURFACE_READERS
from corpus_tools.mesh.glb import read_glb

__all__ = [
    "UNITS_MM",
    "mesh_by_name_or_file",
    "read_mesh",
    "read_picks",
    "read_surface",
    "unit_of_extent",
    "write_mesh",
]

ARRAYS = ("vertices_mm", "faces", "part", "part_names", "marker_names", "marker_vertices", "lip_pairs")
UNITS_MM = {"mm": 1.0, "cm": 10.0, "dm": 100.0, "m": 1000.0}
LEAST_HEAD_MM, MOST_HEAD_MM = 80.0, 800.0
"""Greatest extent of a face or head (our choice): one decade, so that every size has one unit."""
_Read = TypeVar("_Read")
SURFACE_READERS.add(".glb", read_glb)
KINDS = (".npz", *SURFACE_READERS)
KINDS_TOLD = ".npz, .obj, .ply or .glb"


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
    if path.suffix.lower() in KINDS or path.exists():
        return read_mesh(path)
    raise MeshError(
        f"There is no mesh '{text}'; give one of {', '.join(CHARACTERS)}, or the path of a file {KINDS_TOLD}."
    )


def read_mesh(path: str | os.PathLike[str]) -> Mesh:
    """Read a mesh, mm, y up, z out of the face, mouth closed.

    ``.npz``: arrays vertices_mm (n, 3), faces (m, 3), part (n,), part_names, marker_names, marker_vertices,
    lip_pairs (k, 2), as :func:`write_mesh` writes them. ``.obj``, ``.ply``, ``.glb``: vertices and
    polygons, groups or objects as parts; beside it NAME.markers.json: {"markers": {name: vertex from 0, or
    [x, y, z] in units of the file}, "lip_pairs": [[upper, lower], ...], "scale_to_mm": 1.0}; without a scale
    the unit is told by the size.

    Raises
    ------
    MeshError
        The file is missing, cut, of another kind, or names vertices it does not have.
    """
    file = _mesh_file(path)
    reader = _read_npz if file.suffix.lower() == ".npz" else _read_surface_file
    mesh = Mesh(name=file.stem, **_guarded(reader, file))
    _check(mesh, file)
    return mesh


def read_surface(path: str | os.PathLike[str]) -> tuple[Mesh, float]:
    """Read a mesh file without markers, as it is: the mesh in mm, and how many mm its unit is.

    An ``.npz`` keeps its markers; the markers beside other files are not looked at.

    Raises
    ------
    MeshError
        The file is missing, cut, of another kind, or of no size of a head.
    """
    file = _mesh_file(path)
    if file.suffix.lower() == ".npz":
        return read_mesh(file), 1.0
    fields, unit = _guarded(lambda f: _surface_fields(f, None), file)
    mesh = Mesh(name=file.stem, **fields)
    _check(mesh, file)
    return mesh, unit


def _mesh_file(path: str | os.PathLike[str]) -> Path:
    """Return the path of a mesh file that is there and of a kind that can be read."""
    file = Path(path)
    if file.is_dir():
        raise MeshError(f"'{file}' is a folder, and a mesh file was expected; name a mesh in it.")
    if not file.is_file():
        raise MeshError(f"There is no mesh file '{file}'; check the path.")
    if file.suffix.lower() not in KINDS:
        raise MeshError(
            f"The mesh file '{file}' ends in '{file.suffix}'; {KINDS_TOLD} was expected: export it as one."
        )
    return file


def _guarded(reader: Callable[[Path], _Read], file: Path) -> _Read:
    """Read a file; whatever is wrong with its bytes costs one sentence."""
    try:
        return reader(file)
    except (
        OSError,
        ValueError,
        KeyError,
        IndexError,
        TypeError,
        AttributeError,
        struct.error,
        zipfile.BadZipFile,
    ) as error:
        raise MeshError(f"The mesh file '{file}' cannot be read ({error}); export it again.") from error


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


def read_picks(
    path: str | os.PathLike[str], vertices_mm: FloatArray, unit_mm: float
) -> tuple[dict[str, int], IntArray]:
    """Return markers and lip pairs of a file of picks, as beside a mesh: {"markers": ..., "lip_pairs": ...}.

    Places [x, y, z] are in the unit of the mesh file; they stand for the nearest vertex.

    Raises
    ------
    MeshError
        The file is missing or no such table.
    """
    file = Path(path)

    def read(given: Path) -> tuple[dict[str, int], IntArray]:
        table = json.loads(given.read_text(encoding="utf-8"))
        pairs = np.array(table.get("lip_pairs", []), np.int64).reshape(-1, 2)
        picks = table.get("markers", {}).items()
        return {str(k): _picked(v, vertices_mm, unit_mm) for k, v in picks}, pairs

    return _guarded(read, file)


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


def _read_surface_file(file: Path) -> dict[str, Any]:
    """Return the fields of a mesh of a surface file with the markers beside it."""
    beside = file.with_suffix(".markers.json")
    if not beside.is_file():
        raise MeshError(
            f"Beside '{file}' there is no '{beside.name}'; it must name the marker "
            "vertices; 'corpus-tools mesh propose' writes a first one."
        )
    table = json.loads(beside.read_text(encoding="utf-8"))
    given = table.get("scale_to_mm")
    fields, unit = _surface_fields(file, None if given is None else float(given))
    markers, pairs = read_picks(beside, fields["vertices_mm"], unit)
    return fields | {"markers": markers, "lip_pairs": pairs}


def _surface_fields(file: Path, scale: float | None) -> tuple[dict[str, Any], float]:
    """Return the fields of a mesh without markers, and how many mm the unit of the file is."""
    raw = SURFACE_READERS[file.suffix.lower()](file)
    if not len(raw.points) or not len(raw.faces):
        raise MeshError(f"The mesh file '{file}' has no faces; export it again, with its polygons.")
    scale = unit_of_extent(raw.points, file) if scale is None else scale
    part = np.zeros(len(raw.points), np.int8)
    part[raw.faces] = raw.face_part.astype(np.int8)[:, None]
    fields = {
        "vertices_mm": raw.points * scale,
        "faces": raw.faces.astype(np.int32),
        "part": part,
        "part_names": raw.part_names,
    }
    return fields, scale


def unit_of_extent(points: FloatArray, file: Path) -> float:
    """Return how many mm the unit of a mesh is, told by its greatest extent: mm, cm, dm or m.

    Raises
    ------
    MeshError
        In none of them it is a head of 80 to 800 mm.
    """
    extent = float(np.ptp(points, axis=0).max())
    for scale in UNITS_MM.values():
        if LEAST_HEAD_MM <= extent * scale < MOST_HEAD_MM:
            return scale
    raise MeshError(
        f"The mesh '{file}' is {extent:.3g} units large, a head in {', '.join(UNITS_MM)} was expected; "
        f"scale it, or give scale_to_mm in '{file.with_suffix('.markers.json').name}'."
    )


def _picked(pick: Any, vertices_mm: FloatArray, unit_mm: float) -> int:
    """Return the vertex of a pick: its number, or the one nearest to a place in units of the file."""
    if isinstance(pick, list):
        place = np.array(pick, float).reshape(3) * unit_mm
        return int(np.argmin(np.sum((vertices_mm - place) ** 2, axis=1)))
    return int(pick)
