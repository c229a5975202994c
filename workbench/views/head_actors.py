"""The actors of a head: its parts, moved by patches or by a basis, and what shows how they are moved."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pyvista as pv

from corpus_tools.core import Mesh
from corpus_tools.mesh import CONTROL_POINTS, Binding, PatchBinding, level_neck, neck_rim
from corpus_tools.mesh.patches import bernstein
from corpus_tools.render import PART_STYLES, part_surface
from workbench.views.patches import attached_rows, net_data, shared_patches
from workbench.views.scene_actors import surface_actor

__all__ = ["OVERLAYS", "attachment_actors", "head_actors", "marker_actors", "patch_actors"]

_OTHER = {"color": "#c8c8c8", "ambient": 0.3, "diffuse": 0.7}
_STEPS = 5
"""Steps along an edge of a patch in the picture of the control surface."""
_UNLIT = {"ambient": 1.0, "diffuse": 0.0}


def head_actors(
    mesh: Mesh, binding: Binding | None = None, prefix: str = "", matrix: npt.ArrayLike | None = None
) -> list[dict[str, Any]]:
    """Return one actor for every part of a mesh; the parts that a binding moves carry how.

    The rim of the neck is level (:func:`corpus_tools.mesh.level_neck`) and rests.

    Parameters
    ----------
    mesh : Mesh
    binding : Binding, optional
        Without one the head rests.
    prefix : str
        Begins every actor's name, where several heads share a view.
    matrix : (4, 4), optional
        Where the head stands.
    """
    found = []
    drawn = level_neck(mesh)
    for part in mesh.part_names:
        surface = part_surface(drawn, part)
        used = np.asarray(surface.point_data["vertex"])
        style: dict[str, Any] = dict(PART_STYLES.get(part, _OTHER))
        if "colour" in surface.point_data:
            style["colours"] = np.asarray(surface.point_data["colour"])
        moved = {} if binding is None else _moved_by(binding, used)
        found.append(surface_actor(prefix + part, surface, ids=used, matrix=matrix, **moved, **style))
    return found


def _moved_by(binding: Binding, used: npt.NDArray[np.int64]) -> dict[str, Any]:
    """Return what moves vertices: their rows of the basis, or their patches; nothing when they are still."""
    if not np.isin(used, binding.driven).any():
        return {}
    if not isinstance(binding, PatchBinding):
        return {"basis": binding.response(used)}
    a = binding.attachment
    mine = np.isin(a.vertices, used) & ~np.isin(a.vertices, neck_rim(binding.mesh))
    rows = np.searchsorted(used, a.vertices[mine])
    attached = attached_rows(len(used), rows, a.patch[mine], a.bary[mine], a.offset[mine], a.weight[mine])
    net = net_data(binding.surface.net, binding.surface.control_rest_mm, CONTROL_POINTS)
    return {"patches": {**net, "attached": attached.tobytes()}}


def marker_actors(binding: Binding, of: str) -> list[dict[str, Any]]:
    """Return the markers as dots that move with their own displacements; `of` is not needed for them."""
    points = pv.PolyData(np.asarray(binding.rest_mm, np.float32))
    names = binding.names
    dots = surface_actor(
        "markers", points, color="#1f6feb", point_size=8, basis=np.eye(len(names)), labels=names
    )
    return [dots]


def patch_actors(binding: Binding, of: str) -> list[dict[str, Any]]:
    """Return the control surface: its patches, and the edges between markers; none without patches.

    `of` is the actor whose patches they share.
    """
    if not isinstance(binding, PatchBinding):
        return []
    n = 3 * len(binding.surface.chart.triangles)  # those beyond only carry the inside of the mouth
    grid, triangles = _grid(_STEPS)
    faces = (triangles[None] + len(grid) * np.arange(n)[:, None, None]).reshape(-1, 3)
    along = np.linspace(0.0, 1.0, 2 * _STEPS + 1)
    edge = np.stack([1 - along, along, 0 * along], axis=1)
    steps = np.stack([np.arange(len(edge) - 1), np.arange(1, len(edge))], axis=1)
    lines = (steps[None] + len(edge) * np.arange(n)[:, None, None]).reshape(-1, 2)
    style: dict[str, Any] = {"ambient": 0.35, "diffuse": 0.6, "color": "#6f9bd8", "pickable": False}
    ink: dict[str, Any] = {"color": "#12305c", "pickable": False}
    points, places = _on_patches(binding, np.repeat(np.arange(n), len(grid)), np.tile(grid, (n, 1)))
    surface = pv.PolyData.from_regular_faces(points, faces)
    points, ends = _on_patches(binding, np.repeat(np.arange(n), len(edge)), np.tile(edge, (n, 1)))
    return [
        surface_actor("surface", surface, patches=shared_patches(of, places), **style),
        surface_actor("edges", _segments(points, lines), patches=shared_patches(of, ends), **ink),
    ]


def attachment_actors(binding: Binding, of: str) -> list[dict[str, Any]]:
    """Return a line from every driven vertex to the point of its patch; none without patches."""
    if not isinstance(binding, PatchBinding):
        return []
    a = binding.attachment
    skin = a.patch < 3 * len(binding.surface.chart.triangles)
    n = int(skin.sum())
    points, feet = _on_patches(binding, a.patch[skin], a.bary[skin])
    own = attached_rows(n, np.arange(n), a.patch[skin], a.bary[skin], a.offset[skin], a.weight[skin])
    both = np.concatenate([np.asarray(binding.mesh.vertices_mm[a.vertices[skin]], np.float32), points])
    lines = np.stack([np.arange(n), n + np.arange(n)], axis=1)
    patches = shared_patches(of, np.concatenate([own, feet]))
    name, ink = "attachment", "#c2410c"
    return [surface_actor(name, _segments(both, lines), color=ink, patches=patches, pickable=False)]


OVERLAYS = {"markers": marker_actors, "surface": patch_actors, "attachment": attachment_actors}
"""What can be shown over a head on demand (paper A figure 4)."""


def _on_patches(
    binding: PatchBinding, patch: npt.NDArray[np.int64], bary: npt.NDArray[np.float64]
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """Return places on patches at rest, and their attachment without offset."""
    control = binding.surface.control_rest_mm[patch]
    points = np.einsum("nk,nkc->nc", bernstein(bary), control).astype(np.float32)
    n = len(points)
    return points, attached_rows(n, np.arange(n), patch, bary, np.zeros((n, 3)), np.ones(n))


def _grid(n: int) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
    """Return barycentric coordinates of a regular grid over a triangle, and its small triangles."""
    places = [(i, j) for i in range(n + 1) for j in range(n + 1 - i)]
    row = {place: k for k, place in enumerate(places)}
    up = [(row[i, j], row[i + 1, j], row[i, j + 1]) for i, j in places if i + j < n]
    down = [(row[i + 1, j], row[i + 1, j + 1], row[i, j + 1]) for i, j in places if i + j < n - 1]
    bary = np.array([(i, j, n - i - j) for i, j in places]) / n
    return bary, np.array(up + down, np.int64)


def _segments(points: npt.NDArray[np.float32], lines: npt.NDArray[np.int64]) -> pv.PolyData:
    cells = np.column_stack([np.full(len(lines), 2), lines]).ravel()
    return pv.PolyData(points, lines=cells)
