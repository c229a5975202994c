"""What binds a mesh to its markers: linear blends, or patches that carry the skin (paper A section 6)."""

from __future__ import annotations

import abc
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from corpus_tools.core import FloatArray, IntArray, Mesh, MeshError, frozen
from corpus_tools.mesh.attachment import Attachment, frames_at
from corpus_tools.mesh.jaw import JAW_PARTS, jaw_motion
from corpus_tools.mesh.kernel import Plan, patch_frames, plan_for
from corpus_tools.mesh.patches import bernstein, tangent_rows
from corpus_tools.mesh.surface import ControlSurface

__all__ = ["Binding", "LinearBinding", "PatchBinding"]

UP = np.array([0.0, 1.0, 0.0])


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
        """Return how a shift of a marker shifts vertices along the same axis: (n, n_markers).

        All there is to a linear binding; for another one what holds while no normal turns.
        """

    @abc.abstractmethod
    def rise(self, vertices: Sequence[int] | IntArray) -> FloatArray:
        """Return how y of vertices grows with x, y, z of the markers, at rest: (n, n_markers, 3)."""

    @abc.abstractmethod
    def skin_mm(self, targets_mm: FloatArray, dtype: npt.DTypeLike = np.float32) -> npt.NDArray[np.floating]:
        """Return the driven vertices in every frame, (n_frames, n_driven, 3), mm."""

    def lip_response(self) -> FloatArray:
        """Return the aperture of each lip pair per mm that a marker moves, (n_pairs, n_markers, 3).

        Linearised at rest.
        """
        pairs = self.mesh.lip_pairs
        return np.asarray(self.rise(pairs[:, 0]) - self.rise(pairs[:, 1]))

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
        return np.asarray(out)


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
        return np.asarray(self.basis[np.asarray(vertices, np.int64)])

    def rise(self, vertices: Sequence[int] | IntArray) -> FloatArray:
        """Return how y of vertices grows with x, y, z of the markers: (n, n_markers, 3)."""
        return np.asarray(self.response(vertices)[:, :, None] * UP)

    def skin_mm(self, targets_mm: FloatArray, dtype: npt.DTypeLike = np.float32) -> npt.NDArray[np.floating]:
        """Return the driven vertices in every frame, (n_frames, n_driven, 3), mm."""
        driven = self.driven
        shift = (targets_mm - self.rest_mm).astype(dtype)
        n = len(shift)
        rows = shift.transpose(0, 2, 1).reshape(3 * n, -1) @ self.basis[driven].T.astype(dtype)
        moved = rows.reshape(n, 3, -1).transpose(0, 2, 1)
        return np.asarray(self.mesh.vertices_mm[driven].astype(dtype) + moved)


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
        """Return how a shift of a marker shifts vertices along the same axis, no normal turning."""
        a, rows, hit = self._rows(vertices)
        first, second = tangent_rows(a.bary[rows])
        blend = bernstein(a.bary[rows]) + a.offset[rows, :1] * first + a.offset[rows, 1:2] * second
        return self._by_markers(blend * hit[:, None], rows)

    def rise(self, vertices: Sequence[int] | IntArray) -> FloatArray:
        """Return how y of vertices grows with x, y, z of the markers, at rest: (n, n_markers, 3)."""
        a, rows, hit = self._rows(vertices)
        first, second = tangent_rows(a.bary[rows])
        _, t1, t2, normal = frames_at(self.surface.control_rest_mm[a.patch[rows]], a.bary[rows])
        out = self.response(vertices)[:, :, None] * UP
        for axis in range(3):
            turn1, turn2 = _normal_rise(t1, t2, normal, axis)
            turn = a.offset[rows, 2:] * (turn1[:, None] * first + turn2[:, None] * second)
            out[:, :, axis] += self._by_markers(turn * hit[:, None], rows)
        return np.asarray(out)

    def _rows(self, vertices: Sequence[int] | IntArray) -> tuple[Attachment, IntArray, FloatArray]:
        """Return the attachment, the rows of vertices in it, and their share in the motion."""
        a = self.attachment
        rows = np.minimum(np.searchsorted(a.vertices, vertices), len(a.vertices) - 1)
        return a, rows, a.weight[rows] * (a.vertices[rows] == np.asarray(vertices))

    def _by_markers(self, blend: FloatArray, rows: IntArray) -> FloatArray:
        """Return blends of the ten control points (n, 10) as blends of the markers (n, n_markers)."""
        first = 10 * self.attachment.patch[rows]
        out = np.zeros((len(rows), len(self.names)))
        for k in range(10):
            out += blend[:, k : k + 1] * self.surface.net[first + k].toarray()
        return np.asarray(out)

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


def _normal_rise(
    t1: FloatArray, t2: FloatArray, normal: FloatArray, axis: int
) -> tuple[FloatArray, FloatArray]:
    """Return by how much y of the unit normal grows as T1, and as T2, moves along an axis."""
    along = np.eye(3)[axis]
    length = np.linalg.norm(np.cross(t1, t2), axis=1)
    found = []
    for change in (np.cross(along, t2), np.cross(t1, along)):
        tangential = change - (change * normal).sum(axis=1, keepdims=True) * normal
        found.append(tangential[:, 1] / length)
    return found[0], found[1]
