"""What is wrong with a mesh before it is bound, said as a modelling program would say it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from corpus_tools.core import BoolArray, FloatArray, IntArray, Mesh, MeshError, counted
from corpus_tools.mesh.lips import skin_faces

__all__ = ["MeshFault", "boundary_loops", "check_mesh", "closing_faces", "inner_lip_ring", "refuse_fatal"]

SAME_PLACE = 1e-6
"""Vertices nearer than this share of the mesh's extent are at the same place (our choice)."""
SMALL_HOLE = 0.25
"""A boundary loop of the skin narrower than this share of the extent, off the lips, is told as a hole."""


@dataclass(frozen=True, slots=True)
class MeshFault:
    """One kind of fault: whether it forbids binding, how often it occurs, and a sentence."""

    kind: str
    fatal: bool
    count: int
    sentence: str
    vertices: tuple[int, ...]


def check_mesh(mesh: Mesh) -> tuple[MeshFault, ...]:
    """Return the faults of a mesh, those that forbid binding first.

    Fatal are a mouth that faces close between the lips, and lip pairs off the skin; edges of more than two
    faces, flipped faces, vertices at the same place, loose vertices, faces without area and holes are told,
    since the deformers bear them (our choice).
    """
    steps = (
        *(_closed_lips, _not_manifold, _flipped, _doubles),
        *(_loose, _without_area, _holes),
    )
    found = [fault for step in steps if (fault := step(mesh)) is not None]
    return tuple(sorted(found, key=lambda fault: not fault.fatal))


def refuse_fatal(mesh: Mesh) -> None:
    """Raise the first fatal fault of a mesh.

    Raises
    ------
    MeshError
        With the sentence of that fault.
    """
    fatal = _closed_lips(mesh)
    if fatal is not None:
        raise MeshError(fatal.sentence)


def inner_lip_ring(mesh: Mesh) -> tuple[IntArray, IntArray, IntArray]:
    """Return the vertices of the inner lips: upper, lower, and the corners."""
    found = []
    for column, numbers in ((0, (1, 2, 3)), (1, (5, 6, 7)), (None, (0, 4))):
        own = {mesh.markers[n] for n in (f"lip_in{i}" for i in numbers) if n in mesh.markers}
        pairs = set() if column is None else set(mesh.lip_pairs[:, column].tolist())
        found.append(np.array(sorted(own | pairs), np.int64))
    return found[0], found[1], found[2]


def closing_faces(mesh: Mesh) -> BoolArray:
    """Return which faces close the mouth, (n_faces,): all corners on the inner lips, both lips among them."""
    upper, lower, corners = inner_lip_ring(mesh)
    on_upper, on_lower = np.isin(mesh.faces, upper), np.isin(mesh.faces, lower)
    ring = on_upper | on_lower | np.isin(mesh.faces, corners)
    return np.asarray(ring.all(axis=1) & on_upper.any(axis=1) & on_lower.any(axis=1))


def boundary_loops(faces: npt.NDArray[np.integer], n_vertices: int) -> list[IntArray]:
    """Return the vertices of each connected boundary (edges of one face), the longest first."""
    edges, counts = _edge_counts(faces)
    rim = edges[counts == 1]
    if not len(rim):
        return []
    graph = coo_array((np.ones(len(rim)), (rim[:, 0], rim[:, 1])), shape=(n_vertices, n_vertices))
    labels = connected_components(graph, directed=False)[1]
    on_rim = np.unique(rim)
    loops = [on_rim[labels[on_rim] == label] for label in np.unique(labels[on_rim])]
    return sorted(loops, key=len, reverse=True)


def _edge_counts(faces: npt.NDArray[np.integer]) -> tuple[IntArray, IntArray]:
    pairs = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2).astype(np.int64)
    edges, counts = np.unique(np.sort(pairs, axis=1), axis=0, return_counts=True)
    return edges, counts


def _place(mesh: Mesh, vertices: Iterable[int]) -> str:
    first = next(iter(vertices))
    x, y, z = mesh.vertices_mm[first]
    return f"the first at vertex {first} ({x:.1f}, {y:.1f}, {z:.1f} mm)"


def _fault(
    mesh: Mesh, kind: str, vertices: npt.NDArray[np.integer], text: str, n: int, fatal: bool = False
) -> MeshFault | None:
    if not n:
        return None
    few = tuple(int(i) for i in np.ravel(vertices)[:10])
    sentence = f"The mesh '{mesh.name}' has {text.format(place=_place(mesh, few))}."
    return MeshFault(kind, fatal, int(n), sentence, few)


def _closed_lips(mesh: Mesh) -> MeshFault | None:
    closing = np.flatnonzero(closing_faces(mesh))
    text = (
        counted(len(closing), "face") + " that close the mouth between the lips, {place}; delete them there"
    )
    text += ""
    return _fault(mesh, "lips closed", mesh.faces[closing], text, len(closing), fatal=True)


def _not_manifold(mesh: Mesh) -> MeshFault | None:
    edges, counts = _edge_counts(mesh.faces)
    wrong = edges[counts > 2]
    text = counted(len(wrong), "edge") + " of more than two faces, {place}; delete the inner faces there"
    return _fault(mesh, "non-manifold edges", wrong, text, len(wrong))


def _flipped(mesh: Mesh) -> MeshFault | None:
    pairs = np.stack([mesh.faces, np.roll(mesh.faces, -1, axis=1)], axis=2).reshape(-1, 2).astype(np.int64)
    edges, counts = _edge_counts(mesh.faces)
    n = mesh.n_vertices
    two = edges[counts == 2]
    key, several = np.unique(pairs[:, 0] * n + pairs[:, 1], return_counts=True)
    twice = key[several == 2]
    ends = np.sort(np.stack([twice // n, twice % n], axis=1), axis=1)
    wrong = ends[np.isin(ends[:, 0] * n + ends[:, 1], two[:, 0] * n + two[:, 1])]
    text = counted(len(wrong), "edge") + " between faces that look to opposite sides, {place}; "
    return _fault(mesh, "flipped faces", wrong, text + "recalculate the normals outside", len(wrong))


def _doubles(mesh: Mesh) -> MeshFault | None:
    step = max(float(np.ptp(mesh.vertices_mm, axis=0).max()) * SAME_PLACE, 1e-12)
    _, first, counts = np.unique(
        np.round(mesh.vertices_mm / step).astype(np.int64), axis=0, return_index=True, return_counts=True
    )
    n = int((counts - 1).sum())
    text = counted(n, "vertex", "vertices") + " at the place of another, {place}; merge them by distance, "
    return _fault(mesh, "doubles", first[counts > 1], text + "but not those of the two lips", n)


def _loose(mesh: Mesh) -> MeshFault | None:
    loose = np.setdiff1d(np.arange(mesh.n_vertices), mesh.faces)
    text = counted(len(loose), "vertex", "vertices") + " without a face, {place}; delete loose vertices"
    return _fault(mesh, "loose vertices", loose, text, len(loose))


def _areas(mesh: Mesh) -> FloatArray:
    a, b, c = (mesh.vertices_mm[mesh.faces[:, k]] for k in range(3))
    return np.asarray(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1))


def _without_area(mesh: Mesh) -> MeshFault | None:
    flat = np.flatnonzero(_areas(mesh) < 1e-9)
    text = counted(len(flat), "face") + " without area, {place}; dissolve degenerate faces"
    return _fault(mesh, "faces without area", mesh.faces[flat], text, len(flat))


def _holes(mesh: Mesh) -> MeshFault | None:
    faces = mesh.faces[skin_faces(mesh)]
    loops = boundary_loops(faces, mesh.n_vertices)
    extent = float(np.ptp(mesh.vertices_mm, axis=0).max())
    ring = np.concatenate(inner_lip_ring(mesh))
    holes = [
        loop
        for loop in loops[1:]
        if float(np.ptp(mesh.vertices_mm[loop], axis=0).max()) < SMALL_HOLE * extent
        and not np.isin(ring, loop).any()
    ]
    text = counted(len(holes), "hole") + ", {place}; fill it unless it is meant (eyes, mouth, neck)"
    return _fault(mesh, "holes", np.array([loop[0] for loop in holes], np.int64), text, len(holes))
