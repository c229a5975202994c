"""Retarget marker motion from the actor to a mesh, relative to the neutral pose (paper A section 6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from corpus_tools.core import FloatArray, Mesh, MeshError, frozen
from corpus_tools.core.capture import region_of
from corpus_tools.retarget.contact import contact_solver, keep_lips_apart, lip_marker_pairs, pair_response
from corpus_tools.retarget.warp import FoldReport, VolumeWarp, choose_smoothing, fit_volume_warp, fold_check

__all__ = ["Retargeter", "prepare_retarget", "retarget"]


@dataclass(frozen=True, slots=True, eq=False)
class Retargeter:
    """Everything that depends only on the neutral pose and the mesh; call it on marker motion.

    Attributes
    ----------
    warp : VolumeWarp
    names : tuple of str, n_markers
    neutral_mm : (n_markers, 3) mm
        The actor's neutral pose.
    warped_neutral_mm : (n_markers, 3) mm
        W(neutral): differs from the rest pose of the mesh by what smoothing leaves over.
    rest_mm : (n_markers, 3) mm
        The marker vertices of the mesh.
    response : (n_pairs, n_markers, 3)
        Aperture of each lip pair of the mesh per mm that a marker moves along x, y, z.
    solver : (n_markers, n_pairs)
        Marker heights that change the apertures (:func:`~corpus_tools.retarget.contact.contact_solver`).
    contact : bool
    seal_mm, soft_mm : float, mm
    """

    warp: VolumeWarp
    names: tuple[str, ...]
    neutral_mm: FloatArray
    warped_neutral_mm: FloatArray
    rest_mm: FloatArray
    response: FloatArray
    solver: FloatArray
    contact: bool
    seal_mm: float
    soft_mm: float

    def __post_init__(self) -> None:
        for key in ("neutral_mm", "warped_neutral_mm", "rest_mm", "response", "solver"):
            object.__setattr__(self, key, frozen(getattr(self, key)))

    def __call__(self, values_mm: npt.ArrayLike) -> FloatArray:
        """Return marker positions on the mesh, (n_frames, n_markers, 3) mm: rest + W(x) - W(neutral).

        The neutral pose lands on the rest pose exactly, also when the warp is smoothed.

        Raises
        ------
        MeshError
            Another number of markers than at the neutral pose.
        """
        values = np.asarray(values_mm, float)
        if values.ndim != 3 or values.shape[1:] != self.neutral_mm.shape:
            raise MeshError(
                f"The motion has shape {values.shape}; (frames, {len(self.names)}, 3) was expected."
            )
        targets = self.warp(values) + (self.rest_mm - self.warped_neutral_mm)
        if not self.contact or not len(self.response):
            return targets
        return keep_lips_apart(
            targets,
            self.rest_mm,
            self.response,
            self.solver,
            seal_mm=self.seal_mm,
            soft_mm=self.soft_mm,
        )

    def folds(self) -> FoldReport:
        """Return the fold check of the warp at the neutral pose: min det J over the markers."""
        return fold_check(self.warp, self.neutral_mm)


def prepare_retarget(
    neutral_mm: npt.ArrayLike,
    names: Sequence[str],
    mesh: Mesh,
    *,
    kernel: str = "cubic",
    smoothing: float | Literal["auto"] = 1e-2,
    contact: bool = True,
    seal_mm: float = 0.0,
    soft_mm: float = 0.5,
    lip_response: npt.ArrayLike | None = None,
) -> Retargeter:
    """Fit the warp from the actor's neutral pose to the marker vertices of a mesh.

    Parameters
    ----------
    neutral_mm : (n_markers, 3), mm
    names : sequence of str, n_markers
    mesh : Mesh
    kernel, smoothing
        See :func:`~corpus_tools.retarget.warp.fit_volume_warp`; smoothing ``"auto"`` is that which misses
        landmarks least that were left out (:func:`~corpus_tools.retarget.warp.choose_smoothing`).
    contact : bool
        Keep the lips from passing through each other.
    seal_mm, soft_mm : float, mm
        See :func:`~corpus_tools.retarget.contact.contact_aperture`.
    lip_response : (n_pairs, n_markers, 3), optional
        Aperture of each lip pair of the mesh per mm that a marker moves along x, y, z, from the deformer
        (``binding.lip_response()``); without it only the inner-lip markers themselves are kept apart.

    Raises
    ------
    MeshError
        A marker is not on the mesh, or the landmarks cannot carry a warp.
    """
    missing = [n for n in names if n not in mesh.markers]
    if missing:
        raise MeshError(
            f"The mesh '{mesh.name}' has no vertex for the marker '{missing[0]}'; name one, or leave it out."
        )
    neutral = np.asarray(neutral_mm, float)
    rest = mesh.vertices_mm[[mesh.markers[n] for n in names]]
    if isinstance(smoothing, str):
        smoothing = choose_smoothing(neutral, rest, kernel=kernel)
    warp = fit_volume_warp(neutral, rest, kernel=kernel, smoothing=smoothing)
    response = _response(lip_response, names, mesh)
    lips = np.array([region_of(n).startswith("lip") for n in names])
    return Retargeter(
        warp=warp,
        names=tuple(names),
        neutral_mm=neutral,
        warped_neutral_mm=warp(neutral),
        rest_mm=rest,
        response=response,
        solver=contact_solver(response[..., 1] * lips if lips.any() else response[..., 1]),
        contact=contact,
        seal_mm=float(seal_mm),
        soft_mm=float(soft_mm),
    )


def _response(given: npt.ArrayLike | None, names: Sequence[str], mesh: Mesh) -> FloatArray:
    if given is None:
        return pair_response(lip_marker_pairs(mesh, names), len(names))[..., None] * [0.0, 1.0, 0.0]
    response = np.array(given, float)
    if response.ndim != 3 or response.shape[1:] != (len(names), 3):
        raise MeshError(
            f"The lip response has shape {response.shape}; (pairs, {len(names)}, 3) was expected."
        )
    return response


def retarget(
    values_mm: npt.ArrayLike,
    names: Sequence[str],
    neutral_mm: npt.ArrayLike,
    mesh: Mesh,
    *,
    kernel: str = "cubic",
    smoothing: float | Literal["auto"] = 1e-2,
    contact: bool = True,
    seal_mm: float = 0.0,
    soft_mm: float = 0.5,
    lip_response: npt.ArrayLike | None = None,
) -> FloatArray:
    """Prepare and apply in one go; returns (n_frames, n_markers, 3) mm on the mesh (:class:`Retargeter`)."""
    prepared = prepare_retarget(
        neutral_mm,
        names,
        mesh,
        kernel=kernel,
        smoothing=smoothing,
        contact=contact,
        seal_mm=seal_mm,
        soft_mm=soft_mm,
        lip_response=lip_response,
    )
    return prepared(values_mm)
