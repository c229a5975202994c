"""Vertices tied to patches: nearest point of an allowed patch, and what is left as offset in its frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from corpus_tools.core import BoolArray, FloatArray, IntArray, frozen
from corpus_tools.mesh.patches import bernstein, tangent_rows

__all__ = ["Attachment", "attach", "frames_at", "nearest_on_patches"]

SPACING = 0.02
MOST_SAMPLES = 24
CANDIDATES = 5
NEIGHBOURS = 40
ROUNDS = 10


@dataclass(frozen=True, slots=True, eq=False)
class Attachment:
    """Where the driven vertices hang on the patches (paper A equation 3, with offsets along the tangents).

    A vertex is at ``rest + weight (B + a T1 + b T2 + d n - rest)``: B the point of its patch, T1 and T2 the
    tangents of :func:`corpus_tools.mesh.patches.tangent_rows` (of the length they have), n the unit normal
    ``T1 x T2 / |T1 x T2|``. With `weight` 1 and a = b = 0 this is the paper's equation.

    Attributes
    ----------
    vertices : (n,) int64
        Vertices of the mesh, ascending.
    patch : (n,) int64
    bary : (n, 3) float64
        Barycentric coordinates in the patch; the third belongs to the centroid of its triangle.
    offset : (n, 3) float64
        a and b, in units of T1 and T2, and d in mm.
    weight : (n,) float64
        Share of the motion, 0 to 1.
    """

    vertices: IntArray
    patch: IntArray
    bary: FloatArray
    offset: FloatArray
    weight: FloatArray

    def __post_init__(self) -> None:
        for name in ("vertices", "patch"):
            object.__setattr__(self, name, frozen(getattr(self, name), np.int64))
        for name in ("bary", "offset", "weight"):
            object.__setattr__(self, name, frozen(getattr(self, name)))


def frames_at(control: FloatArray, bary: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return point, T1, T2 and unit normal (each (n, 3)) of patches with control points (n, 10, 3)."""
    first, second = tangent_rows(bary)
    point = np.einsum("nk,nkc->nc", bernstein(bary), control)
    t1 = np.einsum("nk,nkc->nc", first, control)
    t2 = np.einsum("nk,nkc->nc", second, control)
    normal = np.cross(t1, t2)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return point, t1, t2, normal / np.maximum(length, 1e-300)


def attach(points_mm: FloatArray, control_mm: FloatArray, patch: IntArray, bary: FloatArray) -> FloatArray:
    """Return the offsets (n, 3) that put the points at rest exactly where they are.

    Parameters
    ----------
    points_mm : (n, 3), mm
    control_mm : (n_patches, 10, 3), mm
        At rest.
    patch, bary : (n,), (n, 3)
    """
    point, t1, t2, normal = frames_at(control_mm[patch], bary)
    frame = np.stack([t1, t2, normal], axis=2)
    return np.asarray(np.linalg.solve(frame, (points_mm - point)[:, :, None])[:, :, 0])


def nearest_on_patches(
    points_mm: FloatArray,
    control_mm: FloatArray,
    allowed: BoolArray,
    *,
    normals: FloatArray | None = None,
    angle_deg: float = 180.0,
) -> tuple[IntArray, FloatArray]:
    """Return patch and barycentric coordinates of the nearest point of the allowed patches.

    Samples of the patches give candidates, a Gauss-Newton search kept inside each patch the place on it.

    Parameters
    ----------
    points_mm : (n, 3 or more), mm
        Coordinates beyond the third, of points and control points alike, pull towards a place in the chart.
    control_mm : (n_patches, 10, 3 or more), mm
    allowed : (n_patches,) bool
    normals : (n, 3), optional
        With them, patches whose normal is turned by more than `angle_deg` against the point's are taken only
        where there is no other (the rule of paper A section 6).
    angle_deg : float, degrees
    """
    where, samples = _samples(control_mm, np.flatnonzero(allowed), points_mm)
    patches, starts = _candidates(points_mm, control_mm, where, samples)
    best = np.full(len(points_mm), np.inf)
    patch, bary = np.zeros(len(points_mm), np.int64), np.zeros((len(points_mm), 3))
    for k in range(patches.shape[1]):
        rows = np.flatnonzero(patches[:, k] >= 0)
        control = control_mm[patches[rows, k]]
        found, cost = _closest(points_mm[rows], control, starts[rows, k])
        if normals is not None:
            cosine = (frames_at(control[:, :, :3], found)[3] * normals[rows]).sum(axis=1)
            cost = cost + 1e6 * (cosine < np.cos(np.radians(angle_deg)))
        better = cost < best[rows]
        rows = rows[better]
        best[rows], patch[rows], bary[rows] = cost[better], patches[rows, k], found[better]
    return patch, bary


def _grid(n: int) -> FloatArray:
    """Return barycentric coordinates of a regular grid with n steps an edge."""
    return np.array([(i, j, n - i - j) for i in range(n + 1) for j in range(n + 1 - i)]) / n


def _samples(control: FloatArray, patches: IntArray, points: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return patch and barycentric coordinates of samples, denser on longer patches."""
    corners = control[patches, :3]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    spacing = SPACING * max(float(np.ptp(control[:, :, :2].reshape(-1, 2), axis=0).max()), 1e-9)
    steps = np.clip(np.ceil(longest / spacing), 3, MOST_SAMPLES).astype(int)
    where, samples = [], []
    for n in np.unique(steps):
        grid, same = _grid(int(n)), patches[steps == n]
        where.append(np.repeat(same, len(grid)))
        samples.append(np.tile(grid, (len(same), 1)))
    return np.concatenate(where), np.concatenate(samples)


def _candidates(
    points: FloatArray, control: FloatArray, where: IntArray, samples: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Return the patches of the nearest samples (n, k; -1: none) and the places to start from (n, k, 3)."""
    places = np.einsum("nk,nkc->nc", bernstein(samples), control[where])
    found = cKDTree(places).query(points, min(NEIGHBOURS, len(places)))[1].reshape(len(points), -1)
    patches = np.full((len(points), CANDIDATES), -1, np.int64)
    starts = np.zeros((len(points), CANDIDATES, 3))
    count = np.zeros(len(points), np.int64)
    for column in found.T:
        fresh = (count < CANDIDATES) & ~(patches == where[column][:, None]).any(axis=1)
        rows = np.flatnonzero(fresh)
        patches[rows, count[rows]] = where[column[rows]]
        starts[rows, count[rows]] = samples[column[rows]]
        count[rows] += 1
    return patches, starts


def _closest(points: FloatArray, control: FloatArray, bary: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the nearest place on each patch and its distance; the best place ever seen is kept."""
    best, here = bary, bary
    least = np.full(len(points), np.inf)
    for _ in range(ROUNDS):
        first, second = tangent_rows(here)
        t1, t2 = (np.einsum("nk,nkc->nc", rows, control) for rows in (first, second))
        left = points - np.einsum("nk,nkc->nc", bernstein(here), control)
        distance = np.linalg.norm(left, axis=1)
        better = distance < least
        least = np.where(better, distance, least)
        best = np.where(better[:, None], here, best)
        here = _step_inside(here, left, t1, t2)
    return best, least


def _step_inside(bary: FloatArray, left: FloatArray, t1: FloatArray, t2: FloatArray) -> FloatArray:
    """Return where the linearised patch is nearest: the solution inside, else the best of the three edges."""
    gram = np.stack([(t1 * t1).sum(1), (t1 * t2).sum(1), (t2 * t2).sum(1)])
    pull = np.stack([(left * t1).sum(1), (left * t2).sum(1)])
    det = np.maximum(gram[0] * gram[2] - gram[1] ** 2, 1e-300)
    inside = np.stack([gram[2] * pull[0] - gram[1] * pull[1], gram[0] * pull[1] - gram[1] * pull[0]]) / det
    inside = inside + bary[:, :2].T
    options = np.stack([_on_edge(bary, gram, pull, edge) for edge in range(3)])
    moves = options - bary[:, :2].T
    quadratic = (
        gram[0] * moves[:, 0] ** 2 + 2 * gram[1] * moves[:, 0] * moves[:, 1] + gram[2] * moves[:, 1] ** 2
    )
    cost = 0.5 * quadratic - (pull[0] * moves[:, 0] + pull[1] * moves[:, 1])
    edge = options[cost.argmin(axis=0), :, np.arange(len(bary))].T
    feasible = (inside >= 0).all(axis=0) & (inside.sum(axis=0) <= 1)
    u = np.where(feasible, inside, edge)
    return np.stack([u[0], u[1], np.maximum(1.0 - u[0] - u[1], 0.0)], axis=1)


def _on_edge(bary: FloatArray, gram: FloatArray, pull: FloatArray, edge: int) -> FloatArray:
    """Return (2, n): the best place on the edge where coordinate `edge` is zero."""
    u0, u1 = bary[:, 0], bary[:, 1]
    if edge == 2:
        direction, start = np.array([1.0, -1.0]), np.stack([-u0, 1.0 - u1])
    elif edge == 0:
        direction, start = np.array([0.0, 1.0]), np.stack([-u0, -u1])
    else:
        direction, start = np.array([1.0, 0.0]), np.stack([-u0, -u1])
    steep = np.stack([gram[0] * start[0] + gram[1] * start[1], gram[1] * start[0] + gram[2] * start[1]])
    slope = direction @ (pull - steep)
    bend = (
        direction[0] ** 2 * gram[0] + 2 * direction[0] * direction[1] * gram[1] + direction[1] ** 2 * gram[2]
    )
    t = np.clip(slope / np.maximum(bend, 1e-300), 0.0, 1.0)
    return np.asarray(np.stack([u0, u1]) + start + direction[:, None] * t)
