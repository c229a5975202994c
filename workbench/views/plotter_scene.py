"""A pyvista scene as plain data for the browser: its actors, its lights, its camera."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import pyvista as pv

from corpus_tools.core import MeshError
from workbench.views.scalars import address, mapped_scalars
from workbench.views.scene_actors import MATERIAL, surface_actor

__all__ = ["camera_of", "lights_of", "plotter_actors"]


def plotter_actors(
    plotter: pv.Plotter, bases: Mapping[str, npt.ArrayLike] | None = None
) -> list[dict[str, Any]]:
    """Return every actor of a pyvista scene as plain data.

    Parameters
    ----------
    plotter : pv.Plotter
        Actors of PolyData: surfaces, wireframes, lines and points, with colour, opacity, visibility,
        material, own place, scalars coloured as the mapper does; a legend where the scene has a scalar bar.
    bases : mapping of actor name -> (n_points, k), optional
        Makes actors deform with k markers (:func:`surface_actor`).

    Raises
    ------
    MeshError
        An actor that is not of PolyData: the sentence names it.
    """
    wanted = dict(bases or {})
    titles = _bar_titles(plotter)
    bars = {address(bar) for bar in plotter.scalar_bars.values()}
    shown = {name: actor for name, actor in plotter.actors.items() if address(actor) not in bars}
    found = [_plotter_actor(name, actor, wanted.pop(name, None), titles) for name, actor in shown.items()]
    if wanted:
        raise MeshError(f"The scene has no actor '{next(iter(wanted))}'; it has {', '.join(plotter.actors)}.")
    return found


def _bar_titles(plotter: pv.Plotter) -> dict[str, str]:
    """Return the titles of the scalar bars by the address of their lookup tables."""
    return {address(bar.GetLookupTable()): str(title) for title, bar in plotter.scalar_bars.items()}


def _plotter_actor(
    name: str, actor: Any, basis: npt.ArrayLike | None, titles: dict[str, str]
) -> dict[str, Any]:
    surface = getattr(getattr(actor, "mapper", None), "dataset", None)
    if not isinstance(surface, pv.PolyData) or not isinstance(actor, pv.Actor):
        kind = type(actor).__name__ if surface is None else type(surface).__name__
        raise MeshError(
            f"The actor '{name}' is a {kind}; the view shows PolyData only (surfaces, lines, points): "
            "remove it, or give its extract_surface()."
        )
    look = actor.prop
    scalars = mapped_scalars(actor.mapper, titles) if actor.mapper.scalar_visibility else None
    return surface_actor(
        name,
        surface,
        color=look.color,
        opacity=look.opacity,
        visible=actor.visibility,
        colours=None if scalars else _mapped_colours(actor.mapper),
        scalars=scalars,
        basis=basis,
        style=look.style.lower(),
        flat=str(look.interpolation).lower().endswith("flat") and not _has_normals(surface),
        point_size=look.point_size,
        matrix=pv.array_from_vtkmatrix(actor.GetMatrix()),
        pickable=bool(actor.pickable),
        **_material(look),
    )


def _has_normals(surface: pv.PolyData) -> bool:
    return "Normals" in surface.point_data


def _material(look: Any) -> dict[str, Any]:
    if not look.lighting:
        return {"ambient": 1.0, "diffuse": 0.0, "specular": 0.0}
    return {key: float(getattr(look, key)) for key in MATERIAL}


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
