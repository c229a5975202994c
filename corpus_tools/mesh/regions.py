"""What a vertex of the skin is: face, lips or the inside of the mouth; found along the surface."""

from __future__ import annotations

import enum

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components, dijkstra

from corpus_tools.core import IntArray, Mesh
from corpus_tools.mesh.lips import skin_faces
from corpus_tools.mesh.topology import edges_of

__all__ = ["SkinRegion", "skin_regions"]


class SkinRegion(enum.IntEnum):
    """Region of a skin vertex; other parts count as FACE."""

    FACE = 0
    LIPS = 1
    MOUTH = 2


def skin_regions(mesh: Mesh) -> npt.NDArray[np.int8]:
    """Return a :class:`SkinRegion` for every vertex, shape (n_vertices,).

    Two closed loops of shortest paths, through the inner-lip and the outer-lip markers, cut the skin into the
    inside of the mouth, the red of the lips and the rest; our choice, for colours and checks. All FACE where
    the mesh lacks lip markers or where the loops do not cut.
    """
    regions = np.zeros(mesh.n_vertices, np.int8)
    loops = (_inner_stops(mesh), _outer_stops(mesh))
    if min(len(stops) for stops in loops) < 6:
        return regions
    graph = _edges(mesh)
    rim, border = (_loop(graph, stops) for stops in loops)
    within_border = _cut_off(graph, border)
    within_rim = _cut_off(graph, rim)
    regions[within_border] = SkinRegion.LIPS
    regions[within_rim] = SkinRegion.MOUTH
    regions[np.concatenate([rim, border])] = SkinRegion.LIPS
    return regions


def _inner_stops(mesh: Mesh) -> list[int]:
    """Return rim vertices in order around the mouth: upper from left to right, lower back."""
    corners = [mesh.markers[n] for n in ("lip_in0", "lip_in4") if n in mesh.markers]
    if len(corners) < 2 or not len(mesh.lip_pairs):
        return []
    order = np.argsort(mesh.vertices_mm[mesh.lip_pairs[:, 0], 0])
    upper, lower = mesh.lip_pairs[order, 0].tolist(), mesh.lip_pairs[order[::-1], 1].tolist()
    first, second = sorted(corners, key=lambda i: float(mesh.vertices_mm[i, 0]))
    return [first, *upper, second, *lower]


def _outer_stops(mesh: Mesh) -> list[int]:
    return [mesh.markers[f"lip_out{i}"] for i in range(12) if f"lip_out{i}" in mesh.markers]


def _edges(mesh: Mesh) -> csr_array:
    edges = edges_of(mesh.faces[skin_faces(mesh)])
    v = mesh.vertices_mm
    length = np.linalg.norm(v[edges[:, 0]] - v[edges[:, 1]], axis=1)
    n = mesh.n_vertices
    return coo_array((np.maximum(length, 1e-9), (edges[:, 0], edges[:, 1])), shape=(n, n)).tocsr()


def _loop(graph: csr_array, stops: list[int]) -> IntArray:
    """Return the vertices on the shortest paths between consecutive stops, closed."""
    _, before = dijkstra(graph, directed=False, indices=stops, return_predecessors=True)
    found: list[int] = []
    for k, end in enumerate([*stops[1:], stops[0]]):
        here = end
        while here >= 0:
            found.append(here)
            here = int(before[k, here])
    return np.unique(found)


def _cut_off(graph: csr_array, loop: IntArray) -> npt.NDArray[np.bool_]:
    """Return the vertices that a loop cuts off from the largest part of the skin; other parts never."""
    everything = connected_components(graph, directed=False)[1]
    skin = everything == np.bincount(everything).argmax()
    keep = skin.copy()
    keep[loop] = False
    labels = connected_components(graph[keep][:, keep], directed=False)[1]
    off = np.zeros(len(skin), bool)
    off[keep] = labels != np.bincount(labels).argmax()
    return off
