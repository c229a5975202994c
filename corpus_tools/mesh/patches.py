"""Bezier triangles over a chart: Clough-Tocher patches whose control points are linear in the markers.

Each triangle of markers is split at its centroid into three cubic Bezier triangles (Hsieh, Clough, Tocher).
Value and gradient at every marker are fixed linear functions of the markers, so that the surface is once
continuously differentiable across every edge however the markers move. Degree, smoothness and who owns the
control points are our choice: paper A section 6 says "with continuity conditions at patch boundaries".
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from corpus_tools.core import BoolArray, FloatArray, IntArray
from corpus_tools.mesh.chart import CONTROL_POINTS, Chart

__all__ = ["bernstein", "gradients", "linear_net", "smooth_net", "tangent_rows"]

ENOUGH_FOR_CURVATURE = 8
BLUR = 0.5
"""Share of the usual distance to a neighbour below which a neighbour counts no more than one at it."""
FACTORIAL = np.array([1.0, 1.0, 2.0, 6.0])


def bernstein(bary: npt.ArrayLike) -> FloatArray:
    """Return the ten cubic Bernstein polynomials, (n, 10), at barycentric coordinates (n, 3)."""
    u = np.asarray(bary, float)
    powers = (u[:, None, :] ** CONTROL_POINTS).prod(axis=2)
    return np.asarray(powers * 6.0 / FACTORIAL[CONTROL_POINTS].prod(axis=1))


def tangent_rows(bary: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return the rows (n, 10) of the two tangents: from the third corner towards the first, and the second.

    ``T1 = dB/du0 - dB/du2`` and ``T2 = dB/du1 - dB/du2`` in barycentric coordinates (u0, u1, u2).
    """
    u = np.asarray(bary, float)
    partial = []
    for axis in range(3):
        lowered = CONTROL_POINTS - np.eye(3, dtype=int)[axis]
        used = lowered[:, axis] >= 0
        lowered = np.maximum(lowered, 0)
        rows = (u[:, None, :] ** lowered).prod(axis=2) * 6.0 / FACTORIAL[lowered].prod(axis=1)
        partial.append(np.where(used, rows, 0.0))
    return partial[0] - partial[2], partial[1] - partial[2]


def gradients(chart: Chart) -> FloatArray:
    """Return d/ds and d/dt at every marker as linear functions of the markers, (2, n_markers, n_markers).

    Weighted least squares through the marker itself over its neighbours in the triangulation (and theirs,
    where a marker has few); with curvature where there are at least eight. A marker of one lip never looks at
    the other, and a corner of the mouth at neither, so that the lips move entirely independently.
    """
    n = len(chart.points_mm)
    near = np.zeros((n, n), bool)
    for k in range(3):
        near[chart.triangles[:, k], chart.triangles[:, k - 1]] = True
    near |= near.T
    lip = chart.side != 0
    across = (np.outer(chart.side, chart.side) < 0) | np.outer(chart.corner, lip)
    near &= ~across
    nearer = near.astype(int)
    further = ((nearer @ nearer + nearer) > 0) & ~across & ~np.eye(n, dtype=bool)
    out = np.zeros((2, n, n))
    for i in np.unique(chart.triangles):
        others = _neighbours(near[i], further[i])
        rows = _fitted(chart.points_mm[others] - chart.points_mm[i])
        out[:, i, others] = rows
        out[:, i, i] = -rows.sum(axis=1)
    return out


def _neighbours(near: BoolArray, further: BoolArray) -> IntArray:
    ring = np.flatnonzero(near)
    return ring if len(ring) >= ENOUGH_FOR_CURVATURE else np.flatnonzero(near | further)


def _fitted(offsets: FloatArray) -> FloatArray:
    """Return the gradient (2, n) of the weighted fit through the origin of values at `offsets` (n, 2)."""
    x, y = offsets.T
    terms = offsets
    if len(offsets) >= ENOUGH_FOR_CURVATURE:
        terms = np.stack([x, y, x * x, x * y, y * y], axis=1)
    scale = np.abs(terms).max(axis=0) + 1e-300
    distance = np.linalg.norm(offsets, axis=1)
    weight = 1.0 / (distance**2 + (BLUR * np.median(distance)) ** 2)
    inverse = np.linalg.pinv(terms / scale * weight[:, None], rcond=1e-6) * weight
    return np.asarray(inverse[:2] / scale[:2, None])


def smooth_net(chart: Chart) -> csr_array:
    """Return the control points as linear functions of the markers, csr (30 n_triangles, n_markers).

    Three patches for each triangle (corner 0, corner 1, centroid), (1, 2, centroid), (2, 0, centroid), ten
    rows for each in the order of :data:`CONTROL_POINTS`. Rows sum to one.
    """
    slope = gradients(chart)
    unit = np.eye(len(chart.points_mm))
    blocks = [_macro(chart.points_mm[t], unit[t], slope[:, t]) for t in chart.triangles]
    return _sparse(np.concatenate(blocks), len(unit))


def linear_net(chart: Chart) -> csr_array:
    """Return the flat triangles in the same form: their plane, raised to degree three."""
    unit = np.eye(len(chart.points_mm))
    blocks = []
    for t in chart.triangles:
        centroid = unit[t].mean(axis=0)
        for k in range(3):
            corners = np.stack([unit[t[k]], unit[t[(k + 1) % 3]], centroid])
            blocks.append(CONTROL_POINTS / 3.0 @ corners)
    return _sparse(np.concatenate(blocks), len(unit))


def _sparse(rows: FloatArray, n: int) -> csr_array:
    rows[np.abs(rows) < 1e-14] = 0.0
    return csr_array(rows.reshape(-1, n))


def _macro(corner: FloatArray, value: FloatArray, slope: FloatArray) -> FloatArray:
    """Return the rows (30, n_markers) of the three patches of one triangle.

    Parameters
    ----------
    corner : (3, 2)
        Places in the chart.
    value : (3, n_markers)
    slope : (2, 3, n_markers)
    """
    centre = corner.mean(axis=0)

    def towards(i: int, place: FloatArray) -> FloatArray:
        step = place - corner[i]
        return np.asarray(value[i] + (step[0] * slope[0, i] + step[1] * slope[1, i]) / 3.0)

    along = {(i, j): towards(i, corner[j]) for i in range(3) for j in range(3) if i != j}
    inward = [towards(i, centre) for i in range(3)]
    middle = [_middle(corner, centre, value, along, inward, k) for k in range(3)]
    spoke = [(inward[i] + middle[i] + middle[(i + 2) % 3]) / 3.0 for i in range(3)]
    hub = sum(spoke) / 3.0
    rows = []
    for i in range(3):
        j = (i + 1) % 3
        rows += [value[i], value[j], hub, along[i, j], inward[i], along[j, i], inward[j]]
        rows += [spoke[i], spoke[j], middle[i]]
    return np.stack(rows)


def _middle(
    corner: FloatArray,
    centre: FloatArray,
    value: FloatArray,
    along: dict[tuple[int, int], FloatArray],
    inward: list[FloatArray],
    i: int,
) -> FloatArray:
    """Return the inner control point at the edge i, i + 1: the derivative across the edge is linear on it."""
    j = (i + 1) % 3
    edge = corner[j] - corner[i]
    share = float((centre - corner[i]) @ edge / (edge @ edge))
    first = inward[i] - (1.0 - share) * value[i] - share * along[i, j]
    last = inward[j] - (1.0 - share) * along[j, i] - share * value[j]
    result: FloatArray = 0.5 * (first + last) + (1.0 - share) * along[i, j] + share * along[j, i]
    return result
