"""Actors of a scene as plain data for the browser: surfaces, lines, points, their look and motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import pyvista as pv

from corpus_tools.core import MeshError
from workbench.views.cells import Cells, cells_of

__all__ = ["DEFAULT_LIGHTS", "MATERIAL", "surface_actor"]

DEFAULT_LIGHTS: list[dict[str, Any]] = [
    {"direction": [-0.5, 0.7, 1.0], "colour": [0.75] * 3, "eye": False},
    {"direction": [0.9, 0.2, 0.8], "colour": [0.35] * 3, "eye": False},
    {"direction": [0.0, -0.8, 0.6], "colour": [0.12] * 3, "eye": False},
]
"""Key, fill and a little from below, as :func:`corpus_tools.render.scene` has them."""

MATERIAL = {"ambient": 0.0, "diffuse": 1.0, "specular": 0.0, "specular_power": 1.0}
"""Ambient, diffuse and specular shares, as pyvista has them when none are given."""


def surface_actor(
    name: str,
    surface: pv.PolyData,
    *,
    color: Any = "white",
    opacity: float = 1.0,
    visible: bool = True,
    colours: npt.ArrayLike | None = None,
    scalars: Mapping[str, Any] | None = None,
    basis: npt.ArrayLike | None = None,
    patches: Mapping[str, Any] | None = None,
    style: str = "surface",
    flat: bool = False,
    point_size: float = 5.0,
    matrix: npt.ArrayLike | None = None,
    pickable: bool = True,
    ids: npt.ArrayLike | None = None,
    labels: Sequence[str] = (),
    **material: Any,
) -> dict[str, Any]:
    """Return one actor as plain data.

    Parameters
    ----------
    name : str
    surface : pv.PolyData
        With faces (made triangles) it is a surface, with lines a set of lines one pixel wide; without
        cells, a set of points drawn as round dots.
    color : anything pyvista takes for a colour
    opacity : float, 0-1
    colours : (n_points, 3 or 4) or (n_cells, 3 or 4), optional
        Red, green, blue (and opacity): whole numbers to 255, or numbers to 1.
    scalars : mapping, optional
        Colours by numbers, a number a point or a cell (:func:`workbench.views.scalars.scalar_colours`).
    basis : (n_points, k), optional
        Displacement of each vertex per displacement of each of k markers.
    patches : mapping, optional
        Bezier patches that carry the vertices (:mod:`workbench.views.patches`).
    style : str
        "surface", "wireframe" (the edges of the faces) or "points".
    flat : bool
        One normal a triangle; smooth normals otherwise, which need no point normals.
    point_size : float, px
    matrix : (4, 4), optional
        Where the actor stands.
    pickable : bool
        Whether the pointer finds it.
    ids : (n_points,), optional
        Number of each point that a pick tells; its row when not given.
    labels : sequence of str, optional
        What a pick calls each point.
    **material : float
        ambient, diffuse, specular, specular_power, as in pyvista.

    Raises
    ------
    MeshError
        Faces and lines in one surface; `basis`, `colours` or `scalars` of another length; patches on an actor
        whose triangles need corners of their own. The sentence names the actor.
    """
    cells = cells_of(name, surface, style)
    points = np.asarray(surface.points, np.float32)
    if basis is not None and np.shape(basis)[0] != len(points):
        raise MeshError(f"The basis of '{name}' has {np.shape(basis)[0]} rows for {len(points)} vertices.")
    rows = {
        "rgba": _rgba(name, colours, len(points), surface.n_cells),
        "values": _values(name, scalars, len(points), surface.n_cells),
        "basis": None if basis is None else np.asarray(basis, np.float32),
        "ids": None if ids is None else np.asarray(ids, np.uint32),
    }
    by_cell = any(row is not None and len(row) != len(points) for row in rows.values())
    if cells.kind != "points" and ((flat and cells.kind == "surface") or by_cell):
        if patches is not None:
            raise MeshError(f"The actor '{name}' hangs on patches and cannot be flat or coloured by cell.")
        points, cells, rows = _unshared(points, cells, rows)
    return {
        "name": name,
        "kind": cells.kind,
        "points": points.tobytes(),
        "cells": b"" if cells.kind == "points" else _bytes(cells.corners.astype(np.uint32)),
        "colours": _bytes(rows["rgba"]),
        "scalars": {**scalars, "values": _bytes(rows["values"])} if scalars else None,
        "basis": _bytes(rows["basis"]),
        "patches": None if patches is None else dict(patches),
        "colour": list(pv.Color(color).float_rgb),
        "opacity": float(opacity),
        "visible": bool(visible),
        "size": float(point_size),
        "material": [float({**MATERIAL, **material}[key]) for key in MATERIAL],
        "matrix": _columns(matrix),
        "pickable": bool(pickable),
        "ids": _bytes(rows["ids"]),
        "labels": list(labels),
    }


def _bytes(rows: npt.NDArray[Any] | None) -> bytes:
    return b"" if rows is None else np.ascontiguousarray(rows).tobytes()


def _unshared(
    points: npt.NDArray[np.float32], cells: Cells, rows: dict[str, npt.NDArray[Any] | None]
) -> tuple[npt.NDArray[np.float32], Cells, dict[str, npt.NDArray[Any] | None]]:
    """Give every cell corners of its own, each with the row of its point, or of its cell."""
    corner, owner, own = cells.unshared()
    spread = {
        key: row if row is None else row[corner if len(row) == len(points) else owner]
        for key, row in rows.items()
    }
    if spread["ids"] is None:
        spread["ids"] = corner.astype(np.uint32)
    return points[corner], own, spread


def _rgba(
    name: str, colours: npt.ArrayLike | None, n_points: int, n_cells: int
) -> npt.NDArray[np.uint8] | None:
    if colours is None:
        return None
    values = np.asarray(colours)
    if values.ndim != 2 or values.shape[1] not in (3, 4) or len(values) not in (n_points, n_cells):
        raise MeshError(
            f"The colours of '{name}' have shape {values.shape}; ({n_points}, 3 or 4) was expected."
        )
    if values.dtype != np.uint8:
        values = np.round(255 * np.clip(values, 0.0, 1.0)).astype(np.uint8)
    out = np.full((len(values), 4), 255, np.uint8)
    out[:, : values.shape[1]] = values
    return out


def _values(
    name: str, scalars: Mapping[str, Any] | None, n_points: int, n_cells: int
) -> npt.NDArray[np.float32] | None:
    if scalars is None:
        return None
    values = np.frombuffer(scalars["values"], np.float32)
    if len(values) not in (n_points, n_cells):
        raise MeshError(f"The scalars of '{name}' are {len(values)}; {n_points} were expected, one a point.")
    return values


def _columns(matrix: npt.ArrayLike | None) -> list[float] | None:
    """Column by column, as WebGL takes a matrix; None for the identity."""
    if matrix is None:
        return None
    values = np.asarray(matrix, float)
    return None if np.array_equal(values, np.eye(4)) else [float(v) for v in values.T.ravel()]
