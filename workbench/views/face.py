"""The moving head of a result: skin by patches or a basis, jaw parts rigid, and overlays that show how."""

from __future__ import annotations

from typing import Any

import numpy as np
import panel as pn
import param
import pyvista.plotting

from corpus_tools.core import Mesh
from corpus_tools.mesh import PatchBinding, mesh_by_name_or_file
from corpus_tools.pipeline import Head
from workbench.state import Result
from workbench.views.head_actors import OVERLAYS, head_actors
from workbench.views.mesh_view import MeshView

__all__ = ["Face", "head_camera", "head_motion"]

# pyvista loads its names when they are first asked for, which two sessions must not do at once
assert pyvista.plotting
_NAMES = {"markers": ["markers"], "surface": ["surface", "edges"], "attachment": ["attachment"]}
GLASS = {"surface": 0.45, "attachment": 0.72}
"""Opacity of the skin over a control surface, and over lines that end below it."""
ASIDE = 0.1
"""Of a head on the page: the recorded one and the switches stand at the right."""
_VIEW_ANGLE_DEG = 20.0
_AROUND_DEG = 22.0
_ABOVE_DEG = 3.0
_OVER, _BELOW = 0.02, 0.12
"""Ground above the skull and neck below the chin, as shares of the height between."""


def head_camera(mesh: Mesh, aside: float = 0.0) -> dict[str, Any]:
    """Return a camera on the whole face, a little from the side, so that lips show in depth.

    The top of the skull has some ground above it; below the chin there is neck as far as the picture goes, so
    that where a head ends is out of sight.

    Parameters
    ----------
    mesh : Mesh
    aside : float
        How far left of the middle of the picture the head stands, as a share of its height.
    """
    skin = mesh.vertices_mm[mesh.part_mask("skin")] if "skin" in mesh.part_names else mesh.vertices_mm
    marked = mesh.vertices_mm[list(mesh.markers.values())] if mesh.markers else skin
    top, chin = float(skin[:, 1].max()), float(marked[:, 1].min())
    around, above = np.radians([_AROUND_DEG, _ABOVE_DEG])
    towards = np.array([np.sin(around) * np.cos(above), np.sin(above), np.cos(around) * np.cos(above)])
    low, high = chin - _BELOW * (top - chin), top + _OVER * (top - chin)
    middle = 0.5 * (skin.min(axis=0) + skin.max(axis=0))
    centre = np.array([middle[0], 0.5 * (low + high), 0.5 * (middle[2] + marked[:, 2].max())])
    centre += aside * (high - low) * np.array([np.cos(around), 0.0, -np.sin(around)])
    distance = 0.5 * (high - low) / np.tan(np.radians(_VIEW_ANGLE_DEG / 2))
    return {
        "position": [float(v) for v in centre + distance * towards],
        "focal_point": [float(v) for v in centre],
        "view_up": [0.0, 1.0, 0.0],
        "view_angle": _VIEW_ANGLE_DEG,
        "parallel_scale": 0.0,
    }


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
        self.mesh_view.show_actors(head_actors(mesh), camera=head_camera(mesh, ASIDE))

    def show(self, result: Result) -> None:
        """Show the head of a result and let it move."""
        self.result = result
        if result.head is not self._head:
            self._head = result.head
            mesh = result.head.mesh
            self.mesh_view.show_actors(
                head_actors(mesh, result.head.binding), camera=head_camera(mesh, ASIDE)
            )
            self._show_overlays()
        self._move()

    def _move(self) -> None:
        if self.result is None:
            return
        trajectory = self.result.trajectory
        self.mesh_view.set_motion(
            trajectory.rate_hz,
            **head_motion(self.result, self.mesh_view.actors),
            start_s=float(trajectory.times_s[0]),
        )

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


def head_motion(result: Result, actors: list[dict[str, Any]], prefix: str = "") -> dict[str, Any]:
    """Return the motion of a result's head, for :meth:`MeshView.set_motion`, for those actors that are there.

    Parameters
    ----------
    result : Result
    actors : list of dict
        Of the view.
    prefix : str
        As of :func:`workbench.views.head_actors.head_actors`.
    """
    mine = {a["name"].removeprefix(prefix): a for a in actors if a["name"].startswith(prefix)}
    shift = result.displacements_mm.astype(np.float32)
    moving = [a["name"] for a in mine.values() if a["basis"] or a["patches"]]
    rigid = {prefix + part: m for part, m in result.animation.rigid.items() if part in mine}
    return {"displacements": dict.fromkeys(moving, shift), "rigid": rigid}
