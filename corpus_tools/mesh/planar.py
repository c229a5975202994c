"""Triangles in a plane: orientation, slivers, points in polygons, and flips towards Delaunay."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from corpus_tools.core import BoolArray, FloatArray, IntArray

__all__ = ["counter_clockwise", "flipped", "inside", "twice_area", "without_slivers"]

SLIVER_DEG = 5.0
TWO = np.arange(6).reshape(2, 3)


def flipped(points: FloatArray, triangles: IntArray, side: npt.NDArray[np.int8]) -> IntArray:
    """Flip edges until no inner one faces more than 180 degrees: Delaunay where the chart really lies.

    The rim and the mouth stay what they are, and no new edge joins the two lips.
    """
    out = triangles.copy()
    for _ in range(len(out)):
        sides = out[:, [1, 2, 2, 0, 0, 1]].reshape(-1, 2)
        owner = {(int(a), int(b)): k for k, (a, b) in enumerate(sides)}
        twin = [(k, owner[b, a]) for (a, b), k in owner.items() if a < b and (b, a) in owner]
        done = set()
        for k, other in twin:
            if k // 3 in done or other // 3 in done:
                continue
            (a, b), c, d = sides[k], out[k // 3, k % 3], out[other // 3, other % 3]
            pair = np.array([[c, a, d], [d, b, c]])
            if side[c] * side[d] >= 0 and _worth_flipping(points[[a, b, c, d]], points[pair]):
                out[k // 3], out[other // 3] = pair
                done |= {k // 3, other // 3}
        if not done:
            break
    return out


def _worth_flipping(quad: FloatArray, flipped: FloatArray) -> bool:
    """Say whether edge a b faces more than 180 degrees from c and d, and both new triangles are sound."""
    a, b, c, d = quad
    facing = 0.0
    for tip in (c, d):
        u, v = a - tip, b - tip
        facing += float(np.arctan2(abs(u[0] * v[1] - u[1] * v[0]), u @ v))
    return facing > np.pi + 1e-6 and bool((twice_area(flipped.reshape(-1, 2), TWO) > 1e-9).all())


def twice_area(points: FloatArray, triangles: IntArray) -> FloatArray:
    """Return twice the signed area of every triangle; positive counter-clockwise."""
    a, b, c = points[triangles].transpose(1, 0, 2)
    return np.asarray((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])


def counter_clockwise(points: FloatArray, triangles: IntArray) -> IntArray:
    """Return the triangles, turned where they run clockwise."""
    turned = twice_area(points, triangles) < 0
    out = triangles.copy()
    out[turned] = triangles[turned][:, [0, 2, 1]]
    return out


def inside(points: FloatArray, polygon: FloatArray) -> BoolArray:
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


def without_slivers(points: FloatArray, triangles: IntArray) -> IntArray:
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
