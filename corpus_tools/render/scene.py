"""A face as a pyvista scene, and pictures of it drawn off-screen."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import numpy.typing as npt
import pyvista as pv

from corpus_tools.core import FloatArray, Mesh, MissingExtraError
from corpus_tools.mesh import SkinRegion, skin_regions
from corpus_tools.render.probe import apply_window, probe_offscreen

__all__ = ["PART_STYLES", "VIEWS", "part_surface", "scene", "snapshot"]

PART_STYLES: dict[str, dict[str, Any]] = {
    "skin": {"color": "#d9a78b", "ambient": 0.18, "diffuse": 0.82, "specular": 0.16, "specular_power": 14},
    "eyes": {"color": "#f2efe9", "ambient": 0.35, "diffuse": 0.7, "specular": 0.5, "specular_power": 40},
    "upper_teeth": {"color": "#f4efe2", "ambient": 0.55, "diffuse": 0.5, "specular": 0.2},
    "lower_teeth": {"color": "#efe8d8", "ambient": 0.5, "diffuse": 0.5, "specular": 0.2},
    "tongue": {"color": "#96424b", "ambient": 0.15, "diffuse": 0.6, "specular": 0.2},
}
OTHER_STYLE: dict[str, Any] = {"color": "#c8c8c8", "ambient": 0.3, "diffuse": 0.7}
VIEWS = {"front": (0.0, 0.0), "three-quarter": (35.0, 4.0), "side": (88.0, 0.0)}
REGION_COLOURS = {
    SkinRegion.FACE: (0.851, 0.655, 0.545),
    SkinRegion.LIPS: (0.760, 0.475, 0.430),
    SkinRegion.MOUTH: (0.330, 0.130, 0.125),
}
TEETH_COLOURS = {"upper_teeth": (0.97, 0.95, 0.90), "lower_teeth": (0.94, 0.91, 0.85)}
TEETH_DEPTH_MM = 24.0
IRIS_COLOUR = (0.33, 0.24, 0.16)
SCLERA_COLOUR = (0.95, 0.93, 0.90)
BACKGROUND = "#e9ecef"


def part_surface(mesh: Mesh, part: str, vertices_mm: npt.ArrayLike | None = None) -> pv.PolyData:
    """Return one part of the mesh as PolyData with smooth normals; `vertex` has the mesh's numbers."""
    vertices = np.asarray(mesh.vertices_mm if vertices_mm is None else vertices_mm, np.float32)
    faces = mesh.faces[mesh.part_mask(part)[mesh.faces].all(axis=1)]
    used = np.unique(faces)
    renumber = np.zeros(mesh.n_vertices, np.int64)
    renumber[used] = np.arange(len(used))
    surface = pv.PolyData.from_regular_faces(vertices[used], renumber[faces])
    surface = surface.compute_normals(
        cell_normals=False, split_vertices=False, consistent_normals=False, auto_orient_normals=False
    )
    surface.point_data["vertex"] = used
    if part == "eyes":
        surface.point_data["colour"] = _eye_colours(mesh.vertices_mm[used])
    elif part in TEETH_COLOURS:
        surface.point_data["colour"] = _teeth_colours(mesh.vertices_mm[used], TEETH_COLOURS[part])
    elif part == "skin":
        surface.point_data["colour"] = _skin_colours(mesh)[used]
    return surface


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
        Height of what is shown, around the mouth; the whole face when 0.
    markers : bool
        Show the marker vertices as dots.

    Raises
    ------
    MissingExtraError
        This machine cannot draw off-screen; the sentence names the package.
    """
    status = probe_offscreen()
    if not status.ok:
        raise MissingExtraError(status.reason)
    apply_window(status)
    vertices = np.asarray(mesh.vertices_mm if vertices_mm is None else vertices_mm, float)
    plotter = pv.Plotter(off_screen=True, window_size=list(size), lighting="none")
    plotter.set_background(BACKGROUND)
    for part in mesh.part_names:
        surface = part_surface(mesh, part, vertices)
        style = dict(PART_STYLES.get(part, OTHER_STYLE))
        if "colour" in surface.point_data:
            style.pop("color")
            style |= {"scalars": "colour", "rgb": True}
        plotter.add_mesh(surface, name=part, smooth_shading=True, show_scalar_bar=False, **style)
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
    centre, height = _frame(mesh, zoom_mm)
    around, above = np.radians(view)
    direction = np.array([np.sin(around) * np.cos(above), np.sin(above), np.cos(around) * np.cos(above)])
    angle = 20.0
    distance = 0.5 * height / np.tan(np.radians(angle / 2))
    camera = plotter.camera
    camera.position = tuple(centre + distance * direction)
    camera.focal_point = tuple(centre)
    camera.up = (0.0, 1.0, 0.0)
    camera.view_angle = angle
    plotter.reset_camera_clipping_range()
    for place, strength in (((-0.5, 0.7, 1.0), 0.75), ((0.9, 0.2, 0.8), 0.35), ((0.0, -0.8, 0.6), 0.12)):
        light = pv.Light(
            position=tuple(centre + 800.0 * np.array(place)),
            focal_point=tuple(centre),
            intensity=strength,
            light_type="scene light",
        )
        plotter.add_light(light)


def _frame(mesh: Mesh, zoom_mm: float) -> tuple[FloatArray, float]:
    """Return the point to look at and the height to show, mm."""
    if zoom_mm > 0 and len(mesh.lip_pairs):
        return mesh.vertices_mm[mesh.lip_pairs.ravel()].mean(axis=0), zoom_mm
    if len(mesh.markers) >= 4:
        points = mesh.vertices_mm[list(mesh.markers.values())]
        low, high = points.min(axis=0), points.max(axis=0)
        return 0.5 * (low + high) + [0.0, 0.08 * (high[1] - low[1]), 0.0], 1.6 * float(high[1] - low[1])
    low, high = mesh.vertices_mm.min(axis=0), mesh.vertices_mm.max(axis=0)
    return 0.5 * (low + high), 1.2 * float(high[1] - low[1])


def _eye_colours(vertices: FloatArray) -> npt.NDArray[np.float32]:
    """Return white of the eye, and an iris around the foremost point of either ball."""
    colours = np.tile(np.array(SCLERA_COLOUR, np.float32), (len(vertices), 1))
    for side in (vertices[:, 0] > 0, vertices[:, 0] <= 0):
        if not side.any():
            continue
        ball = vertices[side]
        centre = 0.5 * (ball.min(axis=0) + ball.max(axis=0))
        radius = 0.5 * float(np.ptp(ball[:, 1]))
        towards = (ball - centre) / max(radius, 1e-9)
        iris = (towards[:, 2] > 0.5) & (np.hypot(towards[:, 0], towards[:, 1]) < 0.52)
        colours[np.flatnonzero(side)[iris]] = IRIS_COLOUR
    return colours


def _teeth_colours(vertices: FloatArray, colour: tuple[float, float, float]) -> npt.NDArray[np.float32]:
    """Return the colour of each tooth vertex: bright in front, in the shade of the cheeks further back."""
    depth = (vertices[:, 2].max() - vertices[:, 2]) / TEETH_DEPTH_MM
    light = np.clip(1.15 - depth, 0.18, 1.0)
    return np.asarray(light[:, None] ** np.array([1.0, 1.2, 1.3]) * np.array(colour), np.float32)


def _skin_colours(mesh: Mesh) -> npt.NDArray[np.float32]:
    """Return the colour of each vertex by region of the skin, (n_vertices, 3)."""
    table = np.array([REGION_COLOURS[region] for region in SkinRegion], np.float32)
    return np.asarray(table[skin_regions(mesh)])


def _png(picture: npt.NDArray[np.uint8]) -> bytes:
    from PIL import Image

    stream = io.BytesIO()
    Image.fromarray(picture[..., :3]).save(stream, format="PNG")
    return stream.getvalue()
