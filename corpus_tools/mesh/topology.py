"""Connectivity of a mesh: edges, edge loops, normals and distances along the surface."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from corpus_tools.core import FloatArray, IntArray

__all__ = ["edge_loop", "edges_of", "geodesic_mm", "triangles", "vertex_normals"]


def triangles(quads: npt.ArrayLike) -> npt.NDArray[np.int32]:
    """Split quads (n, 4) into triangles (2 n, 3) along the diagonal 0-2; triangles pass unchanged."""
    q = np.array(quads, np.int32)
    if q.shape[1] == 3:
        return q
    return np.concatenate([q[:, [0, 1, 2]], q[:, [0, 2, 3]]], axis=1).reshape(-1, 3)


def edges_of(faces: npt.ArrayLike) -> IntArray:
    """Return the undirected edges of polygons (n, k), each once: (n_edges, 2), lower index first."""
    f = np.asarray(faces, np.int64)
    pairs = np.stack([f, np.roll(f, -1, axis=1)], axis=2).reshape(-1, 2)
    return _distinct(np.sort(pairs, axis=1))


def _distinct(edges: npt.NDArray[np.integer]) -> IntArray:
    """Return each row of (n, 2) once, in order; one number a row sorts many times quicker than two."""
    n = int(edges.max()) + 1 if edges.size else 1
    key = np.unique(edges[:, 0].astype(np.int64) * n + edges[:, 1])
    return np.stack([key // n, key % n], axis=1)


def vertex_normals(vertices_mm: npt.ArrayLike, faces: npt.ArrayLike) -> FloatArray:
    """Return unit normals (n_vertices, 3), averaged over faces by area; zero where no face is."""
    v = np.asarray(vertices_mm, float)
    f = triangles(faces)
    face_normals = np.cross(v[f[:, 1]] - v[f[:, 0]], v[f[:, 2]] - v[f[:, 0]])
    total = np.zeros_like(v)
    for corner in range(3):
        np.add.at(total, f[:, corner], face_normals)
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return np.asarray(np.divide(total, length, out=np.zeros_like(total), where=length > 0))


def geodesic_mm(
    vertices_mm: npt.ArrayLike, faces: npt.ArrayLike, sources: Sequence[int] | IntArray
) -> FloatArray:
    """Return the length of the shortest path along edges from the nearest source, shape (n_vertices,), mm.

    Diagonals of neighbouring triangles are edges too, which keeps the paths within a few per cent of the
    true geodesics (enough for labels and falls-off); `inf` where no path leads.
    """
    v = np.asarray(vertices_mm, float)
    graph = _edge_graph(v, np.asarray(faces))
    distances = dijkstra(graph, directed=False, indices=np.asarray(sources, np.int64), min_only=True)
    return np.asarray(distances, float)


def _edge_graph(v: FloatArray, faces: npt.NDArray[np.int32]) -> csr_array:
    """Return edge lengths as a sparse graph; the flipped diagonal of each pair of triangles is added."""
    f = triangles(faces)
    pairs = np.stack([f, np.roll(f, -1, axis=1)], axis=2).reshape(-1, 2)
    across = np.roll(f, -2, axis=1).reshape(-1)
    order = np.lexsort(np.sort(pairs, axis=1).T)
    key = np.sort(pairs, axis=1)[order]
    same = np.flatnonzero((key[1:] == key[:-1]).all(axis=1))
    flipped = np.stack([across[order[same]], across[order[same + 1]]], axis=1)
    edges = _distinct(np.sort(np.concatenate([key, flipped]), axis=1))
    length = np.linalg.norm(v[edges[:, 0]] - v[edges[:, 1]], axis=1)
    return coo_array((length, (edges[:, 0], edges[:, 1])), shape=(len(v), len(v))).tocsr()


def edge_loop(quads: npt.ArrayLike, first: int, second: int) -> list[int]:
    """Follow the edge loop first -> second through vertices of valence 4 until it closes or ends.

    At each vertex the loop leaves by the edge that shares no face with the one it came by.

    Parameters
    ----------
    quads : (n, 4) int
    first, second : int
        Two vertices joined by an edge.

    Returns
    -------
    list of int
        The vertices in order; `first` is not repeated when the loop closes.
    """
    q = np.asarray(quads, np.int64)
    edges = edges_of(q)
    path = [first, second]
    while True:
        before, here = path[-2], path[-1]
        around = q[(q == here).any(axis=1)]
        beside = set(around[(around == before).any(axis=1)].ravel().tolist())
        touching = edges[(edges == here).any(axis=1)]
        neighbours = set(touching.ravel().tolist()) - {here}
        onward = neighbours - beside
        if len(neighbours) != 4 or len(onward) != 1:
            return path
        nxt = onward.pop()
        if nxt == first:
            return path
        path.append(nxt)
