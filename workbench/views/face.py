"""The moving head of a result: skin by patches or a basis, jaw parts rigid, and overlays that show how."""

from __future__ import annotations

from typing import Any

import panel as pn
import param
import pyvista.plotting

from corpus_tools.mesh import PatchBinding, mesh_by_name_or_file
from corpus_tools.pipeline import Head
from workbench.state import Result
from workbench.views.cameras import distance, head_camera
from workbench.views.cast import cast_camera, cast_places, cast_prefix
from workbench.views.head_actors import OVERLAYS, head_actors
from workbench.views.mesh_view import ZOOM_LIMITS, MeshView
from workbench.views.speaking_head import head_motion

__all__ = ["Face"]

# pyvista loads its names when they are first asked for, which two sessions must not do at once
assert pyvista.plotting
_NAMES = {"markers": ["markers"], "surface": ["surface", "edges"], "attachment": ["attachment"]}
GLASS = {"surface": 0.45, "attachment": 0.72}
"""Opacity of the skin over a control surface, and over lines that end below it."""
ASIDE = 0.1
"""Of a head on the page: the recorded one and the switches stand at the right."""


class Face(pn.viewable.Viewer):
    """A :class:`MeshView` that shows results; a change of g(u) sends marker displacements only.

    Parameters
    ----------
    clock : str
        Id of the clock.
    theme : str
        "light" or "dark".
    """

    show_markers = param.Boolean(default=False, doc="The markers, as dots.")
    show_surface = param.Boolean(default=False, doc="The control surface under a translucent skin.")
    show_attachment = param.Boolean(default=False, doc="Lines from the vertices to the patches they hang on.")

    def __init__(self, clock: str, theme: str, **params: Any) -> None:
        super().__init__(**params)
        self._head: Head | None = None
        self._cast: tuple[Result, ...] = ()
        self.result: Result | None = None
        self.mesh_view = MeshView(session=clock, theme=theme, description="Talking head")
        self.view = self.mesh_view
        self.param.watch(self._overlay, [f"show_{what}" for what in OVERLAYS])

    @property
    def theme(self) -> str:
        """Theme of the ground behind the head."""
        return str(self.mesh_view.theme)

    @theme.setter
    def theme(self, theme: str) -> None:
        self.mesh_view.theme = theme

    @property
    def has_surface(self) -> bool:
        """Whether the head on show has a control surface: it is moved by patches."""
        return self._head is not None and isinstance(self._head.binding, PatchBinding)

    def show_rest(self, name: str) -> None:
        """Show a head by name at rest, before there is anything that moves it."""
        mesh = mesh_by_name_or_file(name)
        self.result = self._head = None
        self._look(head_camera(mesh, ASIDE), ZOOM_LIMITS)
        self.mesh_view.show_actors(head_actors(mesh), camera=self.mesh_view.home)

    def show(self, result: Result) -> None:
        """Show the head of a result and let it move."""
        self.result = result
        if result.head is not self._head:
            self._head = result.head
            self._build()
        self._move()

    def show_cast(self, results: tuple[Result, ...]) -> None:
        """Show other heads beside the first, each with a result of its own; none: the first alone."""
        before, self._cast = self._cast, results
        if self._head is None:
            return
        if [r.head for r in before] != [r.head for r in results]:
            self._build()
        self._move()

    def _build(self) -> None:
        """Show the heads at rest; their motion follows."""
        assert self._head is not None
        meshes = [self._head.mesh, *(r.head.mesh for r in self._cast)]
        actors = head_actors(meshes[0], self._head.binding)
        for other, place in zip(self._cast, cast_places(meshes)[1:], strict=True):
            mesh, binding = other.head.mesh, other.head.binding
            actors += head_actors(mesh, binding, prefix=cast_prefix(mesh.name), matrix=place)
        one = head_camera(meshes[0], ASIDE)
        camera, (nearest, farthest) = cast_camera(meshes) if self._cast else one, ZOOM_LIMITS
        self._look(camera, (nearest * distance(one) / distance(camera), farthest))
        self.mesh_view.show_actors(actors, camera=camera)
        self._show_overlays()

    def _look(self, home: dict[str, Any], limits: tuple[float, float]) -> None:
        """Take the camera that a reset goes back to."""
        self.mesh_view.param.update(home=home, zoom_limits=limits)

    def _move(self) -> None:
        if self.result is None:
            return
        trajectory = self.result.trajectory
        own = [a for a in self.mesh_view.actors if "/" not in a["name"]]
        motion = head_motion(self.result.head, self.result.animation, own)
        for other in self._cast:
            if other.request.same_target(self.result.request):  # else it rests
                prefix = cast_prefix(other.head.mesh.name)
                theirs = head_motion(other.head, other.animation, self.mesh_view.actors, prefix)
                for what, values in theirs.items():
                    motion[what].update(values)
        self.mesh_view.set_motion(trajectory.rate_hz, **motion, start_s=float(trajectory.times_s[0]))

    def _overlay(self, *events: Any) -> None:
        if self._show_overlays():
            self._move()

    def _show_overlays(self) -> bool:
        """Show and hide what is shown over the head; say whether actors were added."""
        if self._head is None:
            return False
        actors, added = {a["name"]: a for a in self.mesh_view.actors}, False
        carrier = next((name for name, a in actors.items() if a["patches"]), "")
        for what, make in OVERLAYS.items():
            wanted = bool(getattr(self, f"show_{what}"))
            mine = make(self._head.binding, carrier) if wanted else []
            fresh = [a for a in mine if a["name"] not in actors]
            added = added or bool(fresh)
            if fresh:
                self.mesh_view.add_actors(fresh)
            for name in _NAMES[what]:
                if name in actors:
                    self.mesh_view.set_style(name, visible=wanted)
        if carrier:
            glass = [opacity for what, opacity in GLASS.items() if getattr(self, f"show_{what}")]
            self.mesh_view.set_style(carrier, opacity=min(glass, default=1.0))
        return added

    def __panel__(self) -> Any:
        return self.mesh_view
