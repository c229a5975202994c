"""From synthesised markers to a moving head: retarget, lip contact, deformer, jaw (paper A section 6)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from corpus_tools.config import ConfigBase
from corpus_tools.core import FloatArray, Mesh, MeshError, Trajectory, counted
from corpus_tools.mesh import DEFORMERS, Binding, mesh_by_name_or_file, refuse_fatal
from corpus_tools.pipeline.opened import OpenCorpus
from corpus_tools.pipeline.threads import one_thread
from corpus_tools.retarget import Retargeter, prepare_retarget

__all__ = ["Animation", "Head", "animate", "prepare_head", "vertex_frames"]

LEAST_SPAN_MM, MOST_SPAN_MM = 5.0, 5000.0
"""Extent of the markers on a mesh (our choice): a doll to a statue; beyond, the unit is another one."""


@dataclass(frozen=True, slots=True, eq=False)
class Head:
    """A mesh bound to the markers of a corpus: computed once per corpus, mesh and retarget settings.

    Attributes
    ----------
    mesh : Mesh
    names : tuple of str
        The markers that drive it, in the order of the animation's targets.
    retargeter : Retargeter
        The volume warp from the actor's neutral to the mesh, with lip contact.
    binding : Binding
        How the deformer ties vertices to markers.
    """

    mesh: Mesh
    names: tuple[str, ...]
    retargeter: Retargeter
    binding: Binding


@dataclass(frozen=True, slots=True, eq=False)
class Animation:
    """Motion in the space of a mesh.

    Attributes
    ----------
    times_s : (n_frames,) s
    targets_mm : (n_frames, n_markers, 3) mm
        Marker positions on the mesh.
    rigid : mapping of part name -> (n_frames, 4, 4)
        Rigid motion of lower teeth and tongue, as matrices for column vectors in mm.
    """

    times_s: FloatArray
    targets_mm: FloatArray
    rigid: Mapping[str, FloatArray]


@one_thread
def prepare_head(corpus: OpenCorpus, mesh: str | Mesh, config: ConfigBase) -> Head:
    """Bind a mesh to the markers of a corpus.

    Parameters
    ----------
    corpus : OpenCorpus
    mesh : str or Mesh
        Name of a bundled head, path of a mesh file, or a mesh.
    config : config
        Sections `retarget` and `deform` are used.

    Raises
    ------
    MeshError
        No such mesh, the file is none, or it shares too few markers with the corpus.
    """
    target = mesh if isinstance(mesh, Mesh) else mesh_by_name_or_file(mesh)
    names = tuple(n for n in corpus.markers if n in target.markers)
    if len(names) < 8:
        raise MeshError(
            f"The mesh '{target.name}' and the corpus share {counted(len(names), 'marker')} of "
            f"{len(corpus.markers)}; at least 8 are needed: name its marker vertices as the corpus does."
        )
    span_mm = float(np.ptp(target.vertices_mm[[target.markers[n] for n in names]], axis=0).max())
    if not LEAST_SPAN_MM <= span_mm <= MOST_SPAN_MM:
        raise MeshError(
            f"The markers of the mesh '{target.name}' span {span_mm:.3g} mm, where a face of "
            f"{LEAST_SPAN_MM:g} to {MOST_SPAN_MM:g} mm was expected; scale it to mm."
        )
    refuse_fatal(target)
    columns = [corpus.markers.index(n) for n in names]
    deformer = DEFORMERS[config.deform.deformer]
    try:
        binding = deformer(target, names)
        retargeter = prepare_retarget(
            corpus.neutral_mm[columns],
            names,
            target,
            kernel=config.retarget.kernel,
            smoothing=config.retarget.smoothing,
            contact=config.retarget.contact,
            lip_response=binding.lip_response(),
        )
    except np.linalg.LinAlgError as error:
        raise MeshError(
            f"The mesh '{target.name}' cannot be bound to the {len(names)} markers that it shares with the "
            f"corpus ({error}); spread its marker vertices over the face and pair its inner lips."
        ) from error
    return Head(target, names, retargeter, binding)


@one_thread
def animate(head: Head, trajectory: Trajectory) -> Animation:
    """Retarget a trajectory to a head.

    Parameters
    ----------
    head : Head
    trajectory : Trajectory
        Marker motion in the actor's head-stabilised space.
    """
    columns = [trajectory.names.index(n) for n in head.names]
    targets = head.retargeter(np.asarray(trajectory.values_mm)[:, columns])
    return Animation(trajectory.times_s, targets, head.binding.rigid(targets))


@one_thread
def vertex_frames(head: Head, animation: Animation) -> npt.NDArray[np.float32]:
    """Deform the mesh in every frame, rigid parts included: (n_frames, n_vertices, 3) float32, mm."""
    return head.binding.apply(animation.targets_mm, rigid=animation.rigid)
