"""Bezier patches as plain data for the browser: the control net, and where vertices hang on it."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array, diags_array

__all__ = ["ORDER", "attached_rows", "net_data", "patch_points", "shared_patches"]

ORDER = ("300", "210", "201", "120", "111", "102", "030", "021", "012", "003")
"""Control points in the order of the shader: exponents of the barycentric coordinates."""
_PARALLEL = 1e-5
"""Area of two tangents, mm^2, below which they have no normal."""


def net_data(net: Any, control_mm: npt.ArrayLike, exponents: npt.ArrayLike) -> dict[str, Any]:
    """Return the control net of all patches: its points at rest, and how markers move each.

    The first point of a patch stands where it is, the other nine are told from the first.

    Parameters
    ----------
    net : csr (10 n_patches, n_markers)
        Control points = net @ markers, ten rows a patch.
    control_mm : (n_patches, 10, 3), mm
        At rest.
    exponents : (10, 3)
        Exponents of the barycentric coordinates of the ten rows.
    """
    names = ["".join(str(int(e)) for e in row) for row in np.asarray(exponents)]
    order = np.array([names.index(name) for name in ORDER])
    control = np.array(np.asarray(control_mm, float)[:, order])
    n = len(control)
    rows = net[(10 * np.arange(n)[:, None] + order).ravel()]
    # float32 cannot hold a tangent of a millimetre a metre away from the origin
    others = (np.arange(10 * n) % 10 > 0).astype(float)
    local = (rows - diags_array(others) @ rows[10 * np.repeat(np.arange(n), 10)]).tocsr()
    control[:, 1:] -= control[:, :1]
    return {
        "k": int(local.shape[1]),
        "rest": control.astype(np.float32).tobytes(),
        "start": np.asarray(local.indptr, np.uint32).tobytes(),
        "index": np.asarray(local.indices, np.uint32).tobytes(),
        "weight": np.asarray(local.data, np.float32).tobytes(),
    }


def attached_rows(
    n: int,
    rows: npt.ArrayLike,
    patch: npt.ArrayLike,
    bary: npt.ArrayLike,
    offset: npt.ArrayLike,
    weight: npt.ArrayLike,
) -> npt.NDArray[np.float32]:
    """Return the attachment of n vertices, (n, 8): patch, l0, l1, weight, along u, v and the normal, 0.

    Parameters
    ----------
    n : int
        Vertices of the actor; those that `rows` leaves out rest.
    rows : (m,)
        Which of them hang on patches.
    patch : (m,)
    bary : (m, 3)
    offset : (m, 3)
        Along dB/dl0 - dB/dl2, dB/dl1 - dB/dl2, and the unit normal (mm).
    weight : (m,)
        Share of the motion, 0 to 1.
    """
    out = np.zeros((n, 8), np.float32)
    rows = np.asarray(rows)
    out[rows, 0] = patch
    out[rows, 1:3] = np.asarray(bary)[:, :2]
    out[rows, 3] = weight
    out[rows, 4:7] = offset
    return out


def shared_patches(of: str, attached: npt.NDArray[np.float32]) -> dict[str, Any]:
    """Return the patches of an actor that hangs on those of another."""
    return {"of": of, "attached": attached.tobytes()}


def patch_points(
    rest_mm: npt.NDArray[np.float64], net: dict[str, Any], attached: bytes, shift_mm: npt.ArrayLike
) -> npt.NDArray[np.float64]:
    """Return where the vertices of an actor are, (n, 3) mm: what the browser's shader computes, in numpy.

    Parameters
    ----------
    rest_mm : (n, 3), mm
    net : dict
        As of :func:`net_data`.
    attached : bytes
        Of the rows of :func:`attached_rows`.
    shift_mm : (k, 3), mm
        Of the markers from rest.
    """
    start, index = (np.frombuffer(net[key], np.uint32).astype(np.int64) for key in ("start", "index"))
    weight = np.frombuffer(net["weight"], np.float32).astype(float)
    rows = csr_array((weight, index, start), shape=(len(start) - 1, net["k"]))
    control = np.frombuffer(net["rest"], np.float32).reshape(-1, 3) + rows @ np.asarray(shift_mm, float)
    at = np.frombuffer(attached, np.float32).reshape(-1, 8).astype(float)
    b = control.reshape(-1, 10, 3)[at[:, 0].astype(int)]
    origin = b[:, 0].copy()
    b[:, 0] = 0.0
    x, y, z = _casteljau(b, at[:, 1:2], at[:, 2:3])
    u, v = 3.0 * (x - z), 3.0 * (y - z)
    n = np.cross(u, v)
    length = np.linalg.norm(n, axis=1, keepdims=True)
    n = np.divide(n, length, out=np.zeros_like(n), where=length > _PARALLEL)
    moved = z + at[:, 1:2] * (x - z) + at[:, 2:3] * (y - z) + at[:, 4:5] * u + at[:, 5:6] * v + at[:, 6:7] * n
    return np.asarray(rest_mm + at[:, 3:4] * (origin + moved - rest_mm))


def _casteljau(
    b: npt.NDArray[np.float64], l0: npt.NDArray[np.float64], l1: npt.NDArray[np.float64]
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return the three points whose blend is the point of the patch, (n, 3) each."""
    l2 = 1.0 - l0 - l1

    def blend(i: int, j: int, k: int, of: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        return np.asarray(l0 * of[:, i] + l1 * of[:, j] + l2 * of[:, k])

    corners = [(0, 1, 2), (1, 3, 4), (2, 4, 5), (3, 6, 7), (4, 7, 8), (5, 8, 9)]
    second = np.stack([blend(*c, b) for c in corners], axis=1)  # 200 110 101 020 011 002
    return blend(0, 1, 2, second), blend(1, 3, 4, second), blend(2, 4, 5, second)
