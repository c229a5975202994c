"""Colours of the parts of a head, point by point: regions of the skin, single teeth, irises."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from corpus_tools.core import FloatArray, IntArray, Mesh
from corpus_tools.mesh import SkinRegion, skin_regions

__all__ = ["LIMBUS", "part_colours"]

Colours = npt.NDArray[np.float32]

REGION_COLOURS = {
    SkinRegion.FACE: (0.863, 0.682, 0.588),
    SkinRegion.LIPS: (0.760, 0.475, 0.430),
    SkinRegion.MOUTH: (0.330, 0.130, 0.125),
}
TEETH_COLOURS = {"upper_teeth": (0.97, 0.95, 0.90), "lower_teeth": (0.94, 0.91, 0.85)}
TEETH_DEPTH_MM = 24.0
TOOTH_WIDTHS_MM = {
    "upper_teeth": (8.5, 6.5, 7.6, 7.0, 6.8, 10.0, 9.5),
    "lower_teeth": (5.4, 6.0, 6.9, 7.0, 7.2, 11.0, 10.5),
}
"""From the middle to either side: a usual set, stretched to the arch of the mesh."""
GAP_MM = 0.35
GAP_SHADE = 0.45

PUPIL, IRIS, LIMBUS = 0.15, 0.385, 0.43
"""Radii in units of the eyeball's."""
PUPIL_COLOUR = (0.03, 0.025, 0.02)
IRIS_COLOURS = ((0.46, 0.33, 0.20), (0.24, 0.16, 0.09))
SCLERA_COLOUR = (0.95, 0.93, 0.90)
CORNER_COLOUR = (0.86, 0.66, 0.60)


def part_colours(mesh: Mesh, part: str, points_mm: FloatArray, used: IntArray) -> Colours | None:
    """Return the colours of a part at rest, (n_points, 3); None where it has one colour throughout.

    Parameters
    ----------
    mesh : Mesh
    part : str
    points_mm : (n_points, 3), mm
        Of the surface as it is drawn.
    used : (n_used,)
        Vertices of the mesh in the part; for the skin these are the points.
    """
    if part == "eyes":
        return _eyes(points_mm)
    if part in TEETH_COLOURS:
        return _teeth(points_mm, part)
    if part == "skin":
        table = np.array([REGION_COLOURS[region] for region in SkinRegion], np.float32)
        return np.asarray(table[skin_regions(mesh)][used])
    return None


def _eyes(points: FloatArray) -> Colours:
    """Return white, iris and pupil around the foremost point of either ball."""
    colours = np.tile(np.array(SCLERA_COLOUR), (len(points), 1))
    for side in (points[:, 0] > 0, points[:, 0] <= 0):
        if side.any():
            ball = points[side]
            centre = 0.5 * (ball.min(axis=0) + ball.max(axis=0))
            towards = (ball - centre) / max(0.5 * float(np.ptp(ball[:, 1])), 1e-9)
            colours[side] = _eye(towards)
    return np.asarray(colours, np.float32)


def _eye(towards: FloatArray) -> FloatArray:
    """Colour one ball; `towards` (n, 3) are points on the unit sphere, +z is where it looks."""
    radius = np.hypot(towards[:, 0], towards[:, 1])
    radius = np.where(towards[:, 2] > 0, radius, 2.0)
    redness = np.clip((radius - 0.55) / 0.45, 0.0, 1.0)[:, None]
    colours = (1 - redness) * np.array(SCLERA_COLOUR) + redness * np.array(CORNER_COLOUR)
    inner, outer = (np.array(colour) for colour in IRIS_COLOURS)
    depth = np.clip((radius - PUPIL) / (IRIS - PUPIL), 0.0, 1.0)[:, None] ** 1.6
    iris = (1 - depth) * inner + depth * outer
    inside = np.clip((LIMBUS - radius) / (LIMBUS - IRIS), 0.0, 1.0)[:, None]
    colours = (1 - inside) * colours + inside * iris
    pupil = np.clip((PUPIL + 0.03 - radius) / 0.03, 0.0, 1.0)[:, None]
    colours = (1 - pupil) * colours + pupil * np.array(PUPIL_COLOUR)
    lid = np.clip((towards[:, 1] - 0.05) / 0.45, 0.0, 1.0)[:, None]  # the shade that the upper lid throws
    return np.asarray(colours * (1.0 - 0.45 * lid))


def _teeth(points: FloatArray, part: str) -> Colours:
    """Return bright teeth in front, in the shade of the cheeks further back, with gaps between them."""
    depth = (points[:, 2].max() - points[:, 2]) / TEETH_DEPTH_MM
    light = np.clip(1.15 - depth, 0.18, 1.0)
    arc = _arc_mm(points)
    edges = np.cumsum(TOOTH_WIDTHS_MM[part])
    edges = np.concatenate([[0.0], edges * arc.max() / edges[-1]])
    away = np.abs(arc[:, None] - edges).min(axis=1)
    light *= 1.0 - GAP_SHADE * np.exp(-((away / GAP_MM) ** 2))
    return np.asarray(light[:, None] ** np.array([1.0, 1.2, 1.3]) * np.array(TEETH_COLOURS[part]), np.float32)


def _arc_mm(points: FloatArray) -> FloatArray:
    """Return how far along the arch of the teeth each point is from the middle, mm, to either side."""
    wide = 0.5 * float(np.ptp(points[:, 0]))
    front, back = points[:, 2].max(), points[:, 2].min()
    z0 = back + 0.3 * (front - back)
    long = front - z0
    angle = np.arctan2(np.abs(points[:, 0]) * long, np.maximum(points[:, 2] - z0, -1e-9) * wide)
    steps = np.linspace(0.0, np.pi, 181)
    pace = np.hypot(wide * np.cos(steps), long * np.sin(steps))
    length = np.concatenate([[0.0], np.cumsum(0.5 * (pace[1:] + pace[:-1]) * np.diff(steps))])
    return np.asarray(np.interp(angle, steps, length))
