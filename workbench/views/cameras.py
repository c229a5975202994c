"""Cameras on one head, and on several that stand side by side."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from corpus_tools.core import Mesh

__all__ = ["distance", "face_frame", "head_camera", "look_at", "skin_mm"]

_VIEW_ANGLE_DEG = 20.0
_AROUND_DEG = 22.0
_ABOVE_DEG = 3.0
_OVER, _BELOW = 0.02, 0.12
"""Ground above the skull and neck below the chin, as shares of the height between."""


def skin_mm(mesh: Mesh) -> npt.NDArray[np.float64]:
    """Return the vertices of the skin, (n, 3) mm; all of them when no part is called so."""
    return mesh.vertices_mm[mesh.part_mask("skin")] if "skin" in mesh.part_names else mesh.vertices_mm


def face_frame(mesh: Mesh) -> tuple[float, float, npt.NDArray[np.float64]]:
    """Return the lowest and highest y that a picture of a head shows, mm, and its middle.

    The top of the skull has some ground above it; below the chin there is neck as far as the picture goes, so
    that where a head ends is out of sight.
    """
    skin = skin_mm(mesh)
    marked = mesh.vertices_mm[list(mesh.markers.values())] if mesh.markers else skin
    top, chin = float(skin[:, 1].max()), float(marked[:, 1].min())
    low, high = chin - _BELOW * (top - chin), top + _OVER * (top - chin)
    middle = 0.5 * (skin.min(axis=0) + skin.max(axis=0))
    return low, high, np.array([middle[0], 0.5 * (low + high), 0.5 * (middle[2] + marked[:, 2].max())])


def look_at(
    centre: npt.ArrayLike, height: float, aside: float = 0.0, around_deg: float = _AROUND_DEG
) -> dict[str, Any]:
    """Return a camera that shows `height` mm about a place, from a little above.

    Parameters
    ----------
    centre : (3,), mm
    height : float, mm
    aside : float
        How far left of the middle of the picture the place is, as a share of its height.
    around_deg : float
        How far from straight in front the camera stands.
    """
    around, above = np.radians([around_deg, _ABOVE_DEG])
    towards = np.array([np.sin(around) * np.cos(above), np.sin(above), np.cos(around) * np.cos(above)])
    focus = np.asarray(centre) + aside * height * np.array([np.cos(around), 0.0, -np.sin(around)])
    distance = 0.5 * height / np.tan(np.radians(_VIEW_ANGLE_DEG / 2))
    return {
        "position": [float(v) for v in focus + distance * towards],
        "focal_point": [float(v) for v in focus],
        "view_up": [0.0, 1.0, 0.0],
        "view_angle": _VIEW_ANGLE_DEG,
        "parallel_scale": 0.0,
    }


def distance(camera: Mapping[str, Any]) -> float:
    """Return how far a camera stands from what it looks at, mm."""
    return float(np.linalg.norm(np.subtract(camera["position"], camera["focal_point"])))


def head_camera(mesh: Mesh, aside: float = 0.0) -> dict[str, Any]:
    """Return a camera on the whole face, a little from the side, so that lips show in depth.

    Parameters
    ----------
    mesh : Mesh
    aside : float
        As of :func:`look_at`.
    """
    low, high, centre = face_frame(mesh)
    return look_at(centre, high - low, aside)
