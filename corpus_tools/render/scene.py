"""A face as a pyvista scene, and pictures of it drawn off-screen."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from corpus_tools.core import FloatArray, Mesh, MissingExtraError
from corpus_tools.mesh import with_level_neck
from corpus_tools.render.probe import apply_window, probe_offscreen
from corpus_tools.render.surfaces import part_surface

if TYPE_CHECKING:
    import pyvista as pv

__all__ = ["PART_STYLES", "VIEWS", "scene", "snapshot"]

PART_STYLES: dict[str, dict[str, Any]] = {
    "skin": {"color": "#dcae96", "ambient": 0.34, "diffuse": 0.72, "specular": 0.12, "specular_power": 16},
    "eyes": {"color": "#f2efe9", "ambient": 0.35, "diffuse": 0.7, "specular": 0.5, "specular_power": 40},
    "upper_teeth": {"color": "#f4efe2", "ambient": 0.55, "diffuse": 0.5, "specular": 0.2},
    "lower_teeth": {"color": "#efe8d8", "ambient": 0.5, "diffuse": 0.5, "specular": 0.2},
    "tongue": {"color": "#96424b", "ambient": 0.15, "diffuse": 0.6, "specular": 0.2},
}
OTHER_STYLE: dict[str, Any] = {"color": "#c8c8c8", "ambient": 0.3, "diffuse": 0.7}
VIEWS = {"front": (0.0, 0.0), "three-quarter": (35.0, 4.0), "side": (88.0, 0.0)}
BACKGROUND = "#e9ecef"
VIEW_ANGLE_DEG = 20.0
OVER, BELOW = 0.04, 0.13
"""Ground above the crown, and below the chin at rest, as shares of the picture's height (our choice: an open
jaw stays inside, and where a neck ends is out of sight)."""


def scene(
    mesh: Mesh,
    vertices_mm: npt.ArrayLike | None = None,
    *,
    view: str = "front",
    size: tuple[int, int] = (480, 560),
    zoom_mm: float = 0.0,
    markers: bool = False,
) -> pv.Plotter:
    """Return an off-screen plotter with one actor a part, lights and a camera on the face.

    Parameters
    ----------
    mesh : Mesh
    vertices_mm : (n_vertices, 3), mm, optional
        A frame of the deformed mesh; the rest pose when not given.
    view : str
        One of :data:`VIEWS`: front, three-quarter, side.
    size : (int, int)
        Width and height, pixels.
    zoom_mm : float, mm
        Height of what is shown, around the mouth; from above the crown to below the chin when 0.
    markers : bool
        Show the marker vertices as dots.

    Raises
    ------
    MissingExtraError
        This machine cannot draw off-screen; the sentence names the package.
    """
    import pyvista as pv

    status = probe_offscreen()
    if not status.ok:
        raise MissingExtraError(status.reason)
    apply_window(status)
    vertices = with_level_neck(mesh, mesh.vertices_mm if vertices_mm is None else vertices_mm)
    plotter = pv.Plotter(off_screen=True, window_size=list(size), lighting="none")
    plotter.set_background(BACKGROUND)
    for part in mesh.part_names:
        surface = part_surface(mesh, part, vertices)
        style = dict(PART_STYLES.get(part, OTHER_STYLE))
        if "colour" in surface.point_data:
            style.pop("color")
            style |= {"scalars": "colour", "rgb": True}
        actor = plotter.add_mesh(surface, name=part, smooth_shading=False, show_scalar_bar=False, **style)
        actor.prop.interpolation = "Phong"  # with the normals of the surface
    if markers and mesh.markers:
        points = vertices[list(mesh.markers.values())]
        plotter.add_points(
            points, name="markers", color="#1f6feb", point_size=6, render_points_as_spheres=True
        )
    _light_and_aim(plotter, mesh, VIEWS[view], zoom_mm)
    return plotter


def snapshot(mesh: Mesh, vertices_mm: npt.ArrayLike | None = None, **options: Any) -> bytes:
    """Draw one frame and return it as PNG bytes; `options` as for :func:`scene`."""
    plotter = scene(mesh, vertices_mm, **options)
    try:
        picture = plotter.screenshot(return_img=True)
    finally:
        plotter.close()
    return _png(np.asarray(picture))


def _light_and_aim(plotter: pv.Plotter, mesh: Mesh, view: tuple[float, float], zoom_mm: float) -> None:
    """Put the camera before the face, from the rest pose so that it does not shake; three lights."""
    import pyvista as pv

    around, above = np.radians(view)
    direction = np.array([np.sin(around) * np.cos(above), np.sin(above), np.cos(around) * np.cos(above)])
    centre, distance = _stand(mesh, zoom_mm, direction)
    camera = plotter.camera
    camera.position = tuple(centre + distance * direction)
    camera.focal_point = tuple(centre)
    camera.up = (0.0, 1.0, 0.0)
    camera.view_angle = VIEW_ANGLE_DEG
    plotter.reset_camera_clipping_range()
    for place, strength in (((-0.5, 0.7, 1.0), 0.75), ((0.9, 0.2, 0.8), 0.35), ((0.0, -0.8, 0.6), 0.12)):
        light = pv.Light(
            position=tuple(centre + 800.0 * np.array(place)),
            focal_point=tuple(centre),
            intensity=strength,
            light_type="scene light",
        )
        plotter.add_light(light)


def _stand(mesh: Mesh, zoom_mm: float, direction: FloatArray) -> tuple[FloatArray, float]:
    """Return the point to look at, mm, and how far from it the camera stands, mm."""
    half = float(np.tan(np.radians(VIEW_ANGLE_DEG / 2)))
    if zoom_mm > 0 and len(mesh.lip_pairs):
        return mesh.vertices_mm[mesh.lip_pairs.ravel()].mean(axis=0), 0.5 * zoom_mm / half
    skin = mesh.vertices_mm[mesh.part_mask("skin")] if "skin" in mesh.part_names else mesh.vertices_mm
    marked = mesh.vertices_mm[list(mesh.markers.values())] if len(mesh.markers) >= 4 else skin
    head = skin[skin[:, 1] >= marked[:, 1].min()]
    centre = 0.5 * (head.min(axis=0) + head.max(axis=0))
    up = np.array([0.0, 1.0, 0.0]) - direction[1] * direction
    up /= np.linalg.norm(up)
    # nothing of the head may be higher in the picture than `over`, and no marker lower than `under`, in the
    # perspective of a camera at `distance` that is raised by `rise`: two bounds that are linear in both
    over, under = half * (1 - 2 * OVER), half * (1 - 2 * BELOW)
    top = float(((head - centre) @ (up + over * direction)).max())
    low = float(((marked - centre) @ (under * direction - up)).max())
    distance = (top + low) / (over + under)
    return np.asarray(centre + (top - over * distance) * up), distance


def _png(picture: npt.NDArray[np.uint8]) -> bytes:
    from PIL import Image

    stream = io.BytesIO()
    Image.fromarray(picture[..., :3]).save(stream, format="PNG")
    return stream.getvalue()
