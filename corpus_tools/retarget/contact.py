"""Lip contact in the marker domain: the inner lips meet, press flat and never pass through each other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from corpus_tools.core import FloatArray, IntArray, Mesh

__all__ = [
    "LIP_MARKER_PAIRS",
    "contact_aperture",
    "contact_solver",
    "keep_lips_apart",
    "lip_marker_pairs",
    "pair_response",
]

LIP_MARKER_PAIRS = (("lip_in1", "lip_in7"), ("lip_in2", "lip_in6"), ("lip_in3", "lip_in5"))


def lip_marker_pairs(mesh: Mesh, names: Sequence[str]) -> IntArray:
    """Return columns (n_pairs, 2) of facing upper and lower inner-lip markers.

    Taken from the mesh's lip pairs where both vertices are markers, else from the names of the 66 markers.
    """
    column = {mesh.markers[n]: i for i, n in enumerate(names) if n in mesh.markers}
    found = [[column[u], column[d]] for u, d in mesh.lip_pairs.tolist() if u in column and d in column]
    if not found:
        at = {n: i for i, n in enumerate(names)}
        found = [[at[u], at[d]] for u, d in LIP_MARKER_PAIRS if u in at and d in at]
    return np.array(found, np.int64).reshape(-1, 2)


def contact_aperture(aperture_mm: npt.ArrayLike, *, seal_mm: float, soft_mm: float) -> FloatArray:
    """Return the aperture allowed for a wished aperture, same shape, mm.

    Zero up to `seal_mm`; from `seal_mm` + `soft_mm` on unchanged; between, the cubic with matching values and
    slopes (0 and 1), so that the result is once continuously differentiable in time. It never decreases while
    `soft_mm` >= `seal_mm` / 2.

    Parameters
    ----------
    aperture_mm : array, mm
    seal_mm : float, mm
        Apertures up to here count as closed: landmark trackers report 0.3 to 0.9 mm for sealed lips.
    soft_mm : float, mm
        Width of the transition.
    """
    a = np.asarray(aperture_mm, float)
    end = seal_mm + soft_mm
    u = np.clip((a - seal_mm) / soft_mm, 0.0, 1.0)
    rise = u * u * (3.0 - 2.0 * u) * end + u * u * (u - 1.0) * soft_mm
    return np.where(a >= end, a, rise)


def contact_solver(response: FloatArray, ridge: float = 0.02) -> FloatArray:
    """Return how marker heights change for a wished change of every aperture, shape (n_markers, n_pairs).

    The least change of the markers (in the sense of a ridge) that gives the mesh's lip pairs their apertures.

    Parameters
    ----------
    response : (n_pairs, n_markers)
        Aperture of each pair of the mesh per mm that each marker moves up.
    ridge : float
        Relative to the mean strength of a pair; keeps pairs that hardly respond (at the corners) from
        asking for large movements.
    """
    gram = response @ response.T
    strength = float(np.trace(gram)) / max(len(gram), 1)
    return np.asarray(np.linalg.solve(gram + ridge * strength * np.eye(len(gram)), response).T)


def pair_response(pairs: IntArray, n_markers: int) -> FloatArray:
    """Return the response of marker pairs themselves: +1 for the upper, -1 for the lower marker."""
    response = np.zeros((len(pairs), n_markers))
    response[np.arange(len(pairs)), pairs[:, 0]] = 1.0
    response[np.arange(len(pairs)), pairs[:, 1]] = -1.0
    return response


def keep_lips_apart(
    targets_mm: FloatArray,
    rest_mm: FloatArray,
    response: FloatArray,
    solver: FloatArray,
    *,
    seal_mm: float = 0.0,
    soft_mm: float = 0.5,
) -> FloatArray:
    """Return targets whose lips touch but do not pass, (n_frames, n_markers, 3) mm; our choice.

    The aperture of each pair, measured along up against its aperture at rest, goes through
    :func:`contact_aperture`; what must change is spread over the lip markers of both lips.

    Parameters
    ----------
    targets_mm : (n_frames, n_markers, 3), mm
    rest_mm : (n_markers, 3), mm
        The closed mouth.
    response : (n_pairs, n_markers) or (n_pairs, n_markers, 3)
        Aperture of each pair per mm of marker height, or per mm along x, y, z.
    solver : (n_markers, n_pairs)
        From :func:`contact_solver`.
    seal_mm, soft_mm : float, mm
    """
    out = np.array(targets_mm, float)
    if response.ndim == 2:
        aperture = (out[..., 1] - rest_mm[:, 1]) @ response.T
    else:
        aperture = np.tensordot(out - rest_mm, response, axes=([1, 2], [1, 2]))
    change = contact_aperture(aperture, seal_mm=seal_mm, soft_mm=soft_mm) - aperture
    out[..., 1] += change @ solver.T
    return out
