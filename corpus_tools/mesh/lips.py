"""The lips of a mesh: how far open they are, and which side of the mouth every vertex belongs to."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from corpus_tools.core import BoolArray, FloatArray, Mesh, MeshError
from corpus_tools.mesh.topology import geodesic_mm

__all__ = ["LOWER_LIP", "UPPER_LIP", "close_lips", "lower_side", "signed_lip_aperture_mm"]

UPPER_LIP = ("lip_in1", "lip_in2", "lip_in3", *(f"lip_out{i}" for i in range(1, 6)))
LOWER_LIP = ("lip_in5", "lip_in6", "lip_in7", *(f"lip_out{i}" for i in range(7, 12)))
UP = np.array([0.0, 1.0, 0.0])


def signed_lip_aperture_mm(vertices_mm: npt.ArrayLike, mesh: Mesh) -> FloatArray:
    """Return the mean over the mesh's lip pairs of (upper - lower) . up, shape (n_frames,), mm.

    Positive when the mouth is open, negative when the lips pass through each other.

    Parameters
    ----------
    vertices_mm : (n_frames, n_vertices, 3) or (n_vertices, 3), mm
    mesh : Mesh
        Its `lip_pairs` are used.

    Raises
    ------
    MeshError
        The mesh has no lip pairs.
    """
    if not len(mesh.lip_pairs):
        raise MeshError(f"The mesh '{mesh.name}' has no lip pairs; list facing upper and lower lip vertices.")
    v = np.asarray(vertices_mm)
    v = v[None] if v.ndim == 2 else v
    upper, lower = v[:, mesh.lip_pairs[:, 0], 1], v[:, mesh.lip_pairs[:, 1], 1]
    return np.asarray((upper - lower).mean(axis=1), float)


def close_lips(
    vertices_mm: FloatArray, faces: npt.ArrayLike, lip_pairs: npt.ArrayLike, reach_mm: float = 6.0
) -> FloatArray:
    """Bring the lips of a nearly closed mouth together, so that every lip pair touches along up.

    Half of each gap is given to either lip and fades out over `reach_mm` along the skin; our choice: heads
    are drawn with a slit of about a millimetre, which a lip aperture must not count as open.

    Parameters
    ----------
    vertices_mm : (n_vertices, 3) float64, mm
    faces : (n, 3 or 4) int
    lip_pairs : (n_pairs, 2) int
    reach_mm : float, mm

    Returns
    -------
    (n_vertices, 3) float64, mm
    """
    pairs = np.asarray(lip_pairs, np.int64)
    gap = vertices_mm[pairs[:, 0], 1] - vertices_mm[pairs[:, 1], 1]
    near = np.stack([geodesic_mm(vertices_mm, faces, pairs[:, k]) for k in (0, 1)])
    moved = vertices_mm.copy()
    for k, sign in ((0, -0.5), (1, 0.5)):
        own = (near[k] < near[1 - k]) & (near[k] < reach_mm)
        order = np.argsort(vertices_mm[pairs[:, k], 0])
        share = np.interp(vertices_mm[own, 0], vertices_mm[pairs[order, k], 0], gap[order])
        fade = (1.0 - (near[k, own] / reach_mm) ** 2) ** 2
        moved[own, 1] += sign * share * fade
    return moved


def lower_side(mesh: Mesh, hard_mm: float = 4.0) -> FloatArray:
    """Return how much each skin vertex belongs to the lower lip's side: 0 upper, 1 lower; (n_vertices,).

    Labels come from distances along the skin to the upper against the lower lip markers, so that vertices
    that touch in space but lie on different lips never share a side. The normal-angle threshold of paper A
    section 6 mislabels two to three lip vertices in a hundred when the mouth is closed; this is our choice.
    Away from the mouth the sides blend into each other.

    Parameters
    ----------
    mesh : Mesh
        With lip markers; without any, everything is upper.
    hard_mm : float, mm
        Within this distance of a lip marker the label is 0 or 1.
    """
    to_upper, to_lower = lip_distances_mm(mesh)
    if not np.isfinite(to_upper).any() or not np.isfinite(to_lower).any():
        return np.zeros(mesh.n_vertices)
    reached = np.isfinite(to_upper) & np.isfinite(to_lower)
    difference = np.where(reached, to_upper, 0.0) - np.where(reached, to_lower, 0.0)
    near = np.where(reached, np.minimum(to_upper, to_lower), 0.0)
    width = np.maximum(near - hard_mm, 1e-6)
    u = np.clip(0.5 + 0.5 * difference / width, 0.0, 1.0)
    return np.where(reached, u * u * (3.0 - 2.0 * u), 0.0)


def lip_distances_mm(mesh: Mesh) -> tuple[FloatArray, FloatArray]:
    """Return the distance along the skin to the upper and to the lower lip's markers and lip pairs, mm.

    Infinite where no path leads and, everywhere, for a lip without any.
    """
    faces = mesh.faces[skin_faces(mesh)]
    found = []
    for column, wanted in enumerate((UPPER_LIP, LOWER_LIP)):
        start = [mesh.markers[n] for n in wanted if n in mesh.markers]
        start += mesh.lip_pairs[:, column].tolist()
        found.append(
            geodesic_mm(mesh.vertices_mm, faces, start) if start else np.full(mesh.n_vertices, np.inf)
        )
    return found[0], found[1]


def skin_faces(mesh: Mesh) -> BoolArray:
    """Return which faces lie on the part called skin; all of them where no part has that name."""
    if "skin" not in mesh.part_names:
        return np.ones(len(mesh.faces), bool)
    skin = mesh.part_mask("skin")
    return np.asarray(skin[mesh.faces].all(axis=1))
