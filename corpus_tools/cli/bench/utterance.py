"""From phones to the frames of a head: the whole, and what a slider of g(u) repeats."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from corpus_tools.cli.bench.rows import BENCHMARKS, TARGET_S, Ground, Row
from corpus_tools.config import config_with
from corpus_tools.fragments import cut_fragment
from corpus_tools.pipeline import Synthesis, align_units, animate, blend_units, synthesise

__all__ = ["measure_resampling", "measure_utterance"]

STAGES = ("select", "align", "blend", "retarget", "deform")


@BENCHMARKS.register("utterance")
def measure_utterance(ground: Ground) -> list[Row]:
    """Measure the whole way by both searches, its stages, and a change of g(u)."""
    corpus, target, head = ground.corpus, ground.target, ground.head
    size = f"{TARGET_S:g} s, {len(target.phones)} phones, 120 Hz, {head.mesh.n_vertices} vertices"
    rows = []
    for method in ("viterbi", "greedy"):
        settings = config_with(ground.config, selection__method=method)
        runs: list[Synthesis] = []
        total = ground.best_ms(
            lambda settings=settings, runs=runs: runs.append(  # type: ignore[misc]
                synthesise(corpus, target, settings, head, ground.held_out)
            )
        )
        rows.append(Row(f"utterance to mesh frames, warm, {method}: {size}", total, bar=60.0))
        best = min(runs, key=lambda run: run.timings_ms["total"]).timings_ms
        rows += [Row(f"   of which {stage}", best[stage]) for stage in STAGES]
    blend = ground.best_ms(lambda: blend_units(corpus, target, ground.pieces, ground.config))
    rows.append(Row("g(u) changed: blend and close", blend))
    rows.append(Row("g(u) changed: retarget", ground.best_ms(lambda: animate(head, ground.trajectory))))
    return rows


@BENCHMARKS.register("resampling")
def measure_resampling(ground: Ground) -> list[Row]:
    """Measure alignment and resampling of all fragments against plain cubic splines."""
    corpus, target, selection = ground.corpus, ground.target, ground.selection
    fragments = [cut_fragment(corpus.inventory, c.unit, context_s=0.4) for c in selection.chosen]
    times = np.arange(int(120 * target.duration_s)) / 120

    def splines() -> None:
        for fragment in fragments:
            CubicSpline(fragment.times_s, fragment.motion_mm)(times)

    ours = ground.best_ms(lambda: align_units(corpus, target, selection, ground.config))
    what = f"align and resample {len(fragments)} fragments to 120 Hz"
    return [Row(what, ours, peer="scipy CubicSpline, no alignment", peer_measured=ground.best_ms(splines))]
