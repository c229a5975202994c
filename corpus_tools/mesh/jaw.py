"""The rigid jaw: lower teeth and tongue follow the chin markers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from corpus_tools.core import FloatArray, Mesh

__all__ = ["JAW_PARTS", "jaw_hinge_mm", "jaw_motion"]

JAW_PARTS = ("lower_teeth", "tongue")
CHIN = tuple(f"chin{i}" for i in range(8))
HINGE_WEIGHT = 1.5
ROUNDS = 3


def jaw_hinge_mm(mesh: Mesh) -> FloatArray:
    """Return estimated places of the two jaw joints, shape (2, 3), mm.

    From the outer corner of each eye, 17 % of the distance eye to chin down and 60 % back: where the
    joint lies on an adult head (about 20 mm below and 65 mm behind the corner); our choice, as no marker is
    there. Without eye and chin markers 50 mm either side of the middle of the mesh has to do.
    """
    eyes = [mesh.markers[n] for n in ("eye0", "eye6") if n in mesh.markers]
    chins = [mesh.markers[n] for n in CHIN[:4] if n in mesh.markers]
    if len(eyes) < 2 or not chins:
        middle: FloatArray = mesh.vertices_mm.mean(axis=0)
        return np.stack([middle - np.array([50.0, 0, 0]), middle + np.array([50.0, 0, 0])])
    corners = mesh.vertices_mm[eyes]
    height = float(corners[:, 1].mean() - mesh.vertices_mm[chins, 1].min())
    result: FloatArray = corners + np.array([0.0, -0.17, -0.60]) * height
    result[:, 0] *= 1.2
    return result


def jaw_motion(targets_mm: npt.ArrayLike, mesh: Mesh, names: Sequence[str]) -> FloatArray:
    """Return the rigid motion of the jaw in every frame, shape (n_frames, 4, 4), mm, for column vectors.

    A weighted Kabsch fit over the chin markers and the two jaw joints, which are held softly, so that the jaw
    mostly turns about them and may slide a little; markers that disagree (skin over the bone) lose weight by
    Geman-McClure reweighting. Paper A leaves the jaw to the reader; our choice.

    Parameters
    ----------
    targets_mm : (n_frames, n_markers, 3), mm
        Marker positions on the mesh.
    mesh : Mesh
    names : sequence of str
        Names of the markers in `targets_mm`.
    """
    targets = np.asarray(targets_mm, float)
    use = [i for i, n in enumerate(names) if n in CHIN]
    if len(use) < 2:
        return np.broadcast_to(np.eye(4), (len(targets), 4, 4)).copy()
    hinge = jaw_hinge_mm(mesh)
    rest = np.concatenate([mesh.vertices_mm[[mesh.markers[names[i]] for i in use]], hinge])
    moved = np.concatenate([targets[:, use], np.broadcast_to(hinge, (len(targets), 2, 3))], axis=1)
    base = np.r_[np.ones(len(use)), np.full(2, HINGE_WEIGHT)]
    weights = np.broadcast_to(base, moved.shape[:2])
    for _ in range(ROUNDS):
        rotation, shift = _kabsch(rest, moved, weights)
        left = moved - (np.einsum("fij,mj->fmi", rotation, rest) + shift[:, None])
        square = (left**2).sum(axis=2)
        scale = np.maximum(np.median(square[:, : len(use)], axis=1, keepdims=True), 0.25)
        weights = base * np.where(np.arange(len(rest)) < len(use), (scale / (scale + square)) ** 2, 1.0)
    rotation, shift = _kabsch(rest, moved, weights)
    motion = np.broadcast_to(np.eye(4), (len(targets), 4, 4)).copy()
    motion[:, :3, :3], motion[:, :3, 3] = rotation, shift
    return motion


def _kabsch(rest: FloatArray, moved: FloatArray, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return rotations (n, 3, 3) and shifts (n, 3) with R rest + t nearest to `moved`; never a reflection."""
    w = weights / weights.sum(axis=1, keepdims=True)
    from_, to = w @ rest, np.einsum("fm,fmi->fi", w, moved)
    spread = np.einsum("fm,fmi,fmj->fij", w, moved - to[:, None], rest[None] - from_[:, None], optimize=True)
    u, _, vt = np.linalg.svd(spread)
    sign = np.ones((len(u), 3))
    sign[:, 2] = np.sign(np.linalg.det(u @ vt))
    rotation = (u * sign[:, None, :]) @ vt
    return rotation, to - np.einsum("fij,fj->fi", rotation, from_)
