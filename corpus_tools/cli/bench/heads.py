"""From markers to vertices: the volume warp and the deformer against their numpy and scipy peers."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.interpolate import RBFInterpolator

from corpus_tools.cli.bench.rows import BENCHMARKS, Ground, Row
from corpus_tools.pipeline import vertex_frames

__all__ = ["measure_deform", "measure_retarget"]


@BENCHMARKS.register("deform")
def measure_deform(ground: Ground) -> list[Row]:
    """Measure the deformer of the config on a whole utterance."""
    head, animation = ground.head, ground.animation
    basis = head.binding.response(np.arange(head.mesh.n_vertices))
    rest = head.mesh.vertices_mm
    shift = np.asarray(animation.targets_mm) - rest[[head.mesh.markers[n] for n in head.names]]

    def gemm() -> list[Any]:
        return [rest + basis @ frame for frame in shift]

    ours = ground.best_ms(lambda: vertex_frames(head, animation))
    what = f"deform {len(shift)} frames of {head.mesh.n_vertices} vertices, float32 batch"
    return [Row(what, ours, peer="numpy matmul, float64, frame by frame", peer_measured=ground.best_ms(gemm))]


@BENCHMARKS.register("retarget")
def measure_retarget(ground: Ground) -> list[Row]:
    """Measure the volume warp with lip contact against scipy's interpolator without."""
    corpus, head = ground.corpus, ground.head
    columns = [corpus.markers.index(n) for n in head.names]
    motion = np.concatenate([np.asarray(r.capture.positions_mm)[:, columns] for r in corpus.recordings])
    motion = np.resize(motion, (1000, *motion.shape[1:]))
    rest = head.mesh.vertices_mm[[head.mesh.markers[n] for n in head.names]]
    peer = RBFInterpolator(corpus.neutral_mm[columns], rest, kernel="cubic", degree=1)
    what = f"retarget {len(motion)} frames of {len(columns)} markers"
    theirs = ground.best_ms(lambda: peer(motion.reshape(-1, 3)))
    warp = ground.best_ms(lambda: head.retargeter.warp(motion))
    both = ground.best_ms(lambda: head.retargeter(motion))
    name = "scipy RBFInterpolator, the same kernel"
    return [
        Row(f"{what}: warp", warp, bar=60.0, peer=name, peer_measured=theirs),
        Row(f"{what}: warp and lip contact", both),
    ]
