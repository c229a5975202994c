"""The cells of a pyvista surface as the browser draws them: triangles, line segments or bare points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pyvista as pv

from corpus_tools.core import MeshError

__all__ = ["Cells", "cells_of"]


@dataclass(frozen=True)
class Cells:
    """What is drawn of a set of points.

    Attributes
    ----------
    kind : str
        "surface", "lines" or "points".
    corners : (n, 3), (n, 2) or (n, 1)
        Points of each triangle, segment or point.
    owner : (n,)
        The cell of the surface that each belongs to.
    """

    kind: str
    corners: npt.NDArray[np.int64]
    owner: npt.NDArray[np.int64]

    def unshared(self) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64], Cells]:
        """Return point and cell of every corner, and the same cells with corners of their own.

        Normals and colours may then jump at their edges.
        """
        width = self.corners.shape[1]
        own = np.arange(self.corners.size).reshape(-1, width)
        return self.corners.ravel(), np.repeat(self.owner, width), Cells(self.kind, own, self.owner)


def cells_of(name: str, surface: pv.PolyData, style: str = "surface") -> Cells:
    """Return what is drawn of a surface.

    Parameters
    ----------
    name : str
        Of the actor, for the error.
    surface : pv.PolyData
        Faces of any number of corners, strips, or lines; without any, points.
    style : str
        "surface", "wireframe" (the edges of the faces) or "points".

    Raises
    ------
    MeshError
        Faces and lines in one surface.
    """
    if surface.n_lines and (surface.faces.size or surface.n_strips):
        raise MeshError(
            f"The actor '{name}' has faces and lines; give two actors, one with the faces, one with lines."
        )
    if style == "points" or not surface.n_cells:
        return _points(surface)
    if surface.n_strips:
        surface = surface.triangulate()
    if surface.n_lines:
        return _segments(surface.GetLines(), closed=False, first_cell=surface.n_verts)
    if not surface.faces.size:
        return _points(surface)
    if style == "wireframe":
        return _segments(surface.GetPolys(), closed=True, first_cell=surface.n_verts)
    return _triangles(surface)


def _points(surface: pv.PolyData) -> Cells:
    every = np.arange(surface.n_points)
    return Cells("points", every[:, None], every)


def _triangles(surface: pv.PolyData) -> Cells:
    offsets = pv.convert_array(surface.GetPolys().GetOffsetsArray())
    whole = surface if surface.is_all_triangles else surface.triangulate()
    corners = np.asarray(whole.faces.reshape(-1, 4)[:, 1:], np.int64)
    owner = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets) - 2)
    return Cells("surface", corners, surface.n_verts + owner)


def _segments(cells: object, *, closed: bool, first_cell: int) -> Cells:
    """Return the steps from point to point along every line, or round every face."""
    offsets = np.asarray(pv.convert_array(cells.GetOffsetsArray()), np.int64)  # type: ignore[attr-defined]
    points = np.asarray(pv.convert_array(cells.GetConnectivityArray()), np.int64)  # type: ignore[attr-defined]
    owner = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
    after = np.arange(1, len(points) + 1)
    last = offsets[1:] - 1
    after[last] = offsets[:-1]
    keep = np.ones(len(points), bool)
    if not closed:
        keep[last] = False
    steps = np.stack([points, points[after]], axis=1)[keep]
    return Cells("lines", steps, first_cell + owner[keep])
