"""From markers to the vertices of a mesh: deformers by name."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.sparse import csr_array

from corpus_tools.core import BoolArray, FloatArray, IntArray, Mesh, MeshError, Registry
from corpus_tools.mesh.attachment import Attachment, attach, nearest_on_patches
from corpus_tools.mesh.binding import Binding, LinearBinding, PatchBinding
from corpus_tools.mesh.chart import Chart, chart_places, open_mouth_chart
from corpus_tools.mesh.falloff import STILL_MARKERS, marker_fade
from corpus_tools.mesh.kernel import warm_up
from corpus_tools.mesh.lips import lip_distances_mm
from corpus_tools.mesh.patches import linear_net, smooth_net
from corpus_tools.mesh.rbf import displacement_basis
from corpus_tools.mesh.regions import SkinRegion, skin_regions
from corpus_tools.mesh.surface import ControlSurface, with_followers
from corpus_tools.mesh.topology import vertex_normals

__all__ = ["ATTACHMENTS", "DEFORMERS", "bind_bid", "bind_linear", "bind_rbf"]

ATTACHMENTS = ("side", "angle")
ANGLE_DEG = 60.0
GUIDE = 0.5
"""How much a mm in the chart counts against one in space when a vertex looks for its patch; our choice."""

DEFORMERS: Registry[Callable[[Mesh, Sequence[str]], Binding]] = Registry("deformer")


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
    if attachment not in ATTACHMENTS:
        raise MeshError(f"There is no attachment '{attachment}'; say 'side' or 'angle'.")
    warm_up()
    chart = _chart(mesh, names)
    return _bind_patches(mesh, names, chart, smooth_net(chart), attachment, angle_deg)


def bind_linear(mesh: Mesh, names: Sequence[str]) -> PatchBinding:
    """Bind a mesh to flat triangles between its markers, attached as the smooth patches are: a baseline.

    Raises
    ------
    MeshError
        A marker has no vertex on the mesh, two share one, or they span no surface.
    """
    warm_up()
    chart = _chart(mesh, names)
    return _bind_patches(mesh, names, chart, linear_net(chart), "side", ANGLE_DEG)


def bind_rbf(mesh: Mesh, names: Sequence[str]) -> LinearBinding:
    """Bind a mesh to its markers by direct RBF displacement (:func:`displacement_basis`): a baseline.

    Raises
    ------
    MeshError
        A marker has no vertex on the mesh, or two share one.
    """
    _check_markers(mesh, names)
    return LinearBinding(mesh, tuple(names), displacement_basis(mesh, names))


DEFORMERS.add("bid", bind_bid)
DEFORMERS.add("linear", bind_linear)
DEFORMERS.add("rbf", bind_rbf)


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
    """Attach every vertex of the skin that the markers reach; the inside of the mouth follows on its own."""
    at = np.array([mesh.markers[n] for n in names], np.int64)
    moving = np.array([n not in STILL_MARKERS for n in names])
    control = np.asarray(net @ mesh.vertices_mm[chart.vertices]).reshape(-1, 10, 3)
    weight = marker_fade(mesh, at[moving])
    if "skin" in mesh.part_names:
        weight[~mesh.part_mask("skin")] = 0.0
    inside = skin_regions(mesh) == SkinRegion.MOUTH
    vertices = np.flatnonzero((weight > 0) & ~inside)
    if rule == "angle":
        patch, bary = _by_angle(mesh, vertices, control, angle_deg)
    else:
        patch, bary = _by_side(mesh, vertices, control, chart)
    _pin_markers(chart, vertices, patch, bary)
    offset = attach(mesh.vertices_mm[vertices], control, patch, bary)
    outside = Attachment(vertices, patch, bary, offset, weight[vertices])
    free = csr_array(net[:, : len(names)].multiply(moving))
    free.eliminate_zeros()
    surface = ControlSurface(chart, free, mesh.vertices_mm[at], control)
    return PatchBinding(mesh, tuple(names), *with_followers(surface, outside, *_walls(mesh, names, inside)))


def _pin_markers(chart: Chart, vertices: IntArray, patch: IntArray, bary: FloatArray) -> None:
    """Put the vertex of every point of the chart at its own corner, in place."""
    for point, vertex in enumerate(chart.vertices):
        row = int(np.searchsorted(vertices, vertex))
        corner = np.argwhere(chart.triangles == point)
        if row < len(vertices) and vertices[row] == vertex and len(corner):
            patch[row] = 3 * corner[0, 0] + corner[0, 1]
            bary[row] = (1.0, 0.0, 0.0)


def _walls(mesh: Mesh, names: Sequence[str], inside: BoolArray) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return vertices inside the mouth that move, their places, and their blends of marker shifts."""
    if not inside.any():
        return np.zeros(0, np.int64), np.zeros((0, 3)), np.zeros((0, len(names)))
    basis = displacement_basis(mesh, names)
    walls = np.flatnonzero(inside & np.any(basis, axis=1))
    return walls, mesh.vertices_mm[walls], basis[walls]


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
    """Return the nearest places on patches that do not belong to the other lip, guided by the chart."""
    to_upper, to_lower = (d[vertices] for d in lip_distances_mm(mesh))
    label = np.sign(np.nan_to_num(to_lower - to_upper, posinf=0.0, neginf=0.0))
    side = np.repeat(chart.triangle_side, 3)
    guided = np.concatenate([control, GUIDE * chart.patch_points()], axis=2)
    patch, bary = np.zeros(len(vertices), np.int64), np.zeros((len(vertices), 3))
    for wanted in (-1, 0, 1):
        rows = np.flatnonzero(label == wanted)
        if len(rows):
            points = mesh.vertices_mm[vertices[rows]]
            places = chart_places(chart, mesh.vertices_mm, points, int(wanted))
            points = np.concatenate([points, GUIDE * places], axis=1)
            patch[rows], bary[rows] = nearest_on_patches(points, guided, side * wanted >= 0)
    return patch, bary
