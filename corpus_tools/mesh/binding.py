"""What binds a mesh to its markers: linear blends, or patches that carry the skin (paper A section 6)."""

from __future__ import annotations

import abc
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array, vstack

from corpus_tools.core import FloatArray, IntArray, Mesh, MeshError, frozen
from corpus_tools.mesh.attachment import Attachment, frames_at
from corpus_tools.mesh.chart import CONTROL_POINTS, Chart
from corpus_tools.mesh.jaw import JAW_PARTS, jaw_motion
from corpus_tools.mesh.kernel import Plan, patch_frames, plan_for
from corpus_tools.mesh.patches import bernstein, tangent_rows

__all__ = ["Binding", "ControlSurface", "LinearBinding", "PatchBinding", "with_followers"]


class Binding(abc.ABC):
    """How the vertices of a mesh follow its markers (paper A section 6: motion embedded in a target mesh).

    Attributes
    ----------
    mesh : Mesh
    names : tuple of str, n_markers
    """

    __slots__ = ()

    mesh: Mesh
    names: tuple[str, ...]

    @property
    def rest_mm(self) -> FloatArray:
        """Marker positions at rest, (n_markers, 3) mm."""
        return self.mesh.vertices_mm[[self.mesh.markers[n] for n in self.names]]

    @property
    @abc.abstractmethod
    def driven(self) -> IntArray:
        """Vertices that the markers move, ascending."""

    @abc.abstractmethod
    def response(self, vertices: Sequence[int] | IntArray) -> FloatArray:
        """Return how a shift of a marker shifts vertices along the same axis, near rest: (n, n_markers)."""

    @abc.abstractmethod
    def skin_mm(self, targets_mm: FloatArray, dtype: npt.DTypeLike = np.float32) -> npt.NDArray[np.floating]:
        """Return the driven vertices in every frame, (n_frames, n_driven, 3), mm."""

    def lip_response(self) -> FloatArray:
        """Return the aperture of each lip pair per mm that a marker moves up, shape (n_pairs, n_markers).

        A binding that is not linear gives its linearisation at rest.
        """
        pairs = self.mesh.lip_pairs
        return np.asarray(self.response(pairs[:, 0]) - self.response(pairs[:, 1]))

    def rigid(self, targets_mm: npt.ArrayLike) -> dict[str, FloatArray]:
        """Return the rigid motion of every part that follows the jaw: {part: (n_frames, 4, 4)}, mm."""
        parts = [p for p in JAW_PARTS if p in self.mesh.part_names]
        if not parts:
            return {}
        motion = jaw_motion(targets_mm, self.mesh, self.names)
        return {part: motion for part in parts}

    def apply(
        self,
        targets_mm: npt.ArrayLike,
        rigid: Mapping[str, npt.ArrayLike] | None = None,
        dtype: npt.DTypeLike = np.float32,
    ) -> npt.NDArray[np.floating]:
        """Return the vertices in every frame, (n_frames, n_vertices, 3), mm.

        Parameters
        ----------
        targets_mm : (n_frames, n_markers, 3), mm
            Marker positions on the mesh, in the order of `names`.
        rigid : mapping of part -> (n_frames, 4, 4), optional
            Rigid motion of parts; computed from the targets when not given.
        dtype : float32 or float64
            Of the result and of what is computed on the way to it.

        Raises
        ------
        MeshError
            The targets have another number of markers.
        """
        targets = np.asarray(targets_mm, float)
        if targets.ndim != 3 or targets.shape[1:] != (len(self.names), 3):
            raise MeshError(
                f"The targets have shape {targets.shape}; (frames, {len(self.names)}, 3) was expected."
            )
        motion = self.rigid(targets) if rigid is None else rigid
        out = np.empty((len(targets), self.mesh.n_vertices, 3), dtype)
        out[:] = self.mesh.vertices_mm.astype(dtype)
        out[:, self.driven] = self.skin_mm(targets, dtype)
        for part, matrices in motion.items():
            mask = np.flatnonzero(self.mesh.part_mask(part))
            m = np.asarray(matrices, float)
            points = self.mesh.vertices_mm[mask] @ m[:, :3, :3].transpose(0, 2, 1) + m[:, None, :3, 3]
            out[:, mask] = points.astype(dtype)
        return out


@dataclass(frozen=True, slots=True, eq=False)
class LinearBinding(Binding):
    """Every vertex moves by a fixed blend of the marker displacements.

    Attributes
    ----------
    basis : (n_vertices, n_markers) float64
        Vertex displacement = basis @ marker displacement, per axis; zero on eyes, teeth and tongue.
    """

    mesh: Mesh
    names: tuple[str, ...]
    basis: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "names", tuple(self.names))
        object.__setattr__(self, "basis", frozen(self.basis))

    @property
    def driven(self) -> IntArray:
        """Vertices that the markers move, ascending."""
        return np.flatnonzero(np.any(self.basis, axis=1))

    def response(self, vertices: Sequence[int] | IntArray) -> FloatArray:
        """Return the rows of the basis, (n, n_markers)."""
        return self.basis[np.asarray(vertices, np.int64)]

    def skin_mm(self, targets_mm: FloatArray, dtype: npt.DTypeLike = np.float32) -> npt.NDArray[np.floating]:
        """Return the driven vertices in every frame, (n_frames, n_driven, 3), mm."""
        driven = self.driven
        shift = (targets_mm - self.rest_mm).astype(dtype)
        n = len(shift)
        rows = shift.transpose(0, 2, 1).reshape(3 * n, -1) @ self.basis[driven].T.astype(dtype)
        moved = rows.reshape(n, 3, -1).transpose(0, 2, 1)
        return np.asarray(self.mesh.vertices_mm[driven].astype(dtype) + moved)


@dataclass(frozen=True, slots=True, eq=False)
class ControlSurface:
    """Bezier triangles whose control points are linear in the markers.

    Attributes
    ----------
    chart : Chart
        Triangles of markers; patches 3 k to 3 k + 2 belong to triangle k. Patches beyond these carry one
        vertex each and only shift (:func:`with_followers`).
    net : csr (10 n_patches, n_markers) float64
        Shift of control points = net @ shift of markers; ten rows a patch, in the order of
        :data:`corpus_tools.mesh.chart.CONTROL_POINTS`: b300 b030 b003 b210 b201 b120 b021 b102 b012 b111.
        A row sums to one where no point that stands still has a share in it.
    markers_rest_mm : (n_markers, 3) float64, mm
    control_rest_mm : (n_patches, 10, 3) float64, mm
    """

    chart: Chart
    net: csr_array
    markers_rest_mm: FloatArray
    control_rest_mm: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "markers_rest_mm", frozen(self.markers_rest_mm))
        object.__setattr__(self, "control_rest_mm", frozen(self.control_rest_mm))

    @property
    def n_patches(self) -> int:
        """Number of patches."""
        return int(self.net.shape[0]) // 10

    def control_mm(self, markers_mm: npt.ArrayLike) -> FloatArray:
        """Return the control points (n_patches, 10, 3), mm, for markers (n_markers, 3), mm."""
        shift = np.asarray(self.net @ (np.asarray(markers_mm, float) - self.markers_rest_mm))
        return self.control_rest_mm + shift.reshape(-1, 10, 3)


def with_followers(
    surface: ControlSurface,
    attachment: Attachment,
    vertices: IntArray,
    places_mm: FloatArray,
    basis: FloatArray,
) -> tuple[ControlSurface, Attachment]:
    """Add vertices that move by a fixed blend of marker shifts, each on a small patch that only shifts.

    So the inside of the mouth, which has no markers, is deformed by the same kernel as the skin.

    Parameters
    ----------
    surface : ControlSurface
    attachment : Attachment
    vertices : (n,) int
    places_mm : (n, 3), mm
        At rest.
    basis : (n, n_markers)
    """
    if not len(vertices):
        return surface, attachment
    small = np.concatenate([CONTROL_POINTS[:, :2] / 3.0, np.zeros((10, 1))], axis=1)
    patches = places_mm[:, None, :] + small - small.mean(axis=0)
    net = vstack([surface.net, csr_array(np.repeat(basis, 10, axis=0))], format="csr")
    control = np.concatenate([surface.control_rest_mm, patches])
    n, third = len(vertices), np.full((len(vertices), 3), 1.0 / 3.0)
    both = np.concatenate([attachment.vertices, vertices])
    order = np.argsort(both)
    grown = Attachment(
        both[order],
        np.concatenate([attachment.patch, surface.n_patches + np.arange(n)])[order],
        np.concatenate([attachment.bary, third])[order],
        np.concatenate([attachment.offset, np.zeros((n, 3))])[order],
        np.concatenate([attachment.weight, np.ones(n)])[order],
    )
    return ControlSurface(surface.chart, csr_array(net), surface.markers_rest_mm, control), grown


@dataclass(frozen=True, slots=True, eq=False)
class PatchBinding(Binding):
    """Vertices hang on patches of a surface through the markers: paper A equation (3), not linear.

    Attributes
    ----------
    surface : ControlSurface
    attachment : Attachment
    plans : dict
        What the kernel made of both, by precision.
    """

    mesh: Mesh
    names: tuple[str, ...]
    surface: ControlSurface
    attachment: Attachment
    plans: dict[np.dtype[Any], Plan] = field(default_factory=dict, init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "names", tuple(self.names))

    @property
    def driven(self) -> IntArray:
        """Vertices that the markers move, ascending."""
        return self.attachment.vertices

    def response(self, vertices: Sequence[int] | IntArray) -> FloatArray:
        """Return how a marker's shift along y shifts the vertices along y, at rest: (n, n_markers).

        Exact there in y: the normal turns with the patch.
        """
        a = self.attachment
        rows = np.searchsorted(a.vertices, vertices)
        rows = np.minimum(rows, len(a.vertices) - 1)
        hit = a.vertices[rows] == np.asarray(vertices)
        patch, bary, offset = a.patch[rows], a.bary[rows], a.offset[rows]
        first, second = tangent_rows(bary)
        _, t1, t2, normal = frames_at(self.surface.control_rest_mm[patch], bary)
        turn1, turn2 = _normal_turn(t1, t2, normal, axis=1)
        blend = bernstein(bary) + (offset[:, 0] + offset[:, 2] * turn1)[:, None] * first
        blend = blend + (offset[:, 1] + offset[:, 2] * turn2)[:, None] * second
        net = self.surface.net
        out = np.zeros((len(rows), net.shape[1]))
        for k in range(10):
            out += blend[:, k : k + 1] * net[10 * patch + k].toarray()
        return np.asarray(out * (a.weight[rows] * hit)[:, None])

    def skin_mm(self, targets_mm: FloatArray, dtype: npt.DTypeLike = np.float32) -> npt.NDArray[np.floating]:
        """Return the driven vertices in every frame, (n_frames, n_driven, 3), mm."""
        return patch_frames(self._plan(np.dtype(dtype)), targets_mm - self.rest_mm)

    def _plan(self, dtype: np.dtype[Any]) -> Plan:
        if dtype not in self.plans:
            s, a = self.surface, self.attachment
            rest = self.mesh.vertices_mm[a.vertices]
            n_smooth = 3 * len(s.chart.triangles)
            self.plans[dtype] = plan_for(s.control_rest_mm, s.net, a, rest, n_smooth, dtype)
        return self.plans[dtype]


def _normal_turn(
    t1: FloatArray, t2: FloatArray, normal: FloatArray, axis: int
) -> tuple[FloatArray, FloatArray]:
    """Return by how much the unit normal moves along `axis` as T1, and as T2, moves along it."""
    along = np.zeros(3)
    along[axis] = 1.0
    length = np.linalg.norm(np.cross(t1, t2), axis=1)
    found = []
    for change in (np.cross(along, t2), np.cross(t1, along)):
        tangential = change - (change * normal).sum(axis=1, keepdims=True) * normal
        found.append(tangential[:, axis] / length)
    return found[0], found[1]
