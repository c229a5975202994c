"""Landmarks of a face found from its shape alone: the profile in its middle, and the line between the lips.

Our choice throughout: the face is seen from the front as a picture of depths, whose middle column is the
profile and in which the lip line is a valley that ends at the mouth corners.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter, grey_closing

from corpus_tools.core import FloatArray, Mesh, MeshError
from corpus_tools.mesh.lips import skin_faces

__all__ = ["FaceLandmarks", "find_landmarks"]

STEP = 1.0 / 600.0
"""Size of a cell of the picture of depths, as a share of the extent of the mesh."""
PROFILE = ("nasion", "nose", "subnasal", "upper_lip", "stomion", "lower_lip", "fold", "chin")
FAR = -1e3
CORNER_AT = 0.5
"""A mouth corner is where the valley is half as deep as it is in the middle half of the mouth."""
TILT = 0.3
"""Below the lips the profile is looked at along a line that leans back by this: chins recede."""
LEAST_VALLEY = 0.01
"""Valleys flatter than this share of the way from nose to mouth are none."""


@dataclass(frozen=True, slots=True, eq=False)
class FaceLandmarks:
    """Where a face has what.

    Attributes
    ----------
    points : mapping of name -> (3,) mm
        Profile from nasion to chin, both mouth corners, and six points on the sides of the face.
    lip_line : (n, 3) mm
        The line between the lips, from the corner at the least x to the other one.
    """

    points: dict[str, FloatArray]
    lip_line: FloatArray

    @property
    def span_mm(self) -> float:
        """Height from the lip line to the tip of the nose, mm."""
        return float(self.points["nose"][1] - self.points["stomion"][1])


@dataclass(frozen=True, slots=True, eq=False)
class _Depths:
    z: FloatArray
    low: FloatArray
    step: float
    middle: int

    def at(self, row: int, column: int) -> FloatArray:
        place = self.low + self.step * np.array([column, row])
        return np.array([place[0], place[1], self.z[row, column]])


def find_landmarks(mesh: Mesh) -> FaceLandmarks:
    """Find the landmarks of a face that looks along +z with +y up, mouth closed.

    Raises
    ------
    MeshError
        The profile is not that of such a face, or there is no line between the lips.
    """
    depths = _depths(mesh)
    rows = _profile_rows(mesh, depths)
    points = {name: depths.at(row, depths.middle) for name, row in rows.items()}
    line = _lip_line(mesh, depths, rows)
    points |= {"corner_low": line[0], "corner_high": line[-1]}
    reach = points["stomion"][2] - (points["nose"][1] - points["stomion"][1])
    for name in ("stomion", "nose", "nasion"):
        for side in (-1, 1):
            points[f"side_{name}_{side}"] = _side(depths, rows[name], side, float(reach))
    return FaceLandmarks(points, line)


def _depths(mesh: Mesh) -> _Depths:
    """Return the greatest z over a grid of x and y, of the skin."""
    v = mesh.vertices_mm
    corners = v[mesh.faces[skin_faces(mesh)]]
    low, high = corners.min(axis=(0, 1))[:2], corners.max(axis=(0, 1))[:2]
    step = float((high - low).max()) * STEP
    shape = np.ceil((high - low) / step).astype(int) + 1
    z = np.full((shape[1], shape[0]), -np.inf)
    longest = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
    parts = np.clip(np.ceil(1.5 * longest / step).astype(int), 1, 60)
    for n in np.unique(parts):
        cells = corners[parts == n]
        points = np.einsum("bk,nkd->nbd", _grid_in_triangle(int(n)), cells).reshape(-1, 3)
        at = np.round((points[:, :2] - low) / step).astype(int)
        np.maximum.at(z, (at[:, 1], at[:, 0]), points[:, 2])
    smooth = gaussian_filter(grey_closing(np.where(np.isfinite(z), z, FAR), size=(5, 3)), 1.0)
    return _Depths(smooth, low, step, round(0.5 * float(high[0] - low[0]) / step))


def _grid_in_triangle(n: int) -> FloatArray:
    i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1))
    inside = i + j <= n
    a, b = i[inside] / n, j[inside] / n
    return np.stack([a, b, 1.0 - a - b], axis=1)


def _profile_rows(mesh: Mesh, depths: _Depths) -> dict[str, int]:
    """Return the rows of the profile's bulges and hollows, going up and down from the tip of the nose."""
    profile = gaussian_filter(depths.z[:, depths.middle], 1.0)
    nose = int(np.argmax(profile))
    rows = {"nose": nose}
    here = nose
    for name in PROFILE[2:]:
        sign = -1.0 if name in ("subnasal", "stomion", "fold") else 1.0
        tilt = TILT * depths.step * np.arange(len(profile)) if name in ("fold", "chin") else 0.0
        here = _next(sign * (profile - tilt), here, -1)
        if here < 0:
            _no_face(mesh, f"under the nose there is no {name.replace('_', ' ')}")
        rows[name] = here
    above = _next(-profile, nose, 1)
    if above < 0:
        _no_face(mesh, "above the nose there is no hollow of its root")
    return rows | {"nasion": above}


def _next(values: FloatArray, start: int, way: int, wide: int = 3) -> int:
    """Return the next place from `start` at which values are the greatest within `wide` cells, or -1."""
    for row in range(start + way * (wide + 1), len(values) - wide - 1 if way > 0 else wide, way):
        near = values[row - wide : row + wide + 1]
        if values[row] >= near.max() and values[row] > near.min():
            return row
    return -1


def _no_face(mesh: Mesh, why: str) -> None:
    raise MeshError(
        f"No face was found in the mesh '{mesh.name}': {why}; turn it to +y up and +z out of the face, mouth "
        "closed, or name its markers in a file of picks."
    )


def _lip_line(mesh: Mesh, depths: _Depths, rows: dict[str, int]) -> FloatArray:
    """Follow the valley between the lips to both sides until it is half as deep."""
    span = rows["nose"] - rows["stomion"]
    sides = [_valley(depths, rows["stomion"], span, way) for way in (-1, 1)]
    usual = float(np.median(np.concatenate([s[1][: max(span // 2, 1)] for s in sides])))
    if usual < LEAST_VALLEY * span * depths.step:
        _no_face(mesh, "there is no line between the lips")
    points = []
    for way, (at, strength) in zip((-1, 1), sides, strict=True):
        beyond = np.flatnonzero(strength < CORNER_AT * usual)
        beyond = beyond[beyond > span // 3]
        last = int(beyond[0]) if len(beyond) else len(at) - 1
        own = [depths.at(int(at[k]), depths.middle + way * k) for k in range(last + 1)]
        points += own[:0:-1] if way < 0 else own
    return np.array(points)


def _valley(depths: _Depths, row: int, span: int, way: int) -> tuple[npt.NDArray[np.int64], FloatArray]:
    """Return row and depth of the valley at every column from the middle outward."""
    half, reach = max(round(0.09 * span), 1), max(round(0.1 * span), 1)
    rows, strengths = [], []
    for k in range(int(1.4 * span)):
        column = int(np.clip(depths.middle + way * k, 0, depths.z.shape[1] - 1))
        window = np.arange(row - reach, row + reach + 1)
        z = depths.z[:, column]
        depth = np.minimum(z[window - half] + z[window + half] - 2.0 * z[window], 0.25 * span * depths.step)
        best = int(np.argmax(depth))
        if depth[best] > LEAST_VALLEY * span * depths.step:
            row = int(window[best])
        rows.append(row)
        strengths.append(float(depth[best]))
    return np.array(rows, np.int64), np.array(strengths)


def _side(depths: _Depths, row: int, side: int, reach_mm: float) -> FloatArray:
    """Return the first point beside the middle that lies as far back as `reach_mm`."""
    columns = np.arange(depths.middle, depths.z.shape[1] - 1 if side > 0 else 0, side)
    back = np.flatnonzero(depths.z[row, columns] < reach_mm)
    k = int(back[0]) if len(back) else len(columns) - 1
    place = depths.at(row, int(columns[k]))
    place[2] = max(place[2], reach_mm)
    return place
