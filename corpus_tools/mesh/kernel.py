"""Frames of vertices on Bezier triangles (paper A equation 3): de Casteljau, compiled, frames side by side.

All is computed as a change from rest, so that float32 loses less than a micrometre and rest is rest. numba
compiles the loops for float32 (playback, export) and float64 (tests). The machine code is kept beside the
module or in the user's cache; where neither can be written it is made anew in every process.
:func:`warm_up` has that done in the background.
"""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from corpus_tools.core import FloatArray, IntArray
from corpus_tools.mesh.attachment import Attachment, frames_at

__all__ = ["Plan", "patch_frames", "plan_for", "warm_up"]

BLOCK = 16
"""Frames that are computed side by side: two vectors of eight float32."""
CHUNK = 192
"""Frames whose control points are held at a time."""
COLUMNS = 19
"""Of a rider: u0 u1 u2 weight, 3 a, 3 b, d, place at rest, T1 / 3, T2 / 3, d n (three each)."""


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """Net and attachment as the compiled loops want them, in one precision.

    Attributes
    ----------
    net : (n_control, n_markers)
        Shifts of the distinct control points by the markers; dense, as BLAS is quicker than a sparse product.
    corners : (n_riders, 10) int32
        Control points of the patch of every vertex that rides on one.
    rider : (n_riders, COLUMNS)
    rider_rows : (n_riders,) int64
        Rows of the result.
    blend : (n_blended, n_markers)
        Of vertices that only shift.
    blend_rest : (n_blended, 3)
    blend_rows : (n_blended,) int64
    """

    net: npt.NDArray[np.floating]
    corners: npt.NDArray[np.int32]
    rider: npt.NDArray[np.floating]
    rider_rows: IntArray
    blend: npt.NDArray[np.floating]
    blend_rest: npt.NDArray[np.floating]
    blend_rows: IntArray


def plan_for(
    control_rest_mm: FloatArray,
    net: csr_array,
    attachment: Attachment,
    rest_mm: FloatArray,
    n_smooth: int,
    dtype: npt.DTypeLike,
) -> Plan:
    """Return the plan for a control surface and what hangs on it.

    Parameters
    ----------
    control_rest_mm : (n_patches, 10, 3), mm
    net : csr (10 n_patches, n_markers)
    attachment : Attachment
    rest_mm : (n, 3), mm
        Of the attached vertices.
    n_smooth : int
        Patches from this one on only shift.
    dtype : float32 or float64
    """
    a = attachment
    riders, blended = np.flatnonzero(a.patch < n_smooth), np.flatnonzero(a.patch >= n_smooth)
    used, patch = np.unique(a.patch[riders], return_inverse=True)
    shifts = csr_array(net[(10 * used[:, None] + np.arange(10)).ravel()])
    # rows that are the same sum the same two random numbers
    key = shifts @ np.random.default_rng(0).normal(size=(net.shape[1], 2))
    _, first, same = np.unique(np.round(key, 12), axis=0, return_index=True, return_inverse=True)
    return Plan(
        net=csr_array(shifts[first]).toarray().astype(dtype),
        corners=same.reshape(-1, 10)[patch].astype(np.int32),
        rider=_rider(control_rest_mm[a.patch[riders]], a, riders, rest_mm[riders]).astype(dtype),
        rider_rows=riders,
        blend=net[10 * a.patch[blended]].toarray().astype(dtype),
        blend_rest=rest_mm[blended].astype(dtype),
        blend_rows=blended,
    )


def _rider(control: FloatArray, a: Attachment, rows: IntArray, rest: FloatArray) -> FloatArray:
    _, t1, t2, normal = frames_at(control, a.bary[rows])
    d = a.offset[rows, 2:]
    columns = [a.bary[rows], a.weight[rows, None], 3.0 * a.offset[rows, :2], d, rest, t1 / 3.0, t2 / 3.0]
    return np.concatenate([*columns, d * normal], axis=1)


def patch_frames(plan: Plan, shift_mm: npt.NDArray[np.floating]) -> npt.NDArray[np.floating]:
    """Return the attached vertices in every frame, (n_frames, n, 3), mm, in the precision of the plan.

    Parameters
    ----------
    plan : Plan
    shift_mm : (n_frames, n_markers, 3), mm
        Markers from rest.
    """
    p = plan
    dtype = p.net.dtype
    out = np.empty((len(shift_mm), len(p.rider_rows) + len(p.blend_rows), 3), dtype)
    for first in range(0, len(out), CHUNK):
        part = out[first : first + CHUNK]
        shift = np.ascontiguousarray(shift_mm[first : first + CHUNK].transpose(1, 2, 0), dtype)
        columns = shift.reshape(len(shift), -1)
        net = (p.net @ columns).reshape(len(p.net), 3, -1)
        _compiled()(net, p.corners, p.rider, p.rider_rows, part, BLOCK)
        if len(p.blend_rows):
            moved = (p.blend @ columns).reshape(len(p.blend), 3, -1)
            part[:, p.blend_rows] = p.blend_rest + moved.transpose(2, 0, 1)
    return out


@functools.cache
def _compiled() -> Callable[..., None]:
    """Return the loops; compiled for a precision when they first run in it, or loaded from the cache."""
    import numba

    options = {"fastmath": True, "nogil": True, "error_model": "numpy"}
    try:
        return numba.njit(cache=True, **options)(_frames)  # type: ignore[no-any-return]
    except RuntimeError:  # no folder for the cache can be written
        return numba.njit(**options)(_frames)  # type: ignore[no-any-return]


def _frames(net: Any, corners: Any, rider: Any, rows: Any, out: Any, block: int) -> None:
    """Fill `out` (n_frames, n, 3) for control shifts (n_control, 3, n_frames), by blocks of frames."""
    near = np.empty((net.shape[0], 3 * block), net.dtype)
    p = np.empty((3, 3 * block), net.dtype)
    place = np.empty((3, block), net.dtype)
    for first in range(0, net.shape[2], block):
        n = min(block, net.shape[2] - first)
        for c in range(net.shape[0]):
            for axis in range(3):
                for f in range(n):
                    near[c, axis * n + f] = net[c, axis, first + f]
        for v in range(corners.shape[0]):
            k0, k1, k2, k3, k4 = corners[v, 0], corners[v, 1], corners[v, 2], corners[v, 3], corners[v, 4]
            k5, k6, k7, k8, k9 = corners[v, 5], corners[v, 6], corners[v, 7], corners[v, 8], corners[v, 9]
            u0, u1, u2, w, a, b, d, r0, r1, r2 = rider[v, :10]
            x0, y0, z0, x1, y1, z1, h0, h1, h2 = rider[v, 10:]
            for f in range(3 * n):
                b210, b201, b120 = near[k3, f], near[k4, f], near[k5, f]
                b021, b102, b012 = near[k6, f], near[k7, f], near[k8, f]
                b111 = near[k9, f]
                q200 = u0 * near[k0, f] + u1 * b210 + u2 * b201
                q020 = u0 * b120 + u1 * near[k1, f] + u2 * b021
                q002 = u0 * b102 + u1 * b012 + u2 * near[k2, f]
                q110 = u0 * b210 + u1 * b120 + u2 * b111
                q101 = u0 * b201 + u1 * b111 + u2 * b102
                q011 = u0 * b111 + u1 * b021 + u2 * b012
                last = u0 * q101 + u1 * q011 + u2 * q002
                p[0, f] = u0 * q200 + u1 * q110 + u2 * q101 - last
                p[1, f] = u0 * q110 + u1 * q020 + u2 * q011 - last
                p[2, f] = last
            c0, c1 = u0 + a, u1 + b
            for f in range(n):
                ax, ay, az = x0 + p[0, f], y0 + p[0, n + f], z0 + p[0, 2 * n + f]
                bx, by, bz = x1 + p[1, f], y1 + p[1, n + f], z1 + p[1, 2 * n + f]
                nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
                h = d / np.sqrt(nx * nx + ny * ny + nz * nz)
                place[0, f] = r0 + w * (p[2, f] + c0 * p[0, f] + c1 * p[1, f] + (h * nx - h0))
                place[1, f] = r1 + w * (p[2, n + f] + c0 * p[0, n + f] + c1 * p[1, n + f] + (h * ny - h1))
                place[2, f] = r2 + w * (
                    p[2, 2 * n + f] + c0 * p[0, 2 * n + f] + c1 * p[1, 2 * n + f] + (h * nz - h2)
                )
            row = rows[v]
            for f in range(n):
                out[first + f, row, 0] = place[0, f]
                out[first + f, row, 1] = place[1, f]
                out[first + f, row, 2] = place[2, f]


_started = threading.Event()


def warm_up() -> None:
    """Have the loops compiled for float32, or loaded, in a thread of its own; once in a process."""
    if not _started.is_set():
        _started.set()
        threading.Thread(target=_run_once, name="compile-patch-kernel").start()


def _run_once() -> None:
    one, corners = np.ones((1, COLUMNS), np.float32), np.zeros((1, 10), np.int32)
    net, out = np.zeros((1, 3, 1), np.float32), np.zeros((1, 1, 3), np.float32)
    _compiled()(net, corners, one, np.zeros(1, np.int64), out, BLOCK)
