"""Direct RBF displacement: every vertex moves by a fixed linear blend of the marker displacements."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.spatial.distance import cdist

from corpus_tools.core import BoolArray, FloatArray, IntArray, Mesh, Registry
from corpus_tools.mesh.falloff import STILL_MARKERS, marker_fade
from corpus_tools.mesh.lips import lower_side

__all__ = ["DISPLACEMENT_KERNELS", "displacement_basis"]

N_ANCHORS = 80

DISPLACEMENT_KERNELS: Registry[Callable[[FloatArray], FloatArray]] = Registry("displacement kernel")
DISPLACEMENT_KERNELS.add("linear", lambda r: -r)
DISPLACEMENT_KERNELS.add("cubic", lambda r: r**3)
DISPLACEMENT_KERNELS.add("thin-plate", lambda r: r * r * np.log(np.maximum(r, 1e-12)))


def displacement_basis(mesh: Mesh, names: Sequence[str], kernel: str = "thin-plate") -> FloatArray:
    """Return the weight of every marker's displacement on every vertex, shape (n_vertices, n_markers).

    Two interpolations are made, one of the markers that belong to the upper side of the mouth and one of
    those of the lower side (those beside the mouth belong to both); each vertex takes the one of its side
    (:func:`corpus_tools.mesh.lips.lower_side`). Anchors that do not move stand where no marker is, and
    everything fades out towards neck, ears, the back of the head and the eyes.
    A baseline for comparison with the Bezier induced deformations of paper A section 6; our choice.

    Parameters
    ----------
    mesh : Mesh
    names : sequence of str
        Markers, all on the mesh.
    kernel : str
        One of :data:`DISPLACEMENT_KERNELS`.
    """
    phi = DISPLACEMENT_KERNELS[kernel]
    scale = float(np.ptp(mesh.vertices_mm, axis=0).max())
    skin = np.flatnonzero(mesh.part_mask("skin")) if "skin" in mesh.part_names else np.arange(mesh.n_vertices)
    moving = np.array([n not in STILL_MARKERS for n in names])
    at = np.array([mesh.markers[n] for n in names])
    fade = marker_fade(mesh, at[moving])
    anchors = _anchors(mesh, skin, fade, at[~moving])
    side = lower_side(mesh)
    basis = np.zeros((mesh.n_vertices, len(names)))
    for weight in (1.0 - side, side):
        columns = np.flatnonzero(moving & (weight[at] > 0))
        if not len(columns):
            continue
        wanted = skin[weight[skin] > 0]
        part = _interpolation(mesh.vertices_mm / scale, at[columns], anchors, wanted, phi)
        basis[np.ix_(wanted, columns)] += weight[wanted, None] * part
    basis *= fade[:, None]
    basis[np.abs(basis) < 1e-12] = 0.0
    return basis


def _interpolation(
    v: FloatArray,
    markers: IntArray,
    anchors: IntArray,
    wanted: IntArray,
    phi: Callable[[FloatArray], FloatArray],
) -> FloatArray:
    """Return the cardinal functions of `markers` at `wanted`, anchors held at zero; affine part included."""
    sources = v[np.concatenate([markers, anchors])]
    n = len(sources)
    tail = np.concatenate([np.ones((n, 1)), sources], axis=1)
    system = np.zeros((n + 4, n + 4))
    system[:n, :n] = phi(cdist(sources, sources))
    system[:n, n:], system[n:, :n] = tail, tail.T
    right = np.zeros((n + 4, len(markers)))
    right[np.arange(len(markers)), np.arange(len(markers))] = 1.0
    coefficients = np.linalg.solve(system, right)
    points = v[wanted]
    rows = np.concatenate([phi(cdist(points, sources)), np.ones((len(points), 1)), points], axis=1)
    return np.asarray(rows @ coefficients)


def _anchors(mesh: Mesh, skin: IntArray, fade: FloatArray, still: IntArray) -> IntArray:
    """Return vertices held at rest: the still markers and a farthest-point sample of where nothing moves."""
    idle: BoolArray = fade[skin] < 0.25
    candidates = skin[idle]
    chosen = [int(i) for i in still]
    if not len(candidates):
        return np.array(chosen, np.int64)
    points = mesh.vertices_mm[candidates]
    if not chosen:
        chosen = [int(candidates[points[:, 1].argmax()])]
    distance = cdist(points, mesh.vertices_mm[chosen]).min(axis=1)
    while len(chosen) < N_ANCHORS and distance.max() > 1.0:
        pick = int(distance.argmax())
        chosen.append(int(candidates[pick]))
        distance = np.minimum(distance, np.linalg.norm(points - points[pick], axis=1))
    return np.array(chosen, np.int64)
