"""Where a head ends: the ragged rim that is left of a body, drawn down to a level edge for pictures."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from corpus_tools.core import FloatArray, IntArray, Mesh, frozen
from corpus_tools.mesh.lips import skin_faces

__all__ = ["level_neck", "neck_rim", "with_level_neck"]

_DOWN = 0.7
"""How far below its lowest point the rim is drawn, as a share of the height of the markers (our choice: a
picture that is framed a little below the chin then shows neck down to its edge)."""


@functools.lru_cache(maxsize=16)
def neck_rim(mesh: Mesh) -> IntArray:
    """Return the vertices of the lowest open edge of the skin; none when that is not below the face.

    Parameters
    ----------
    mesh : Mesh
        With markers.
    """
    nothing = np.zeros(0, np.int64)
    faces = mesh.faces[skin_faces(mesh)]
    if not len(faces) or not mesh.markers:
        return nothing
    # vertices at one place are one: seams of a texture are no open edges
    used, place = np.unique(faces, return_inverse=True)
    points, welded = np.unique(np.round(mesh.vertices_mm[used], 4), axis=0, return_inverse=True)
    corner = np.ravel(welded)[np.ravel(place)].reshape(-1, 3)
    sides = np.sort(np.concatenate([corner[:, [0, 1]], corner[:, [1, 2]], corner[:, [2, 0]]]), axis=1)
    edges, times = np.unique(sides, axis=0, return_counts=True)
    open_ = edges[times == 1]
    if not len(open_):
        return nothing
    n = len(points)
    graph = coo_array((np.ones(len(open_)), (open_[:, 0], open_[:, 1])), (n, n))
    label = connected_components(graph, directed=False)[1]
    on_edge = np.unique(open_)
    lowest = on_edge[np.argmin(points[on_edge, 1])]
    rim = on_edge[label[on_edge] == label[lowest]]
    marked_y = mesh.vertices_mm[list(mesh.markers.values()), 1]
    if points[rim, 1].max() > marked_y.min() + 0.25 * np.ptp(marked_y):
        return nothing
    return np.asarray(used[np.isin(np.ravel(welded), rim)], np.int64)


@functools.lru_cache(maxsize=16)
def level_neck(mesh: Mesh) -> Mesh:
    """Return the mesh with the rim of its neck drawn straight down to one level, for pictures.

    Bundled heads are cut from a body along its polygons, which leaves teeth at the neck. Only the vertices of
    the rim move; faces, markers and everything above it are those of `mesh`.

    Parameters
    ----------
    mesh : Mesh
    """
    rim = neck_rim(mesh)
    if not len(rim):
        return mesh
    points = mesh.vertices_mm.copy()
    marked_y = points[list(mesh.markers.values()), 1]
    points[rim, 1] = points[rim, 1].min() - _DOWN * float(np.ptp(marked_y))
    return replace(mesh, vertices_mm=frozen(points))


def with_level_neck(mesh: Mesh, vertices_mm: npt.ArrayLike) -> FloatArray:
    """Return a pose of a mesh, (n_vertices, 3) mm, with the rim of its neck where :func:`level_neck` has it.

    Parameters
    ----------
    mesh : Mesh
    vertices_mm : (n_vertices, 3), mm
    """
    rim = neck_rim(mesh)
    points = np.array(vertices_mm, float)
    points[rim] = level_neck(mesh).vertices_mm[rim]
    return points
