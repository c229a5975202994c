"""The open-mouth chart: markers laid flat, the mouth a hole, triangles that never join the two lips."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.spatial import Delaunay, QhullError

from corpus_tools.core import BoolArray, FloatArray, IntArray, Mesh, MeshError, frozen
from corpus_tools.mesh.lips import LOWER_LIP, UPPER_LIP, lower_side

__all__ = ["Chart", "marker_sides", "open_mouth_chart"]

INNER_RING = tuple(f"lip_in{i}" for i in range(8))
OUTER_RING = tuple(f"lip_out{i}" for i in range(12))
OPENING = 0.45
"""How far the chart opens the mouth, as a share of its width; our choice."""
SLIVER_DEG = 5.0


@dataclass(frozen=True, slots=True, eq=False)
class Chart:
    """Markers in a plane, where neighbours on the skin are neighbours and the mouth is open.

    Attributes
    ----------
    points_mm : (n_markers, 2) float64
        Arc length about the head and height, mouth open.
    triangles : (n_triangles, 3) int64
        Markers, counter-clockwise seen from outside.
    side : (n_markers,) int8
        1 on the upper lip, -1 on the lower, 0 elsewhere (corners of the mouth too).
    """

    points_mm: FloatArray
    triangles: IntArray
    side: npt.NDArray[np.int8]

    def __post_init__(self) -> None:
        object.__setattr__(self, "points_mm", frozen(self.points_mm))
        object.__setattr__(self, "triangles", frozen(self.triangles, np.int64))
        object.__setattr__(self, "side", frozen(self.side, np.int8))

    @property
    def triangle_side(self) -> npt.NDArray[np.int8]:
        """1 for triangles with a corner on the upper lip, -1 on the lower, 0 for all others."""
        corners = self.side[self.triangles]
        return np.asarray(corners.max(axis=1) + corners.min(axis=1), np.int8)


def marker_sides(names: Sequence[str]) -> npt.NDArray[np.int8]:
    """Return 1 for markers of the upper lip, -1 for those of the lower, 0 for all others."""
    return np.array([(n in UPPER_LIP) - (n in LOWER_LIP) for n in names], np.int8)


def open_mouth_chart(mesh: Mesh, names: Sequence[str]) -> Chart:
    """Lay the markers of a mesh flat and triangulate them (paper A section 6, figure 4 b; our choice how).

    The closed mouth is opened by lowering everything that is nearer to the lower lip along the skin, as
    inner lips coincide in a closed one; then a cylinder about the head is unrolled. Of the Delaunay
    triangles those in the mouth, those across it, and slivers on the rim are left out.

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
    side = marker_sides(names)
    points = _unrolled(_opened(mesh, at, names))
    try:
        triangles = np.asarray(Delaunay(points).simplices, np.int64)
    except (QhullError, ValueError) as error:
        raise MeshError(
            f"The {len(names)} markers of the mesh '{mesh.name}' span no surface; spread them over the face."
        ) from error
    triangles = _counter_clockwise(points, triangles)
    both = (side[triangles] > 0).any(axis=1) & (side[triangles] < 0).any(axis=1)
    triangles = triangles[~(both | _in_the_mouth(points, triangles, names))]
    return Chart(points, _without_slivers(points, triangles), side)


def _opened(mesh: Mesh, at: IntArray, names: Sequence[str]) -> FloatArray:
    """Return the markers with the mouth opened by :data:`OPENING` of its width, its corners half-way."""
    points: FloatArray = mesh.vertices_mm[at].copy()
    lips = [i for i, n in enumerate(names) if n in (*INNER_RING, *OUTER_RING)]
    if len(lips) > 1:
        lowered = lower_side(mesh)[at]
        lowered[lips] = 0.5 - 0.5 * marker_sides(names)[lips]
        points[:, 1] -= OPENING * float(np.ptp(points[lips, 0])) * lowered
    return points


def _unrolled(points: FloatArray) -> FloatArray:
    """Return arc length about a vertical axis behind the face, and height."""
    width, depth = np.ptp(points[:, 0]), np.ptp(points[:, 2])
    x = 0.5 * (points[:, 0].min() + points[:, 0].max())
    z = points[:, 2].min() - max(0.25 * float(width) - 0.5 * float(depth), 0.1 * float(width), 1e-6)
    radius = float(np.median(np.hypot(points[:, 0] - x, points[:, 2] - z)))
    angle = np.arctan2(points[:, 0] - x, points[:, 2] - z)
    return np.stack([radius * angle, points[:, 1]], axis=1)


def _counter_clockwise(points: FloatArray, triangles: IntArray) -> IntArray:
    a, b, c = points[triangles].transpose(1, 0, 2)
    turned = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0] < 0
    out = triangles.copy()
    out[turned] = triangles[turned][:, [0, 2, 1]]
    return out


def _in_the_mouth(points: FloatArray, triangles: IntArray, names: Sequence[str]) -> BoolArray:
    """Return the triangles of lip markers whose centre lies within the inner ring (else the outer one)."""
    place = {n: i for i, n in enumerate(names)}
    ring = next((r for r in (INNER_RING, OUTER_RING) if all(n in place for n in r)), ())
    if not ring:
        return np.zeros(len(triangles), bool)
    lips = np.array([n in (*INNER_RING, *OUTER_RING) for n in names])
    centres = points[triangles].mean(axis=1)
    return _inside(centres, points[[place[n] for n in ring]]) & lips[triangles].all(axis=1)


def _inside(points: FloatArray, polygon: FloatArray) -> BoolArray:
    """Return which points lie in a polygon, by the number of edges to their right."""
    start, end = polygon, np.roll(polygon, -1, axis=0)
    x, y = points[:, :1], points[:, 1:]
    spans = (start[:, 1] > y) != (end[:, 1] > y)
    rise = np.where(end[:, 1] == start[:, 1], 1.0, end[:, 1] - start[:, 1])
    crossing = start[:, 0] + (y - start[:, 1]) / rise * (end[:, 0] - start[:, 0])
    return np.asarray((spans & (x < crossing)).sum(axis=1) % 2 == 1)


def _smallest_deg(points: FloatArray, triangles: IntArray) -> FloatArray:
    """Return the smallest angle of every triangle, degrees."""
    corners = points[triangles]
    angles = []
    for k in range(3):
        u, v = corners[:, (k + 1) % 3] - corners[:, k], corners[:, (k + 2) % 3] - corners[:, k]
        cross = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
        angles.append(np.degrees(np.arctan2(cross, (u * v).sum(axis=1))))
    return np.asarray(np.min(angles, axis=0))


def _without_slivers(points: FloatArray, triangles: IntArray) -> IntArray:
    """Drop slivers on the rim, one by one, the thinnest first; never the last triangle of a marker."""
    kept = triangles
    while len(kept):
        edges = np.sort(kept[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        _, back, count = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
        on_rim = (count[back.reshape(-1)].reshape(-1, 3) == 1).any(axis=1)
        alone = (np.bincount(kept.ravel(), minlength=len(points))[kept] == 1).any(axis=1)
        thin = np.where(on_rim & ~alone, _smallest_deg(points, kept), np.inf)
        if thin.min() >= SLIVER_DEG:
            return kept
        kept = np.delete(kept, int(thin.argmin()), axis=0)
    return kept
