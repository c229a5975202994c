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
from workbench.views.motion_data import motion_data
from workbench.views.plotter_scene import camera_of, lights_of, plotter_actors
from workbench.views.scalars import scalar_colours
from workbench.views.scene_actors import DEFAULT_LIGHTS
from workbench.views.stills import Stills
from workbench.views.theme import palettes, style_sheet

__all__ = ["MeshView"]

ZOOM_LIMITS = (0.2, 2.6)
"""Our choice, for a camera on a face: nearest a mouth fills the view, farthest a head a third."""


class MeshView(pn.custom.JSComponent):
    """Surfaces, lines and points of a scene; drag turns, shift-drag pans, the wheel comes nearer.

    A click picks: `picked` says what is under the pointer. 0, R and a double click on the ground reset the
    camera.

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
    home = param.Dict(default={}, doc="The camera of a reset; empty: the one that was set last from Python.")
    zoom_limits = param.NumericTuple(
        default=ZOOM_LIMITS,
        length=2,
        doc="How near and how far the wheel goes, as shares of the distance of the camera of a reset.",
    )
    wheel_needs_ctrl = param.Boolean(
        default=False, doc="The wheel zooms with Ctrl only, and scrolls the page without."
    )
    motion = param.Dict(default={})
    theme = param.Selector(default="light", objects=list(THEMES))
    palettes = param.Dict(default={})
    ground = param.String(default="", doc="Colour behind the scene, #rrggbb; that of the theme when empty.")
    session = param.String(default="default", doc="Id of the clock.")
    description = param.String(default="3-D view of a head", doc="What a screen reader says.")
    unavailable = param.String(default="", doc="Why the browser cannot show the view; empty when it can.")
    picked = param.Dict(
        default={}, doc="What was clicked: name, index, label, position, value; empty: nothing."
    )
    hover = param.Boolean(default=False, doc="Set `hovered` while the pointer moves.")
    hovered = param.Dict(default={}, doc="What is under the pointer, as of `picked`.")
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
        self._told: dict[tuple[str, str], dict[str, Any]] = {}
        self._stills: Stills | None = None
        super().__init__(**{"sizing_mode": "stretch_both", "palettes": palettes(), **params})
        if scene is not None:
            self.show_scene(scene, bases)

    @property
    def line(self) -> LatestWins:
        """What is on its way to the browser, and what waits."""
        return self._line

    @property
    def dropped(self) -> int:
        """Changes that a later one replaced before they were sent."""
        return self._line.dropped

    def show_scene(self, scene: pv.Plotter, bases: Mapping[str, npt.ArrayLike] | None = None) -> None:
        """Show a pyvista scene: its actors, lights and camera.

        Raises
        ------
        MeshError
            An actor that is not of PolyData; the sentence names it.
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
        _check_names(actors)
        self._told.clear()
        changes: dict[str, Any] = {"actors": actors, "motion": {}, "revision": self.revision + 1}
        if lights is not None:
            changes["lights"] = lights
        if camera is not None:
            changes["camera"] = dict(camera)
        self.param.update(**changes)

    def add_actors(self, actors: list[dict[str, Any]]) -> None:
        """Show more actors beside those that are there, whose motion goes on."""
        _check_names([*self.actors, *actors])
        self.actors.extend(actors)
        for actor in actors:
            self._tell("add", actor["name"], actors=[actor])

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
        for name in {**(displacements or {}), **(rigid or {}), **(points or {})}:
            self.actor(name)
        actors = {actor["name"]: actor for actor in self.actors}
        self._line.offer("motion", motion_data(actors, rate_hz, displacements, rigid, points, start_s))

    def push_points(self, name: str, positions: npt.ArrayLike) -> None:
        """Show other positions of an actor's points, (n_points, 3); later ones replace those that wait."""
        points = np.ascontiguousarray(positions, np.float32)
        if points.shape != (len(self.actor(name)["points"]) // 12, 3):
            raise MeshError(f"The points of '{name}' have shape {points.shape}.")
        self._line.offer(f"points {name}", {"points": points.tobytes()})

    def set_scalars(self, name: str, values: npt.ArrayLike | None, **options: Any) -> None:
        """Colour an actor by numbers; later ones replace those that wait.

        Parameters
        ----------
        name : str
        values : (n_points,) or a value for every id of the actor, optional
            None: its own colours again.
        **options
            cmap, clim, title and so on, as of :func:`workbench.views.scalars.scalar_colours`.

        Raises
        ------
        MeshError
            There is no such actor, or it has another number of points.
        """
        actor = self.actor(name)
        if values is None:
            self._line.offer(f"scalars {name}", {"scalars": None})
            return
        row = np.asarray(values, np.float32)
        n_points, ids = len(actor["points"]) // 12, np.frombuffer(actor["ids"], np.uint32)
        if len(row) != n_points and len(ids) and len(row) > ids.max():
            row = row[ids]
        if row.shape != (n_points,):
            raise MeshError(f"The scalars of '{name}' have shape {row.shape}; ({n_points},) was expected.")
        self._line.offer(f"scalars {name}", {"scalars": scalar_colours(row, **options)})

    def set_style(self, name: str, *, visible: bool | None = None, opacity: float | None = None) -> None:
        """Show or hide an actor, or make it translucent."""
        given = {"visible": visible, "opacity": opacity}
        values = {key: value for key, value in given.items() if value is not None}
        self.actor(name)
        for actor in self.actors:
            if actor["name"] == name:
                actor.update(values)
        before = self._told.get(("style", name), {}).get("values", {})
        self._tell("style", name, values={**before, **values})

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
        kind, _, name = key.partition(" ")
        self._tell(kind, name, n=number, **change)

    def _tell(self, kind: str, name: str, **values: Any) -> None:
        """Send a change of an actor, and keep it for whoever renders the view later, or in its place."""
        for actor in self.actors:
            if actor["name"] == name:
                actor.update({key: values[key] for key in ("points", "scalars") if key in values})
        self._told[kind, name] = message = {"type": kind, "actor": name, **values}
        self._send_msg(message)

    def _handle_msg(self, data: Any) -> None:
        if data["type"] == "ack":
            self.acknowledged = int(data["n"])
            self._line.acknowledge(self.acknowledged)
        elif data["type"] == "ready":
            self.unavailable = ""
            for message in self._told.values():
                self._send_msg(message)
            self._line.ready()
        elif data["type"] == "pick":
            self.param.update(**{data["what"]: self._named(data["found"])})
        elif data["type"] == "unavailable":
            self.unavailable = str(data["reason"])
        elif data["type"] == "moment":
            self._draw_for(data)
        elif data["type"] == "gone" and self._stills is not None:
            self._stills.close()
            self._stills = None

    def _draw_for(self, moment: Any) -> None:
        """Draw a picture for a browser that cannot, and send it when it is there."""
        self._stills = self._stills or Stills()
        scene = {key: getattr(self, key) for key in ("lights", "motion", "camera", "revision")}
        scene["actors"] = [dict(actor) for actor in self.actors]
        scene["ground"] = self.ground or self.palettes[self.theme]["view"]
        doc = pn.state.curdoc

        def reply(**answer: Any) -> None:
            def send() -> None:
                self._send_msg({"type": "picture", **answer})

            if doc is not None and doc.session_context:
                doc.add_next_tick_callback(send)
            else:
                send()

        self._stills.ask(scene, moment, reply)

    def _named(self, found: Any) -> dict[str, Any]:
        """Return what was picked, with the number and the label that the actor gives its points."""
        if not found or found["name"] not in (actor["name"] for actor in self.actors):
            return {}
        actor, row = self.actor(found["name"]), int(found["index"])
        ids = np.frombuffer(actor["ids"], np.uint32)
        value = found.get("value")
        return {
            "name": found["name"],
            "index": int(ids[row]) if len(ids) else row,
            "label": actor["labels"][row] if row < len(actor["labels"]) else "",
            "position": [float(v) for v in found["position"]],
            "value": None if value is None else float(value),
        }


def _check_names(actors: list[dict[str, Any]]) -> None:
    names = [actor["name"] for actor in actors]
    if len(set(names)) < len(names):
        raise MeshError(f"Two actors are called '{next(n for n in names if names.count(n) > 1)}'.")
