"""From markers to the vertices of a mesh: deformers by name."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.sparse import csr_array

from corpus_tools.core import BoolArray, FloatArray, IntArray, Mesh, MeshError, Registry
from corpus_tools.mesh.attachment import Attachment, attach, frames_at, nearest_on_patches
from corpus_tools.mesh.binding import Binding, ControlSurface, LinearBinding, PatchBinding
from corpus_tools.mesh.chart import Chart, open_mouth_chart
from corpus_tools.mesh.falloff import STILL_MARKERS, marker_fade, smooth_step
from corpus_tools.mesh.lips import lip_distances_mm
from corpus_tools.mesh.patches import linear_net, smooth_net
from corpus_tools.mesh.rbf import displacement_basis
from corpus_tools.mesh.regions import SkinRegion, skin_regions
from corpus_tools.mesh.topology import vertex_normals

__all__ = ["ATTACHMENTS", "DEFORMERS", "bind_bid", "bind_linear", "bind_rbf"]

ATTACHMENTS = ("side", "angle")
ANGLE_DEG = 60.0
WALL = (0.24, 0.8)
"""Depth behind the skin, in widths of the mouth, at which its inside begins to lag and no longer moves."""

DEFORMERS: Registry[Callable[[Mesh, Sequence[str]], Binding]] = Registry("deformer")


@DEFORMERS.register("bid")
def bind_bid(
    mesh: Mesh, names: Sequence[str], *, attachment: str = "side", angle_deg: float = ANGLE_DEG
) -> PatchBinding:
    """Bind a mesh by Bezier induced deformations (paper A section 6, equation 3).

    Parameters
    ----------
    mesh : Mesh
    names : sequence of str
        Markers, all on the mesh.
    attachment : str
        ``"side"``: a vertex may hang on patches of its own lip only, told by distance along the skin (our
        choice); ``"angle"``: the paper's rule, patches turned by more than `angle_deg` are refused.
    angle_deg : float, degrees

    Raises
    ------
    MeshError
        A marker has no vertex on the mesh, two share one, or they span no surface.
    """
    chart = _chart(mesh, names)
    return _bind_patches(mesh, names, chart, smooth_net(chart), attachment, angle_deg)


@DEFORMERS.register("linear")
def bind_linear(mesh: Mesh, names: Sequence[str]) -> PatchBinding:
    """Bind a mesh to flat triangles between its markers, attached as the smooth patches are: a baseline.

    Raises
    ------
    MeshError
        A marker has no vertex on the mesh, two share one, or they span no surface.
    """
    chart = _chart(mesh, names)
    return _bind_patches(mesh, names, chart, linear_net(chart), "side", ANGLE_DEG)


@DEFORMERS.register("rbf")
def bind_rbf(mesh: Mesh, names: Sequence[str]) -> LinearBinding:
    """Bind a mesh to its markers by direct RBF displacement (:func:`displacement_basis`): a baseline.

    Raises
    ------
    MeshError
        A marker has no vertex on the mesh, or two share one.
    """
    _check_markers(mesh, names)
    return LinearBinding(mesh, tuple(names), displacement_basis(mesh, names))


def _check_markers(mesh: Mesh, names: Sequence[str]) -> None:
    missing = [n for n in names if n not in mesh.markers]
    if missing:
        raise MeshError(
            f"The mesh '{mesh.name}' has no vertex for the marker '{missing[0]}'; name one, or leave it out."
        )
    vertices = [mesh.markers[n] for n in names]
    if len(set(vertices)) < len(vertices):
        twice = next(n for i, n in enumerate(names) if vertices[i] in vertices[:i])
        raise MeshError(f"On the mesh '{mesh.name}' the marker '{twice}' shares its vertex with another one.")


def _chart(mesh: Mesh, names: Sequence[str]) -> Chart:
    _check_markers(mesh, names)
    return open_mouth_chart(mesh, names)


def _bind_patches(
    mesh: Mesh, names: Sequence[str], chart: Chart, net: csr_array, rule: str, angle_deg: float
) -> PatchBinding:
    """Attach every vertex of the skin that the markers reach."""
    at = np.array([mesh.markers[n] for n in names], np.int64)
    surface = ControlSurface(chart, net)
    control = surface.control_mm(mesh.vertices_mm[at])
    weight = marker_fade(mesh, at[[n not in STILL_MARKERS for n in names]])
    if "skin" in mesh.part_names:
        weight[~mesh.part_mask("skin")] = 0.0
    inside = skin_regions(mesh) == SkinRegion.MOUTH
    vertices = np.flatnonzero((weight > 0) | inside)
    if rule == "angle":
        patch, bary = _by_angle(mesh, vertices, control, angle_deg)
    else:
        patch, bary = _by_side(mesh, vertices, control, chart)
    offset = attach(mesh.vertices_mm[vertices], control, patch, bary)
    share = weight[vertices]
    walls = inside[vertices]
    point = frames_at(control[patch], bary)[0]
    depth = np.linalg.norm(mesh.vertices_mm[vertices] - point, axis=1)
    share[walls] = _wall_share(mesh, depth[walls])
    moves = share > 0
    return PatchBinding(
        mesh,
        tuple(names),
        surface,
        Attachment(vertices[moves], patch[moves], bary[moves], offset[moves], share[moves]),
    )


def _wall_share(mesh: Mesh, depth_mm: FloatArray) -> FloatArray:
    """Return the share of the motion that the inside of the mouth takes part in, by depth behind the skin."""
    width = float(np.ptp(mesh.vertices_mm[mesh.lip_pairs.ravel(), 0]))
    near, far = (share * width for share in WALL)
    return smooth_step((far - depth_mm) / (far - near))


def _by_angle(
    mesh: Mesh, vertices: IntArray, control: FloatArray, angle_deg: float
) -> tuple[IntArray, FloatArray]:
    everything: BoolArray = np.ones(len(control), bool)
    normals = vertex_normals(mesh.vertices_mm, mesh.faces)[vertices]
    return nearest_on_patches(
        mesh.vertices_mm[vertices], control, everything, normals=normals, angle_deg=angle_deg
    )


def _by_side(
    mesh: Mesh, vertices: IntArray, control: FloatArray, chart: Chart
) -> tuple[IntArray, FloatArray]:
    """Return the nearest places on patches that do not belong to the other lip."""
    to_upper, to_lower = (d[vertices] for d in lip_distances_mm(mesh))
    label = np.sign(np.nan_to_num(to_lower - to_upper, posinf=0.0, neginf=0.0))
    side = np.repeat(chart.triangle_side, 3)
    patch, bary = np.zeros(len(vertices), np.int64), np.zeros((len(vertices), 3))
    for wanted in (-1, 0, 1):
        rows = np.flatnonzero(label == wanted)
        if len(rows):
            allowed = side * wanted >= 0
            patch[rows], bary[rows] = nearest_on_patches(mesh.vertices_mm[vertices[rows]], control, allowed)
    return patch, bary
