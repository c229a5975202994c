"""A pyvista scene drawn in the browser by WebGL2, with motion that follows the clock without the server."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt
import panel as pn
import param
import pyvista as pv

from corpus_tools.core import MeshError
from workbench.state import THEMES
from workbench.views.esm import esm
from workbench.views.latest import LatestWins
from workbench.views.scene_actors import DEFAULT_LIGHTS, camera_of, lights_of, plotter_actors
from workbench.views.theme import palettes, style_sheet

__all__ = ["MeshView"]


class MeshView(pn.custom.JSComponent):
    """Surfaces and points of a scene; drag turns, shift-drag pans, the wheel comes nearer, R resets.

    Parameters
    ----------
    scene : pv.Plotter, optional
        Its actors, lights and camera are taken over (:meth:`show_scene`).
    bases : mapping of actor name -> (n_vertices, k), optional
        Actors that deform linearly with k markers: vertices = rest + basis @ displacement.

    Notes
    -----
    Motion (:meth:`set_motion`) is sent whole and played on the clock `session` without further traffic.
    Motion and pushed points share one line to the browser: a change leaves when the one before has been
    painted, and of those that wait the latest wins. Call the methods where the session's parameters may be
    set.
    """

    actors = param.List(default=[], doc="Actors as of workbench.views.scene_actors.")
    lights = param.List(default=DEFAULT_LIGHTS)
    revision = param.Integer(default=0, doc="Grows with every new set of actors.")
    camera = param.Dict(default={}, doc="As of scene_actors.camera_of; empty: all actors from the front.")
    motion = param.Dict(default={})
    theme = param.Selector(default="light", objects=list(THEMES))
    palettes = param.Dict(default={})
    ground = param.String(default="", doc="Colour behind the scene, #rrggbb; that of the theme when empty.")
    session = param.String(default="default", doc="Id of the clock.")
    description = param.String(default="3-D view of a head", doc="What a screen reader says.")
    unavailable = param.String(default="", doc="Why the browser cannot show the view; empty when it can.")
    acknowledged = param.Integer(default=0, doc="Number of the last change that was painted.")

    _esm = esm("mesh", "renderMesh")
    _stylesheets: ClassVar[list[Any]] = [style_sheet()]

    def __init__(
        self,
        scene: pv.Plotter | None = None,
        bases: Mapping[str, npt.ArrayLike] | None = None,
        **params: Any,
    ) -> None:
        self._line = LatestWins(self._deliver)
        self._pushed: dict[str, bytes] = {}
        super().__init__(**{"sizing_mode": "stretch_both", "palettes": palettes(), **params})
        if scene is not None:
            self.show_scene(scene, bases)

    @property
    def dropped(self) -> int:
        """Changes that a later one replaced before they were sent."""
        return self._line.dropped

    def show_scene(self, scene: pv.Plotter, bases: Mapping[str, npt.ArrayLike] | None = None) -> None:
        """Show a pyvista scene: its actors, lights and camera.

        Raises
        ------
        MeshError
            An actor that is no PolyData; the sentence names it.
        """
        self.show_actors(plotter_actors(scene, bases), lights_of(scene), camera_of(scene))

    def show_actors(
        self,
        actors: list[dict[str, Any]],
        lights: list[dict[str, Any]] | None = None,
        camera: Mapping[str, Any] | None = None,
    ) -> None:
        """Show actors made by :func:`workbench.views.scene_actors.surface_actor`; motion ends.

        `lights` and `camera` stay as they are when not given.
        """
        names = [actor["name"] for actor in actors]
        if len(set(names)) < len(names):
            raise MeshError(f"Two actors are called '{next(n for n in names if names.count(n) > 1)}'.")
        self._pushed.clear()
        changes: dict[str, Any] = {"actors": actors, "motion": {}, "revision": self.revision + 1}
        if lights is not None:
            changes["lights"] = lights
        if camera is not None:
            changes["camera"] = dict(camera)
        self.param.update(**changes)

    def actor(self, name: str) -> dict[str, Any]:
        """Return an actor by name.

        Raises
        ------
        MeshError
            There is none; the sentence lists those that are.
        """
        for actor in self.actors:
            if actor["name"] == name:
                return dict(actor)
        raise MeshError(
            f"The view has no actor '{name}'; it has {', '.join(a['name'] for a in self.actors)}."
        )

    def set_motion(
        self,
        rate_hz: float,
        *,
        displacements: Mapping[str, npt.ArrayLike] | None = None,
        rigid: Mapping[str, npt.ArrayLike] | None = None,
        points: Mapping[str, npt.ArrayLike] | None = None,
        start_s: float = 0.0,
    ) -> None:
        """Let actors move with the clock; replaces all motion before it.

        Parameters
        ----------
        rate_hz : float
        displacements : mapping of actor -> (n_frames, k, 3)
            Of the markers of a deforming actor, from rest.
        rigid : mapping of actor -> (n_frames, 4, 4)
            Matrices for column vectors.
        points : mapping of actor -> (n_frames, n_points, 3)
            Positions of all its points.
        start_s : float, s
            Time of the first frame.

        Raises
        ------
        MeshError
            An actor is not there, its numbers do not fit, or the actors differ in their number of frames.
        """
        tracks: dict[str, dict[str, npt.NDArray[np.float32]]] = {
            "deform": {n: self._track(n, v, "basis") for n, v in (displacements or {}).items()},
            "rigid": {n: _matrices(n, v) for n, v in (rigid or {}).items() if self.actor(n)},
            "points": {n: self._track(n, v, "points") for n, v in (points or {}).items()},
        }
        frames = {len(values) for group in tracks.values() for values in group.values()}
        if len(frames) != 1 or not all(frames):
            raise MeshError(
                f"All motion must have one number of frames, at least 1; it has {sorted(frames)}."
            )
        sent = {kind: {n: v.tobytes() for n, v in group.items()} for kind, group in tracks.items()}
        self._line.offer(
            "motion", {"rate": float(rate_hz), "start": float(start_s), "frames": frames.pop(), **sent}
        )

    def _track(self, name: str, values: npt.ArrayLike, part: str) -> npt.NDArray[np.float32]:
        actor = self.actor(name)
        n_points = len(actor["points"]) // 12
        rows = len(actor["basis"]) // (4 * n_points) if part == "basis" else n_points
        track = np.ascontiguousarray(values, np.float32)
        if track.ndim != 3 or track.shape[1:] != (rows, 3) or not rows:
            what = f"(frames, {rows}, 3) was expected" if rows else "it has no basis"
            raise MeshError(f"The motion of '{name}' has shape {track.shape}; {what}.")
        return track

    def push_points(self, name: str, positions: npt.ArrayLike) -> None:
        """Show other positions of an actor's points, (n_points, 3); later ones replace those that wait."""
        points = np.ascontiguousarray(positions, np.float32)
        if points.shape != (len(self.actor(name)["points"]) // 12, 3):
            raise MeshError(f"The points of '{name}' have shape {points.shape}.")
        self._line.offer(f"points {name}", points.tobytes())

    def set_style(self, name: str, *, visible: bool | None = None, opacity: float | None = None) -> None:
        """Show or hide an actor, or make it translucent."""
        given = {"visible": visible, "opacity": opacity}
        values = {key: value for key, value in given.items() if value is not None}
        self.actor(name)
        for actor in self.actors:
            if actor["name"] == name:
                actor.update(values)
        self._send_msg({"type": "style", "actor": name, "values": values})

    def camera_from(self, plotter: pv.Plotter) -> None:
        """Look as a pyvista scene does."""
        self.camera = camera_of(plotter)

    def camera_to(self, plotter: pv.Plotter) -> None:
        """Let a pyvista scene look as this view does."""
        camera = self.camera
        if not camera:
            plotter.view_xy()
            return
        plotter.camera_position = [camera["position"], camera["focal_point"], camera["view_up"]]
        plotter.camera.view_angle = camera["view_angle"]
        plotter.camera.parallel_projection = bool(camera["parallel_scale"])
        if camera["parallel_scale"]:
            plotter.camera.parallel_scale = camera["parallel_scale"]
        plotter.reset_camera_clipping_range()

    def reset_camera(self) -> None:
        """Back to the camera that was set last, or to all actors from the front."""
        self._send_msg({"type": "reset_camera"})

    def _deliver(self, number: int, key: str, change: Any) -> None:
        if key == "motion":
            self.motion = {**change, "n": number}
            return
        name = key.removeprefix("points ")
        self._pushed[name] = change
        self._send_msg({"type": "points", "n": number, "actor": name, "points": change})

    def _handle_msg(self, data: Any) -> None:
        if data["type"] == "ack":
            self.acknowledged = int(data["n"])
            self._line.acknowledge(self.acknowledged)
        elif data["type"] == "ready":
            self.unavailable = ""
            for name, points in self._pushed.items():
                self._send_msg({"type": "points", "n": self._line.number, "actor": name, "points": points})
            self._line.ready()
        elif data["type"] == "unavailable":
            self.unavailable = str(data["reason"])


def _matrices(name: str, values: npt.ArrayLike) -> npt.NDArray[np.float32]:
    """Return matrices column by column, (n_frames, 16)."""
    matrices = np.asarray(values, np.float32)
    if matrices.ndim != 3 or matrices.shape[1:] != (4, 4):
        raise MeshError(f"The matrices of '{name}' have shape {matrices.shape}; (frames, 4, 4) was expected.")
    return np.ascontiguousarray(matrices.transpose(0, 2, 1)).reshape(len(matrices), 16)
