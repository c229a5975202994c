"""From markers to the vertices of a mesh: deformers by name, and what binds a mesh to its markers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from corpus_tools.core import FloatArray, Mesh, MeshError, Registry, frozen
from corpus_tools.mesh.jaw import JAW_PARTS, jaw_motion
from corpus_tools.mesh.rbf import displacement_basis

__all__ = ["DEFORMERS", "Binding", "bind_rbf"]


@dataclass(frozen=True, slots=True, eq=False)
class Binding:
    """How the vertices of a mesh follow its markers (paper A section 6: motion embedded in a target mesh).

    Attributes
    ----------
    mesh : Mesh
    names : tuple of str, n_markers
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
    def rest_mm(self) -> FloatArray:
        """Marker positions at rest, (n_markers, 3) mm."""
        return self.mesh.vertices_mm[[self.mesh.markers[n] for n in self.names]]

    def lip_response(self) -> FloatArray:
        """Return the aperture of each lip pair per mm that a marker moves up, shape (n_pairs, n_markers)."""
        pairs = self.mesh.lip_pairs
        return np.asarray(self.basis[pairs[:, 0]] - self.basis[pairs[:, 1]])

    def rigid(self, targets_mm: npt.ArrayLike) -> dict[str, FloatArray]:
        """Return the rigid motion of every part that follows the jaw: {part: (n_frames, 4, 4)}, mm."""
        parts = [p for p in JAW_PARTS if p in self.mesh.part_names]
        if not parts:
            return {}
        motion = jaw_motion(targets_mm, self.mesh, self.names)
        return {part: motion for part in parts}

    def apply(
        self, targets_mm: npt.ArrayLike, rigid: Mapping[str, npt.ArrayLike] | None = None
    ) -> npt.NDArray[np.float32]:
        """Return the vertices in every frame, (n_frames, n_vertices, 3) float32, mm.

        Parameters
        ----------
        targets_mm : (n_frames, n_markers, 3), mm
            Marker positions on the mesh, in the order of `names`.
        rigid : mapping of part -> (n_frames, 4, 4), optional
            Rigid motion of parts; computed from the targets when not given.

        Raises
        ------
        MeshError
            The targets have another number of markers.
        """
        targets = np.asarray(targets_mm)
        if targets.ndim != 3 or targets.shape[1:] != (len(self.names), 3):
            raise MeshError(
                f"The targets have shape {targets.shape}; (frames, {len(self.names)}, 3) was expected."
            )
        motion = self.rigid(targets) if rigid is None else rigid
        moving = np.flatnonzero(np.any(self.basis, axis=1))
        shift = (targets - self.rest_mm).astype(np.float32)
        n = len(targets)
        rows = shift.transpose(0, 2, 1).reshape(3 * n, -1) @ self.basis[moving].T.astype(np.float32)
        out = np.empty((n, self.mesh.n_vertices, 3), np.float32)
        out[:] = self.mesh.vertices_mm.astype(np.float32)
        for axis in range(3):
            out[:, moving, axis] += rows[axis::3]
        for part, matrices in motion.items():
            mask = np.flatnonzero(self.mesh.part_mask(part))
            m = np.asarray(matrices, float)
            points = self.mesh.vertices_mm[mask] @ m[:, :3, :3].transpose(0, 2, 1) + m[:, None, :3, 3]
            out[:, mask] = points.astype(np.float32)
        return out


DEFORMERS: Registry[Callable[[Mesh, Sequence[str]], Binding]] = Registry("deformer")


@DEFORMERS.register("rbf")
def bind_rbf(mesh: Mesh, names: Sequence[str]) -> Binding:
    """Bind a mesh to its markers by direct RBF displacement (:func:`displacement_basis`).

    Raises
    ------
    MeshError
        A marker has no vertex on the mesh, or two share one.
    """
    missing = [n for n in names if n not in mesh.markers]
    if missing:
        raise MeshError(
            f"The mesh '{mesh.name}' has no vertex for the marker '{missing[0]}'; name one, or leave it out."
        )
    vertices = [mesh.markers[n] for n in names]
    if len(set(vertices)) < len(vertices):
        twice = next(n for i, n in enumerate(names) if vertices[i] in vertices[:i])
        raise MeshError(f"On the mesh '{mesh.name}' the marker '{twice}' shares its vertex with another one.")
    return Binding(mesh, tuple(names), displacement_basis(mesh, names))
