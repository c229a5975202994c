"""A face mesh with named parts and the vertices that stand for markers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from corpus_tools.core.arrays import FloatArray, frozen
from corpus_tools.core.errors import MeshError

__all__ = ["Mesh"]


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """A triangle mesh in mm, y up, z out of the face, mouth closed (its neutral).

    Attributes
    ----------
    vertices_mm : (n_vertices, 3) float64, mm
    faces : (n_faces, 3) int32
    part : (n_vertices,) int8
        Index into `part_names` of each vertex.
    part_names : tuple of str
        e.g. skin, eyes, upper_teeth, lower_teeth, tongue.
    markers : mapping of marker name -> vertex index
    lip_pairs : (n_pairs, 2) int64
        Upper and lower inner-lip vertices that meet when the mouth closes.
    """

    name: str
    vertices_mm: FloatArray
    faces: npt.NDArray[np.int32]
    part: npt.NDArray[np.int8]
    part_names: tuple[str, ...] = ("skin",)
    markers: Mapping[str, int] = field(default_factory=dict)
    lip_pairs: npt.NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 2), np.int64))

    def __post_init__(self) -> None:
        n = len(self.vertices_mm)
        _check_kinds(self.name, n, self.vertices_mm, self.faces, self.part, self.part_names, self.lip_pairs)
        markers = {str(k): _vertex(self.name, k, v) for k, v in self.markers.items()}
        for key, value in {
            "vertices_mm": frozen(self.vertices_mm),
            "faces": frozen(self.faces, np.int32),
            "part": frozen(self.part, np.int8),
            "part_names": tuple(self.part_names),
            "markers": MappingProxyType(markers),
            "lip_pairs": frozen(self.lip_pairs, np.int64),
        }.items():
            object.__setattr__(self, key, value)

    @property
    def n_vertices(self) -> int:
        """Number of vertices."""
        return len(self.vertices_mm)

    def part_mask(self, *names: str) -> npt.NDArray[np.bool_]:
        """Return which vertices belong to any of the named parts, shape (n_vertices,)."""
        wanted = [i for i, n in enumerate(self.part_names) if n in names]
        return np.isin(self.part, wanted)


def _check_kinds(
    name: str, n: int, vertices: object, faces: object, part: object, part_names: object, pairs: object
) -> None:
    """Refuse arrays of the wrong kind before they are cast: a cast would make numbers of anything."""
    if np.asarray(vertices).dtype.kind not in "fiu":
        raise MeshError(f"The mesh '{name}' has vertices that are no real numbers; export it again.")
    corners = np.asarray(faces)
    whole = corners.ndim == 2 and corners.shape[1] == 3 and corners.dtype.kind in "iu"
    if not whole or (corners.size and (corners.min() < 0 or corners.max() >= n)):
        raise MeshError(f"The mesh '{name}' has faces that are not triangles of its {n} vertices.")
    rows, n_names = np.asarray(part), len(tuple(part_names))  # type: ignore[arg-type]
    if (
        rows.shape != (n,)
        or rows.dtype.kind not in "iu"
        or (n and not 0 <= rows.min() <= rows.max() < n_names)
    ):
        raise MeshError(
            f"The mesh '{name}' must name a part from 0 to {n_names - 1} for each of its {n} vertices."
        )
    if np.asarray(pairs).dtype.kind not in "iu":
        raise MeshError(f"The lip pairs of the mesh '{name}' are no whole numbers; correct them.")


def _vertex(name: str, marker: str, vertex: object) -> int:
    if isinstance(vertex, bool | np.bool_) or not isinstance(vertex, int | np.integer):
        raise MeshError(
            f"On the mesh '{name}' the marker '{marker}' stands at {vertex!r}, which is no vertex."
        )
    return int(vertex)
