"""A pyvista scene as plain data for the browser: surfaces, points, their look, lights, camera."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import pyvista as pv

from corpus_tools.core import MeshError

__all__ = ["DEFAULT_LIGHTS", "camera_of", "lights_of", "plotter_actors", "surface_actor"]

DEFAULT_LIGHTS: list[dict[str, Any]] = [
    {"direction": [-0.5, 0.7, 1.0], "colour": [0.75] * 3, "eye": False},
    {"direction": [0.9, 0.2, 0.8], "colour": [0.35] * 3, "eye": False},
    {"direction": [0.0, -0.8, 0.6], "colour": [0.12] * 3, "eye": False},
]
"""Key, fill and a little from below, as :func:`corpus_tools.render.scene` has them."""

_MATERIAL = {"ambient": 0.0, "diffuse": 1.0, "specular": 0.0, "specular_power": 1.0}


def surface_actor(
    name: str,
    surface: pv.PolyData,
    *,
    color: Any = "white",
    opacity: float = 1.0,
    visible: bool = True,
    colours: npt.ArrayLike | None = None,
    basis: npt.ArrayLike | None = None,
    flat: bool = False,
    point_size: float = 5.0,
    matrix: npt.ArrayLike | None = None,
    **material: float,
) -> dict[str, Any]:
    """Return one actor as plain data.

    Parameters
    ----------
    name : str
    surface : pv.PolyData
        With faces (made triangles) it is a surface; without, a set of points drawn as round dots.
    color : anything pyvista takes for a colour
    opacity : float, 0-1
    colours : (n_points, 3 or 4) or (n_cells, 3 or 4), optional
        Red, green, blue (and opacity): whole numbers to 255, or numbers to 1.
    basis : (n_points, k), optional
        Displacement of each vertex per displacement of each of k markers.
    flat : bool
        One normal a triangle; smooth normals otherwise, which need no point normals.
    point_size : float, px
    matrix : (4, 4), optional
        Where the actor stands.
    **material : float
        ambient, diffuse, specular, specular_power, as in pyvista.

    Raises
    ------
    MeshError
        Lines or strips, `basis` or `colours` of another length; the sentence names the actor.
    """
    if surface.n_lines or surface.n_strips:
        raise MeshError(
            f"The actor '{name}' has lines or strips, which the view cannot show; give triangles or points."
        )
    faces = _triangles(surface)
    points = np.asarray(surface.points, np.float32)
    rgba = _rgba(name, colours, len(points), surface.n_cells)
    by_cell = rgba is not None and len(rgba) != len(points)
    if len(faces) and (flat or by_cell):
        points, faces, rgba = _unshared(surface, points, faces, rgba, by_cell)
        if basis is not None:
            basis = np.asarray(basis)[_triangles(surface).ravel()]
    if basis is not None and np.shape(basis)[0] != len(points):
        raise MeshError(f"The basis of '{name}' has {np.shape(basis)[0]} rows for {len(points)} vertices.")
    return {
        "name": name,
        "kind": "surface" if len(faces) else "points",
        "points": points.tobytes(),
        "faces": np.ascontiguousarray(faces, np.uint32).tobytes(),
        "colours": b"" if rgba is None else rgba.tobytes(),
        "basis": b"" if basis is None else np.ascontiguousarray(basis, np.float32).tobytes(),
        "colour": list(pv.Color(color).float_rgb),
        "opacity": float(opacity),
        "visible": bool(visible),
        "size": float(point_size),
        "material": [float({**_MATERIAL, **material}[key]) for key in _MATERIAL],
        "matrix": _columns(matrix),
    }


def _triangles(surface: pv.PolyData) -> npt.NDArray[np.int64]:
    if not surface.faces.size:
        return np.zeros((0, 3), np.int64)
    whole = surface if surface.is_all_triangles else surface.triangulate()
    return np.asarray(whole.faces.reshape(-1, 4)[:, 1:], np.int64)


def _unshared(
    surface: pv.PolyData,
    points: npt.NDArray[np.float32],
    faces: npt.NDArray[np.int64],
    rgba: npt.NDArray[np.uint8] | None,
    by_cell: bool,
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.int64], npt.NDArray[np.uint8] | None]:
    """Give every triangle corners of its own, so that normals and colours may jump at its edges."""
    corners = faces.ravel()
    if rgba is not None and by_cell:
        sizes = np.diff(pv.convert_array(surface.GetPolys().GetOffsetsArray()))
        rgba = np.repeat(rgba, 3 * (sizes - 2), axis=0)
    elif rgba is not None:
        rgba = rgba[corners]
    return points[corners], np.arange(len(corners)).reshape(-1, 3), rgba


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


def _columns(matrix: npt.ArrayLike | None) -> list[float] | None:
    """Column by column, as WebGL takes a matrix; None for the identity."""
    if matrix is None:
        return None
    values = np.asarray(matrix, float)
    return None if np.array_equal(values, np.eye(4)) else [float(v) for v in values.T.ravel()]


def plotter_actors(
    plotter: pv.Plotter, bases: Mapping[str, npt.ArrayLike] | None = None
) -> list[dict[str, Any]]:
    """Return every actor of a pyvista scene as plain data.

    Parameters
    ----------
    plotter : pv.Plotter
        Actors of PolyData: surfaces and points, with colour, opacity, visibility, material, own place, and
        scalars coloured as the mapper does.
    bases : mapping of actor name -> (n_points, k), optional
        Makes actors deform with k markers (:func:`surface_actor`).

    Raises
    ------
    MeshError
        An actor that is not a surface or a set of points, or one drawn as a wireframe: the sentence names it.
    """
    wanted = dict(bases or {})
    found = [_plotter_actor(name, actor, wanted.pop(name, None)) for name, actor in plotter.actors.items()]
    if wanted:
        raise MeshError(f"The scene has no actor '{next(iter(wanted))}'; it has {', '.join(plotter.actors)}.")
    return found


def _plotter_actor(name: str, actor: Any, basis: npt.ArrayLike | None) -> dict[str, Any]:
    surface = getattr(getattr(actor, "mapper", None), "dataset", None)
    if not isinstance(surface, pv.PolyData) or not isinstance(actor, pv.Actor):
        kind = type(actor).__name__ if surface is None else type(surface).__name__
        raise MeshError(
            f"The actor '{name}' is a {kind}; the view shows surfaces and points only (PolyData): "
            "remove it, or give its extract_surface()."
        )
    look = actor.prop
    if look.style.lower() == "wireframe":
        raise MeshError(
            f"The actor '{name}' is drawn as a wireframe; the view shows surfaces and points only."
        )
    if look.style.lower() == "points" and surface.n_cells:
        surface = pv.PolyData(np.asarray(surface.points))
    return surface_actor(
        name,
        surface,
        color=look.color,
        opacity=look.opacity,
        visible=actor.visibility,
        colours=_mapped_colours(actor.mapper),
        basis=basis,
        flat=str(look.interpolation).lower().endswith("flat") and not _has_normals(surface),
        point_size=look.point_size,
        matrix=pv.array_from_vtkmatrix(actor.GetMatrix()),
        **_material(look),
    )


def _has_normals(surface: pv.PolyData) -> bool:
    return "Normals" in surface.point_data


def _material(look: Any) -> dict[str, float]:
    if not look.lighting:
        return {"ambient": 1.0, "diffuse": 0.0, "specular": 0.0}
    return {key: float(getattr(look, key)) for key in _MATERIAL}


def _mapped_colours(mapper: Any) -> npt.NDArray[np.uint8] | None:
    """Return the colours that the mapper gives its scalars, a row a point (or cell); None without scalars."""
    if not mapper.scalar_visibility:
        return None
    by_texture = mapper.GetInterpolateScalarsBeforeMapping()
    mapper.SetInterpolateScalarsBeforeMapping(0)  # else it makes a texture, not colours
    try:
        mapped = mapper.MapScalars(mapper.dataset, 1.0)
    finally:
        mapper.SetInterpolateScalarsBeforeMapping(by_texture)
    if mapped is None:  # the scalars it was told to map are not there
        return None
    return np.array(pv.convert_array(mapped), np.uint8).reshape(-1, mapped.GetNumberOfComponents())


def lights_of(plotter: pv.Plotter) -> list[dict[str, Any]]:
    """Return the lights of a scene that are on.

    Each has `direction` (to the light), `colour` (times intensity) and `eye` (stands in the camera's space).
    """
    found = []
    for light in plotter.renderer.lights:
        if not light.on:
            continue
        headlight = bool(light.is_headlight)
        towards = np.array([0.0, 0.0, 1.0])
        if not headlight:
            towards = np.asarray(light.position, float) - np.asarray(light.focal_point, float)
        colour = light.intensity * np.array(light.diffuse_color.float_rgb)
        found.append(
            {
                "direction": [float(v) for v in towards],
                "colour": [float(v) for v in colour],
                "eye": headlight or bool(light.is_camera_light),
            }
        )
    return found


def camera_of(plotter: pv.Plotter) -> dict[str, Any]:
    """Return the camera of a scene, in its units and degrees; parallel_scale is 0 when perspective."""
    camera = plotter.camera
    return {
        "position": [float(v) for v in camera.position],
        "focal_point": [float(v) for v in camera.focal_point],
        "view_up": [float(v) for v in camera.up],
        "view_angle": float(camera.view_angle),
        "parallel_scale": float(camera.parallel_scale) if camera.parallel_projection else 0.0,
    }
