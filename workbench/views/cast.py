"""Several heads in one view: where each stands beside the first, and a camera on all of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from corpus_tools.core import FloatArray, Mesh
from workbench.views.cameras import face_frame, look_at, skin_mm

__all__ = ["cast_camera", "cast_places", "cast_prefix"]

_GAP_MM = 25.0
_BELOW = 0.32
"""Share of the spare height that lies below: more would show where the necks end."""
_ASPECT = 1.3
"""Width over height of the picture that all heads have to fit into (our choice: the card of the page)."""


def cast_prefix(name: str) -> str:
    """Return what begins the names of the actors of a head beside the first."""
    return f"{name}/"


def _marked_centre(mesh: Mesh) -> FloatArray:
    points = mesh.vertices_mm[list(mesh.markers.values())] if mesh.markers else skin_mm(mesh)
    return np.asarray(0.5 * (points.min(axis=0) + points.max(axis=0)))


def cast_places(meshes: Sequence[Mesh]) -> list[FloatArray]:
    """Return where each head stands, (4, 4) each: side by side in true size, faces at one height.

    Parameters
    ----------
    meshes : sequence of Mesh
        The first stays where it is; the others follow on its left, which is the right of the picture.
    """
    first, places, edge = _marked_centre(meshes[0]), [np.eye(4)], float(skin_mm(meshes[0])[:, 0].max())
    for mesh in meshes[1:]:
        x = skin_mm(mesh)[:, 0]
        matrix = np.eye(4)
        matrix[:3, 3] = first - _marked_centre(mesh)
        matrix[0, 3] = edge + _GAP_MM - float(x.min())
        edge += _GAP_MM + float(np.ptp(x))
        places.append(matrix)
    return places


def cast_camera(meshes: Sequence[Mesh]) -> dict[str, Any]:
    """Return a camera straight on all heads of :func:`cast_places`."""
    frames = []
    for mesh, place in zip(meshes, cast_places(meshes), strict=True):
        low, high, centre = face_frame(mesh)
        x = skin_mm(mesh)[:, 0] + place[0, 3]
        frames.append((low + place[1, 3], high + place[1, 3], x.min(), x.max(), centre[2] + place[2, 3]))
    low, high, left, right, z = np.array(frames).T
    own = float(high.max() - low.min())
    height = max(own, float(right.max() - left.min() + _GAP_MM) / _ASPECT)
    bottom = float(low.min()) - _BELOW * (height - own)
    centre = np.array([0.5 * (left.min() + right.max()), bottom + 0.5 * height, z.mean()])
    return look_at(centre, height, around_deg=4.0)
