"""How much of the motion of the markers a vertex takes part in: all near, none far off or at the eyes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from corpus_tools.core import FloatArray, IntArray, Mesh
from corpus_tools.mesh.lips import skin_faces
from corpus_tools.mesh.topology import geodesic_mm

__all__ = ["LID_MM", "REACH_MM", "STILL_MARKERS", "marker_fade", "smooth_step"]

STILL_MARKERS = tuple(f"eye{i}" for i in range(8))
LID_MM = (7.0, 15.0)
REACH_MM = (32.0, 75.0)


def smooth_step(u: npt.ArrayLike) -> FloatArray:
    """Return 0 for u <= 0, 1 for u >= 1 and the smoothstep between; infinities count as their side."""
    x = np.clip(np.nan_to_num(u, neginf=0.0, posinf=1.0), 0.0, 1.0)
    return np.asarray(x * x * (3.0 - 2.0 * x), float)


def marker_fade(mesh: Mesh, markers: IntArray) -> FloatArray:
    """Return 1 near the markers, 0 far from them and on the eyelids, smooth between; 1 at every marker.

    Parameters
    ----------
    mesh : Mesh
    markers : (n,) int
        Vertices of the markers that move.
    """
    faces = mesh.faces[skin_faces(mesh)]
    near, far = REACH_MM
    distance = geodesic_mm(mesh.vertices_mm, faces, markers)
    fade = smooth_step((far - distance) / (far - near))
    if "eyes" in mesh.part_names:
        eyes = cKDTree(mesh.vertices_mm[mesh.part_mask("eyes")])
        low, high = LID_MM
        to_eyes = np.asarray(eyes.query(mesh.vertices_mm)[0], float)
        fade = fade * smooth_step((to_eyes - low) / (high - low))
    return np.where(distance < 1e-9, 1.0, fade)
