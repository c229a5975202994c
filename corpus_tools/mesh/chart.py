"""The open-mouth chart: markers laid flat, the mouth a hole, triangles that never join the two lips."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.interpolate import RBFInterpolator
from scipy.spatial import Delaunay, QhullError

from corpus_tools.core import BoolArray, FloatArray, IntArray, Mesh, MeshError, frozen
from corpus_tools.mesh.lips import LOWER_LIP, UPPER_LIP, lower_side, skin_faces
from corpus_tools.mesh.planar import counter_clockwise, flipped, inside, twice_area, without_slivers
from corpus_tools.mesh.topology import geodesic_mm

__all__ = ["CONTROL_POINTS", "Chart", "chart_places", "marker_sides", "open_mouth_chart"]

CONTROL_POINTS = np.array(
    [
        [3, 0, 0],
        [0, 3, 0],
        [0, 0, 3],
        [2, 1, 0],
        [2, 0, 1],
        [1, 2, 0],
        [0, 2, 1],
        [1, 0, 2],
        [0, 1, 2],
        [1, 1, 1],
    ]
)
"""Exponents of the ten control points in the order of every net; the third corner is the centroid."""

INNER_RING = tuple(f"lip_in{i}" for i in range(8))
OUTER_RING = tuple(f"lip_out{i}" for i in range(12))
CORNERS = ("lip_in0", "lip_in4", "lip_out0", "lip_out6")
OPENINGS = (0.1, 0.2, 0.3, 0.45)
"""How far the mouth is opened, as shares of its width: the last to find triangles, the first that folds none
of them for the chart, which thus stays near the true distances; our choice."""
N_STILL = 20
STILL_MM = 55.0
"""Distance along the skin at which points stand still around the markers; our choice."""
RING = (0.5, 1.15)


@dataclass(frozen=True, slots=True, eq=False)
class Chart:
    """Markers in a plane, where neighbours on the skin are neighbours and the mouth is open.

    Attributes
    ----------
    vertices : (n_points,) int64
        Vertex of every point: those of the markers first, then points around the face that stand still.
    points_mm : (n_points, 2) float64
        Arc length about the head and height, mouth open.
    triangles : (n_triangles, 3) int64
        Points, counter-clockwise seen from outside.
    side : (n_points,) int8
        1 on the upper lip, -1 on the lower, 0 elsewhere (corners of the mouth too).
    corner : (n_points,) bool
        Corners of the mouth.
    """

    vertices: IntArray
    points_mm: FloatArray
    triangles: IntArray
    side: npt.NDArray[np.int8]
    corner: BoolArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", frozen(self.vertices, np.int64))
        object.__setattr__(self, "points_mm", frozen(self.points_mm))
        object.__setattr__(self, "triangles", frozen(self.triangles, np.int64))
        object.__setattr__(self, "side", frozen(self.side, np.int8))
        object.__setattr__(self, "corner", frozen(self.corner, np.bool_))

    @property
    def triangle_side(self) -> npt.NDArray[np.int8]:
        """1 for triangles with a corner on the upper lip, -1 on the lower, 0 for all others."""
        corners = self.side[self.triangles]
        return np.asarray(corners.max(axis=1) + corners.min(axis=1), np.int8)

    def patch_points(self) -> FloatArray:
        """Return where in the chart the control points of the patches lie, (3 n_triangles, 10, 2), mm."""
        corners = self.points_mm[self.triangles]
        centre = corners.mean(axis=1)
        patches = np.stack([corners, np.roll(corners, -1, axis=1), np.stack([centre] * 3, axis=1)], axis=2)
        return np.asarray(CONTROL_POINTS / 3.0 @ patches.reshape(-1, 3, 2))


def chart_places(chart: Chart, vertices_mm: FloatArray, points_mm: FloatArray, side: int = 0) -> FloatArray:
    """Return about where in the chart points of the skin lie, (n, 2), mm: a smooth map through its points.

    Parameters
    ----------
    chart : Chart
    vertices_mm : (n_vertices, 3), mm
        The mesh at rest.
    points_mm : (n, 3), mm
    side : int
        1 for points of the upper lip's side, -1 for the lower's, whose map leaves out the other lip.
    """
    use = chart.side * side >= 0
    known = vertices_mm[chart.vertices[use]]
    scale = float(np.ptp(known, axis=0).max())
    warp = RBFInterpolator(known / scale, chart.points_mm[use], kernel="linear", degree=1)
    return np.asarray(warp(points_mm / scale))


def marker_sides(names: Sequence[str]) -> npt.NDArray[np.int8]:
    """Return 1 for markers of the upper lip, -1 for those of the lower, 0 for all others."""
    return np.array([(n in UPPER_LIP) - (n in LOWER_LIP) for n in names], np.int8)


def open_mouth_chart(mesh: Mesh, names: Sequence[str]) -> Chart:
    """Lay the markers of a mesh flat and triangulate them (paper A section 6, figure 4 b; our choice how).

    The closed mouth is opened by lowering everything that is nearer to the lower lip along the skin, as
    inner lips coincide in a closed one; then a cylinder about the head is unrolled. Of the Delaunay
    triangles those in the mouth, those across it, and slivers on the rim are left out. The places of the
    points come from a less open mouth (:data:`OPENINGS`).

    Parameters
    ----------
    mesh : Mesh
    names : sequence of str
        Markers, all on the mesh.

    Raises
    ------
    MeshError
        The markers lie on a line or are too few.
    """
    at = np.array([mesh.markers[n] for n in names], np.int64)
    lowered = lower_side(mesh)[at]
    lips = np.array([n in (*INNER_RING, *OUTER_RING) for n in names])
    lowered[lips] = 0.5 - 0.5 * marker_sides(names)[lips]
    width = float(np.ptp(mesh.vertices_mm[at[lips], 0])) if lips.any() else 0.0
    charts = [_laid(mesh, at, names, opening * width * lowered) for opening in OPENINGS]
    vertices, points = charts[-1]
    side, corner = np.zeros(len(vertices), np.int8), np.zeros(len(vertices), bool)
    side[: len(names)], corner[: len(names)] = marker_sides(names), [n in CORNERS for n in names]
    try:
        triangles = np.asarray(Delaunay(points).simplices, np.int64)
    except (QhullError, ValueError) as error:
        raise MeshError(
            f"The {len(names)} markers of the mesh '{mesh.name}' span no surface; spread them over the face."
        ) from error
    triangles = counter_clockwise(points, triangles)
    both = (side[triangles] > 0).any(axis=1) & (side[triangles] < 0).any(axis=1)
    triangles = triangles[~(both | _in_the_mouth(points, triangles, names))]
    triangles = without_slivers(points, triangles)
    points = next(p for _, p in charts if (twice_area(p, triangles) > 0).all() or p is points)
    return Chart(vertices, points, flipped(points, triangles, side), side, corner)


def _laid(
    mesh: Mesh, at: IntArray, names: Sequence[str], lowered_mm: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Return vertices and places of all points of the chart with the markers lowered by so much."""
    opened = mesh.vertices_mm[at] - lowered_mm[:, None] * [0.0, 1.0, 0.0]
    points = _with_inner_corners(_unrolled(opened), mesh.vertices_mm[at], names)
    still, around = _still_points(mesh, at, points)
    return np.concatenate([at, still]), np.concatenate([points, around])


def _unrolled(points: FloatArray) -> FloatArray:
    """Return arc length about a vertical axis behind the face, and height."""
    width, depth = float(np.ptp(points[:, 0])), float(np.ptp(points[:, 2]))
    x = 0.5 * float(points[:, 0].min() + points[:, 0].max())
    z = float(points[:, 2].min()) - max(0.25 * width - 0.5 * depth, 0.1 * width, 1e-6)
    radius = float(np.median(np.hypot(points[:, 0] - x, points[:, 2] - z)))
    angle = np.arctan2(points[:, 0] - x, points[:, 2] - z)
    return np.stack([radius * angle, points[:, 1]], axis=1)


def _with_inner_corners(points: FloatArray, rest: FloatArray, names: Sequence[str]) -> FloatArray:
    """Put the inner corner of each side of the mouth beside the outer one, towards the middle.

    The two nearly coincide, and the inner one lies deeper: unrolled, it could come to lie outside.
    """
    place = {n: i for i, n in enumerate(names)}
    out = points.copy()
    for inner, outer, other in (("lip_in0", "lip_out0", "lip_out6"), ("lip_in4", "lip_out6", "lip_out0")):
        if all(n in place for n in (inner, outer, other)):
            i, o = place[inner], place[outer]
            inward = points[place[other]] - points[o]
            apart = float(np.linalg.norm(rest[i] - rest[o]))
            out[i] = points[o] + inward * min(apart / max(float(np.linalg.norm(inward)), 1e-9), 0.2)
    return out


def _still_points(mesh: Mesh, at: IntArray, points: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return vertices on a ring around the markers where nothing moves, and their places in the chart."""
    far = STILL_MM
    distance = geodesic_mm(mesh.vertices_mm, mesh.faces[skin_faces(mesh)], at)
    rim = np.flatnonzero((distance > RING[0] * far) & (distance < RING[1] * far))
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    towards = mesh.vertices_mm[rim, :2] - 0.5 * (
        mesh.vertices_mm[at, :2].min(axis=0) + mesh.vertices_mm[at, :2].max(axis=0)
    )
    bearing = np.arctan2(towards[:, 1], towards[:, 0])
    vertices, places = [], []
    for angle in np.linspace(-np.pi, np.pi, N_STILL, endpoint=False):
        direction = np.array([np.cos(angle), np.sin(angle)])
        off = np.abs((bearing - angle + np.pi) % (2 * np.pi) - np.pi)
        near = np.flatnonzero(off < np.pi / N_STILL)
        if len(near):
            pick = near[np.abs(distance[rim[near]] - far).argmin()]
            vertices.append(int(rim[pick]))
            places.append(centre + (((points - centre) @ direction).max() + distance[rim[pick]]) * direction)
    return np.array(vertices, np.int64), np.array(places).reshape(-1, 2)


def _in_the_mouth(points: FloatArray, triangles: IntArray, names: Sequence[str]) -> BoolArray:
    """Return the triangles of lip markers whose centre lies within the inner ring (else the outer one)."""
    place = {n: i for i, n in enumerate(names)}
    ring = next((r for r in (INNER_RING, OUTER_RING) if all(n in place for n in r)), ())
    if not ring:
        return np.zeros(len(triangles), bool)
    lips = np.zeros(len(points), bool)
    lips[: len(names)] = [n in (*INNER_RING, *OUTER_RING) for n in names]
    centres = points[triangles].mean(axis=1)
    return inside(centres, points[[place[n] for n in ring]]) & lips[triangles].all(axis=1)
