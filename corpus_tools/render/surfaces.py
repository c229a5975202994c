"""The parts of a mesh as they are drawn: coarse ones refined, normals smooth, colours painted on."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array, vstack

from corpus_tools.core import BoolArray, FloatArray, IntArray, Mesh, frozen
from corpus_tools.render.paint import LIMBUS, part_colours

if TYPE_CHECKING:
    import pyvista as pv

__all__ = ["DrawnPart", "drawn_part", "part_surface", "smooth_normals"]

REFINED = {"eyes": (1, 3), "upper_teeth": (0, 3), "lower_teeth": (0, 3)}
"""Halvings of every edge, and of those where the paint is fine: around the irises, in front of the teeth.

Our choice: round irises and single teeth need more vertices than shapes do; what nobody sees costs time."""
TEETH_BACK_MM = 30.0
"""Teeth further behind the front ones than this are not seen between the lips."""


@dataclass(frozen=True, slots=True, eq=False)
class DrawnPart:
    """One part of a mesh as a surface that follows the vertices of the mesh.

    Attributes
    ----------
    name : str
    weights : (n_points, n_vertices) sparse
        Points = weights @ vertices + offset.
    offset_mm : (n_points, 3), mm
        What makes a refined eyeball round.
    faces : (n_faces, 3)
    vertex : (n_points,)
        The vertex of the mesh that each point is, or is near to.
    colours : (n_points, 3) float32, or None
    gather : (n_points, n_faces) sparse
        Which faces meet in a point.
    """

    name: str
    weights: csr_array
    offset_mm: FloatArray
    faces: IntArray
    vertex: IntArray
    colours: npt.NDArray[np.float32] | None
    gather: csr_array

    def points_mm(self, vertices_mm: npt.ArrayLike) -> FloatArray:
        """Return the points of the surface, (n_points, 3) mm, of a pose of the mesh."""
        return np.asarray(self.weights @ np.asarray(vertices_mm, float) + self.offset_mm)

    def normals(self, points_mm: FloatArray) -> FloatArray:
        """Return the unit normals at points of this surface, (n_points, 3)."""
        return smooth_normals(points_mm, self.faces, self.gather)


def smooth_normals(points_mm: FloatArray, faces: IntArray, gather: csr_array) -> FloatArray:
    """Return the mean of the normals of the faces around each point, weighted by their areas, of length 1."""
    a, b, c = (points_mm[corner] for corner in faces.T)
    normals = gather @ np.cross(b - a, c - a)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.asarray(normals / np.maximum(length, 1e-12))


@functools.lru_cache(maxsize=32)
def drawn_part(mesh: Mesh, part: str) -> DrawnPart:
    """Return a part of a mesh as it is drawn."""
    faces = mesh.faces[mesh.part_mask(part)[mesh.faces].all(axis=1)].astype(np.int64)
    used = np.unique(faces)
    renumber = np.zeros(mesh.n_vertices, np.int64)
    renumber[used] = np.arange(len(used))
    faces = renumber[faces]
    weights = csr_array((np.ones(len(used)), (np.arange(len(used)), used)), (len(used), mesh.n_vertices))
    points, vertex = mesh.vertices_mm[used], used
    everywhere, most = REFINED.get(part, (0, 0))
    for level in range(most):
        kept = faces[:0]
        if level >= everywhere:  # gaps to the coarser faces around are below 0.02 mm
            near = (_near_iris if part == "eyes" else _in_front)(points, faces)
            kept, faces = faces[~near], faces[near]
        faces, ends = _halved(faces, len(points))
        faces = np.concatenate([kept, faces])
        weights = csr_array(vstack([weights, 0.5 * (weights[ends[:, 0]] + weights[ends[:, 1]])]))
        middles = 0.5 * (points[ends[:, 0]] + points[ends[:, 1]])
        vertex = np.concatenate([vertex, vertex[ends[:, 0]]])
        points = np.vstack([points, _rounded(middles, points, ends) if part == "eyes" else middles])
    corner = np.tile(np.arange(len(faces)), 3)
    gather = csr_array((np.ones(3 * len(faces)), (faces.T.ravel(), corner)), (len(points), len(faces)))
    return DrawnPart(
        name=part,
        weights=weights,
        offset_mm=frozen(points - weights @ mesh.vertices_mm),
        faces=faces,
        vertex=vertex,
        colours=part_colours(mesh, part, points, used),
        gather=gather,
    )


def _halved(faces: IntArray, n_points: int) -> tuple[IntArray, IntArray]:
    """Return four faces for each, and the two ends of every edge that got a new point in its middle."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    ends, place = np.unique(edges, axis=0, return_inverse=True)
    ab, bc, ca = (n_points + part for part in np.split(np.ravel(place), 3))
    a, b, c = faces.T
    corners = [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    return np.concatenate([np.column_stack(t) for t in corners]), ends


def _near_iris(points: FloatArray, faces: IntArray) -> BoolArray:
    """Return the faces of the eyeballs that lie around the point where an eye looks, (n_faces,)."""
    found = np.zeros(len(points), dtype=np.bool_)
    for of_side in (points[:, 0] > 0, points[:, 0] <= 0):
        if of_side.any():
            ball = points[of_side]
            centre, radius = 0.5 * (ball.min(axis=0) + ball.max(axis=0)), 0.5 * float(np.ptp(ball[:, 1]))
            away = np.hypot(*(ball - centre)[:, :2].T)
            found[of_side] = (ball[:, 2] > centre[2]) & (away < (LIMBUS + 0.05) * radius)
    return np.asarray(found[faces].any(axis=1))


def _in_front(points: FloatArray, faces: IntArray) -> BoolArray:
    """Return the faces of teeth that look forward or aside and are near the front, (n_faces,)."""
    corners = points[faces]
    middles = corners.mean(axis=1)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    out = middles - points.mean(axis=0)
    looks_out = normals[:, 0] * out[:, 0] + normals[:, 2] * out[:, 2]
    foremost = middles[:, 2] >= np.percentile(middles[:, 2], 90)
    looks_out *= np.sign(looks_out[foremost].sum())  # whichever way round the corners go
    return np.asarray((looks_out > 0) & (middles[:, 2] > points[:, 2].max() - TEETH_BACK_MM))


def _rounded(middles: FloatArray, points: FloatArray, ends: IntArray) -> FloatArray:
    """Move the middles of edges out to the sphere that the ends lie on, one sphere a side of the face."""
    moved = middles.copy()
    for side in (False, True):
        of_side = (points[:, 0] > 0) == side
        mine = of_side[ends[:, 0]]
        if not mine.any():
            continue
        centre = 0.5 * (points[of_side].min(axis=0) + points[of_side].max(axis=0))
        radius = np.linalg.norm(points[ends[mine]] - centre, axis=2).mean(axis=1)
        out = middles[mine] - centre
        moved[mine] = centre + out * (radius / np.maximum(np.linalg.norm(out, axis=1), 1e-9))[:, None]
    return moved


def part_surface(mesh: Mesh, part: str, vertices_mm: npt.ArrayLike | None = None) -> pv.PolyData:
    """Return one part of the mesh as PolyData with smooth normals.

    Its array `vertex` holds the vertex of the mesh that each point follows: skin and tongue are the mesh
    itself, eyes and teeth are finer. `colour` is there for parts that are painted.
    """
    import pyvista as pv  # half a second: only when something is drawn

    drawn = drawn_part(mesh, part)
    points = drawn.points_mm(mesh.vertices_mm if vertices_mm is None else vertices_mm)
    surface = pv.PolyData.from_regular_faces(points.astype(np.float32), drawn.faces)
    surface.point_data["Normals"] = drawn.normals(points).astype(np.float32)
    surface.point_data.active_normals_name = "Normals"
    surface.point_data["vertex"] = drawn.vertex
    if drawn.colours is not None:
        surface.point_data["colour"] = drawn.colours
    return surface
