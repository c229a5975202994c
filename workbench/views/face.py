"""The moving head of a result: parts as pyvista surfaces, skin by the deformer's basis, jaw parts rigid."""

from __future__ import annotations

from typing import Any

import numpy as np
import panel as pn
import pyvista.plotting

from corpus_tools.core import Mesh
from corpus_tools.mesh import Binding, mesh_by_name_or_file
from corpus_tools.pipeline import Head
from corpus_tools.render import PART_STYLES, part_surface
from workbench.state import Result
from workbench.views.mesh_view import MeshView
from workbench.views.scene_actors import surface_actor

__all__ = ["Face", "head_actors", "head_camera"]

# pyvista loads its names when they are first asked for, which two sessions must not do at once
assert pyvista.plotting
_OTHER = {"color": "#c8c8c8", "ambient": 0.3, "diffuse": 0.7}
_VIEW_ANGLE_DEG = 20.0
_AROUND_DEG = 22.0
_ABOVE_DEG = 3.0


def head_actors(mesh: Mesh, binding: Binding | None = None) -> list[dict[str, Any]]:
    """Return one actor for every part of a mesh; those that a binding moves carry their rows of its basis."""
    found = []
    for part in mesh.part_names:
        surface = part_surface(mesh, part)
        basis = np.zeros(0)
        if binding is not None:
            basis = binding.response(np.asarray(surface.point_data["vertex"]))
        style: dict[str, Any] = dict(PART_STYLES.get(part, _OTHER))
        if "colour" in surface.point_data:
            style["colours"] = np.asarray(surface.point_data["colour"])
        found.append(surface_actor(part, surface, basis=basis if basis.any() else None, **style))
    return found


def head_camera(mesh: Mesh) -> dict[str, Any]:
    """Return a camera on the marked part of the face, a little from the side, so that lips show in depth."""
    points = mesh.vertices_mm[list(mesh.markers.values())] if mesh.markers else mesh.vertices_mm
    low, high = points.min(axis=0), points.max(axis=0)
    centre, height = 0.5 * (low + high), 1.45 * float(high[1] - low[1])
    around, above = np.radians([_AROUND_DEG, _ABOVE_DEG])
    towards = np.array([np.sin(around) * np.cos(above), np.sin(above), np.cos(around) * np.cos(above)])
    distance = 0.5 * height / np.tan(np.radians(_VIEW_ANGLE_DEG / 2))
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

    def __init__(self, clock: str, theme: str, **params: Any) -> None:
        super().__init__(**params)
        self._head: Head | None = None
        self.result: Result | None = None
        self.mesh_view = MeshView(session=clock, theme=theme, description="Talking head")
        self.view = self.mesh_view

    @property
    def theme(self) -> str:
        """Theme of the ground behind the head."""
        return str(self.mesh_view.theme)

    @theme.setter
    def theme(self, theme: str) -> None:
        self.mesh_view.theme = theme

    def show_rest(self, name: str) -> None:
        """Show a head by name at rest, before there is anything that moves it."""
        mesh = mesh_by_name_or_file(name)
        self.mesh_view.show_actors(head_actors(mesh), camera=head_camera(mesh))

    def show(self, result: Result) -> None:
        """Show the head of a result and let it move."""
        self.result = result
        if result.head is not self._head:
            self._head = result.head
            self.mesh_view.show_actors(
                head_actors(result.head.mesh, result.head.binding), camera=head_camera(result.head.mesh)
            )
        parts = {actor["name"] for actor in self.mesh_view.actors}
        moving = {a["name"] for a in self.mesh_view.actors if a["basis"]}
        trajectory = result.trajectory
        self.mesh_view.set_motion(
            trajectory.rate_hz,
            displacements=dict.fromkeys(moving, result.displacements_mm.astype(np.float32)),
            rigid={part: m for part, m in result.animation.rigid.items() if part in parts},
            start_s=float(trajectory.times_s[0]),
        )

    def __panel__(self) -> Any:
        return self.mesh_view
