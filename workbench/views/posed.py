"""A scene of plain data at one moment, drawn off-screen: for browsers that cannot draw it themselves."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import pyvista as pv
from PIL import Image

from workbench.views.patches import patch_points

__all__ = ["PosedScene", "frame_at"]

_KEEP = 1e-3


def frame_at(motion: Mapping[str, Any], time_s: float) -> float:
    """Return the frame of a motion at a time, between two where it falls between (as the browser does)."""
    exact = min(max((time_s - motion["start"]) * motion["rate"], 0.0), motion["frames"] - 1.0)
    return float(round(exact)) if abs(exact - round(exact)) < _KEEP else exact


class PosedScene:
    """Actors as of :mod:`workbench.views.scene_actors` in a pyvista scene; used by one thread only.

    Parameters
    ----------
    actors : list of dict
    lights : list of dict
    """

    def __init__(self, actors: list[dict[str, Any]], lights: list[dict[str, Any]]) -> None:
        self._actors = {actor["name"]: actor for actor in actors}
        self._shown: dict[str, tuple[Any, pv.PolyData]] = {}
        self.plotter = pv.Plotter(off_screen=True, lighting="none")
        for actor in actors:
            self._add(actor)
        for light in lights:
            direction = tuple(light["direction"])
            made = pv.Light(position=direction, light_type="camera light" if light["eye"] else "scene light")
            made.diffuse_color = light["colour"]
            made.specular_color = light["colour"]
            self.plotter.add_light(made)

    def _add(self, actor: dict[str, Any]) -> None:
        points = np.frombuffer(actor["points"], np.float32).reshape(-1, 3).copy()
        surface = _surface(actor, points)
        ambient, diffuse, specular, power = actor["material"]
        style: dict[str, Any] = {"color": actor["colour"], "opacity": actor["opacity"]}
        if actor["scalars"]:
            style |= _scalars(surface, actor["scalars"])
        elif actor["colours"]:
            surface["rgba"] = np.frombuffer(actor["colours"], np.uint8).reshape(-1, 4)
            style = {"scalars": "rgba", "rgb": True, "opacity": actor["opacity"]}
        added = self.plotter.add_mesh(
            surface,
            name=actor["name"],
            ambient=ambient,
            diffuse=diffuse,
            specular=specular,
            specular_power=max(power, 1.0),
            smooth_shading=actor["kind"] == "surface",
            point_size=actor["size"],
            render_points_as_spheres=True,
            lighting=actor["kind"] != "lines",
            reset_camera=False,
            **style,
        )
        self._shown[actor["name"]] = (added, added.mapper.dataset)

    def pose(self, actors: list[dict[str, Any]], motion: Mapping[str, Any], time_s: float) -> None:
        """Put every actor where it is at a time, and show or hide it."""
        for actor in actors:
            added, _ = self._shown[actor["name"]]
            added.visibility = actor["visible"]
            added.prop.opacity = actor["opacity"]
            added.user_matrix = _matrix(actor["matrix"])
        if not motion:
            return
        frame = frame_at(motion, time_s)
        for track in motion["tracks"]:
            row = _between(np.frombuffer(track["values"], np.float32), motion["frames"], frame)
            for name in track["actors"]:
                if self._actors[name]["visible"]:
                    self._move(self._actors[name], track["kind"], row)

    def _move(self, actor: dict[str, Any], kind: str, row: npt.NDArray[np.float32]) -> None:
        added, surface = self._shown[actor["name"]]
        if kind == "rigid":
            place = np.eye(4) if actor["matrix"] is None else _matrix(actor["matrix"])
            added.user_matrix = place @ row.reshape(4, 4).T
            return
        points = row.reshape(-1, 3) if kind == "points" else self._deformed(actor, row.reshape(-1, 3))
        surface.points = points.astype(np.float32)
        if actor["kind"] == "surface":
            fresh = surface.compute_normals(
                cell_normals=False, split_vertices=False, consistent_normals=False, auto_orient_normals=False
            )
            surface.point_data.active_normals = fresh.point_data["Normals"]

    def _deformed(self, actor: dict[str, Any], shift: npt.NDArray[np.float32]) -> npt.NDArray[np.float64]:
        rest = np.frombuffer(actor["points"], np.float32).reshape(-1, 3).astype(float)
        if actor["basis"]:
            return np.asarray(rest + np.frombuffer(actor["basis"], np.float32).reshape(len(rest), -1) @ shift)
        patches = actor["patches"]
        return patch_points(
            rest,
            self._actors[patches["of"]]["patches"] if "of" in patches else patches,
            patches["attached"],
            shift,
        )

    def picture(self, camera: Mapping[str, Any], ground: str, size: tuple[int, int]) -> bytes:
        """Draw and return a JPEG."""
        plotter = self.plotter
        plotter.window_size = list(size)
        plotter.set_background(ground)
        plotter.camera_position = [camera["position"], camera["focal_point"], camera["view_up"]]
        plotter.camera.view_angle = camera["view_angle"]
        plotter.camera.parallel_projection = bool(camera["parallel_scale"])
        if camera["parallel_scale"]:
            plotter.camera.parallel_scale = camera["parallel_scale"]
        plotter.reset_camera_clipping_range()
        drawn = plotter.screenshot(return_img=True)
        out = io.BytesIO()
        Image.fromarray(np.asarray(drawn)[..., :3]).save(out, "JPEG", quality=88)
        return out.getvalue()

    def home(self) -> dict[str, Any]:
        """Return a camera that sees everything from the front."""
        from workbench.views.plotter_scene import camera_of

        self.plotter.view_xy()
        return camera_of(self.plotter)

    def close(self) -> None:
        """Give the window back."""
        self.plotter.close()


def _surface(actor: dict[str, Any], points: npt.NDArray[np.float32]) -> pv.PolyData:
    cells = np.frombuffer(actor["cells"], np.uint32).astype(np.int64)
    if actor["kind"] == "surface":
        return pv.PolyData.from_regular_faces(points, cells.reshape(-1, 3))
    if actor["kind"] == "lines":
        pairs = cells.reshape(-1, 2)
        return pv.PolyData(points, lines=np.column_stack([np.full(len(pairs), 2), pairs]).ravel())
    return pv.PolyData(points)


def _scalars(surface: pv.PolyData, scalars: Mapping[str, Any]) -> dict[str, Any]:
    """Return how pyvista colours by the same numbers, with the same table and a bar."""
    rgba = np.frombuffer(scalars["table"], np.uint8).reshape(-1, 4)
    table = pv.LookupTable(values=rgba[1:-2])
    table.below_range_color, table.above_range_color = tuple(rgba[0]), tuple(rgba[-2])
    table.nan_color = tuple(rgba[-1])
    table.scalar_range = tuple(scalars["range"])
    surface["scalars"] = np.frombuffer(scalars["values"], np.float32)
    bar = {"title": scalars["title"] + (", log10" if scalars["log"] else ""), "color": "#4b5560"}
    return {"scalars": "scalars", "cmap": table, "show_scalar_bar": scalars["legend"], "scalar_bar_args": bar}


def _matrix(columns: list[float] | None) -> npt.NDArray[np.float64]:
    return np.eye(4) if columns is None else np.reshape(columns, (4, 4)).T


def _between(values: npt.NDArray[np.float32], frames: int, frame: float) -> npt.NDArray[np.float32]:
    rows = values.reshape(frames, -1)
    first = int(frame)
    share = frame - first
    if share == 0:
        return rows[first]
    return np.asarray((1 - share) * rows[first] + share * rows[first + 1], np.float32)
