"""``corpus-tools bench``: how long each stage takes here, as ratios against named peers in the same run."""

from __future__ import annotations

import json
import os
import platform
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from scipy.interpolate import CubicSpline, RBFInterpolator

from corpus_tools.cli.common import emit_json, progress_bar, say
from corpus_tools.config import Config, config_with
from corpus_tools.core import Interval, OutputError, Recording, Tier, Utterance, atomic_file, check_writable
from corpus_tools.demo import simulate_corpus
from corpus_tools.fragments import build_inventory, cut_fragment
from corpus_tools.pipeline import (
    Head,
    OpenCorpus,
    align_units,
    animate,
    blend_units,
    library_versions,
    open_corpus,
    prepare_head,
    select_units,
    synthesise,
    vertex_frames,
)
from corpus_tools.synthesis import prepare_selection, select_greedy, select_viterbi

__all__ = ["best_ms", "register", "run_bench"]

Report = dict[str, Any]


def best_ms(call: Callable[[], Any], repeats: int = 3) -> float:
    """Return the shortest of `repeats` runs in ms, after one warm-up."""
    call()
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        call()
        times.append(1000 * (time.perf_counter() - start))
    return min(times)


def _row(what: str, ours_ms: float, peer: str = "", peer_ms: float | None = None, bar: str = "") -> Report:
    row: Report = {"what": what, "ours_ms": round(ours_ms, 3), "bar": bar}
    if peer_ms is not None:
        row |= {"peer": peer, "peer_ms": round(peer_ms, 3), "peer_over_ours": round(peer_ms / ours_ms, 3)}
    return row


def _longest(corpus: OpenCorpus) -> Utterance:
    return max((r.utterance for r in corpus.recordings), key=lambda u: u.duration_s)


def _bench_synthesis(corpus: OpenCorpus, head: Head) -> list[Report]:
    config = Config()
    target = _longest(corpus)
    hold = (target.name,)
    label = f"{target.duration_s:.1f} s, {len(target.phones)} phones, {head.mesh.n_vertices} vertices"
    rows = []
    for method in ("viterbi", "greedy"):
        settings = config_with(config, selection__method=method)
        total = best_ms(lambda settings=settings: synthesise(corpus, target, settings, head, hold))  # type: ignore[misc]
        rows.append(_row(f"utterance to mesh frames, warm, {method}: {label}", total, bar="60 ms per 2.5 s"))
    selection = select_units(corpus, target, config, hold)
    pieces = align_units(corpus, target, selection, config)
    rows.append(
        _row("g(u) changed: blend and close", best_ms(lambda: blend_units(corpus, target, pieces, config)))
    )
    trajectory = blend_units(corpus, target, pieces, config)
    rows.append(_row("g(u) changed: retarget", best_ms(lambda: animate(head, trajectory))))
    return rows


def _bench_deform(corpus: OpenCorpus, head: Head) -> list[Report]:
    target = _longest(corpus)
    config = Config()
    selection = select_units(corpus, target, config, (target.name,))
    pieces = align_units(corpus, target, selection, config)
    animation = animate(head, blend_units(corpus, target, pieces, config))
    basis = np.asarray(head.binding.basis, dtype=np.float64)
    rest = head.mesh.vertices_mm
    shift = np.asarray(animation.targets_mm) - rest[[head.mesh.markers[n] for n in head.names]]

    def gemm() -> list[Any]:
        return [rest + basis @ frame for frame in shift]

    ours = best_ms(lambda: vertex_frames(head, animation))
    what = f"deform {len(shift)} frames of {head.mesh.n_vertices} vertices, float32 batch"
    return [_row(what, ours, "numpy matmul, float64, frame by frame", best_ms(gemm))]


def _bench_warp(corpus: OpenCorpus, head: Head) -> list[Report]:
    recording = max(corpus.recordings, key=lambda r: r.capture.n_frames)
    columns = [corpus.markers.index(n) for n in head.names]
    motion = np.asarray(recording.capture.positions_mm)[:, columns][:300]
    rest = head.mesh.vertices_mm[[head.mesh.markers[n] for n in head.names]]
    peer = RBFInterpolator(corpus.neutral_mm[columns], rest, kernel="cubic", degree=1)
    ours = best_ms(lambda: head.retargeter(motion))
    theirs = best_ms(lambda: peer(motion.reshape(-1, 3)))
    what = f"retarget {len(motion)} frames of {len(columns)} markers, lip contact included"
    return [_row(what, ours, "scipy RBFInterpolator, warp only", theirs, "60 ms per 1000 frames (warp)")]


def _bench_resampling(corpus: OpenCorpus) -> list[Report]:
    target = _longest(corpus)
    config = Config()
    selection = select_units(corpus, target, config, (target.name,))
    fragments = [cut_fragment(corpus.inventory, c.unit, context_s=0.4) for c in selection.chosen]
    times = np.arange(int(120 * target.duration_s)) / 120

    def splines() -> None:
        for fragment in fragments:
            CubicSpline(fragment.times_s, fragment.motion_mm)(times)

    ours = best_ms(lambda: align_units(corpus, target, selection, config))
    return [_row("align and resample all fragments to 120 Hz", ours, "scipy CubicSpline", best_ms(splines))]


def _rows_of_phones(corpus: OpenCorpus, n: int) -> list[Recording]:
    """Return simulated recordings of about `n` phones in all: the corpus over and over, under new names."""
    recordings: list[Recording] = []
    count = 0
    while count < n:
        for r in corpus.recordings:
            name = f"{r.name}-{len(recordings)}"
            utterance = Utterance(name, r.utterance.text, r.utterance.phones)
            recordings.append(Recording(utterance, r.capture))
            count += len(r.utterance.phones)
            if count >= n:
                break
    return recordings


def _thirty(corpus: OpenCorpus) -> Utterance:
    target = _longest(corpus)
    phones = target.phones.intervals[:30]
    return Utterance(
        "target", "", Tier("phones", tuple(Interval(p.start_s, p.end_s, p.text) for p in phones))
    )


def _bench_selection(corpus: OpenCorpus, n_phones: int) -> list[Report]:
    recordings = _rows_of_phones(corpus, n_phones)
    build = best_ms(lambda: build_inventory(recordings), 1)
    model = prepare_selection(build_inventory(recordings), corpus.phones)
    target = _thirty(corpus)
    greedy = best_ms(lambda: select_greedy(model, target))
    viterbi = best_ms(lambda: select_viterbi(model, target))
    size = f"{model.inventory.n_phones} phones"
    return [
        _row(f"index of {size}", build, bar="100 ms at 1e5, 1500 ms at 1e6"),
        _row(f"greedy, {len(target.phones)}-phone target, {size}", greedy),
        _row(
            f"viterbi, {len(target.phones)}-phone target, {size}", viterbi, "greedy", greedy, "30 ms at 1e5"
        ),
    ]


def run_bench(corpus: OpenCorpus, full: bool = False) -> Report:
    """Measure every stage on `corpus`.

    Parameters
    ----------
    corpus : OpenCorpus
    full : bool
        Also measure the index and both searches at 1e5 phones.

    Returns
    -------
    dict
        ``rows``: what, ours_ms, and where there is one: peer, peer_ms, peer_over_ours, bar.
    """
    head = prepare_head(corpus, "base", Config())
    rows = _bench_synthesis(corpus, head)
    for measure in (_bench_deform, _bench_warp):
        rows += measure(corpus, head)
    rows += _bench_resampling(corpus)
    rows += _bench_selection(corpus, 100_000 if full else 10_000)
    return {
        "corpus": corpus.description.name,
        "rows": rows,
        "machine": {"cores": os.cpu_count(), "system": platform.platform(), **library_versions()},
    }


def bench(
    out: Annotated[Path, typer.Option("--out", help="JSON file for the figures.")],
    corpus: Annotated[
        Path | None, typer.Option("--corpus", help="A corpus of your own; else a simulated one.")
    ] = None,
    full: Annotated[bool, typer.Option("--full", help="Also the large sizes; takes minutes.")] = False,
    json_: Annotated[bool, typer.Option("--json", help="Print one JSON object as the last line.")] = False,
) -> None:
    """Time every stage (best of 3 after a warm-up) against named peers in the same run."""
    check_writable(out.parent)
    if out.is_dir():
        raise OutputError(f"Cannot write '{out}': it is a folder; name a file for --out.")
    with tempfile.TemporaryDirectory() as folder, progress_bar("measuring") as progress:
        if corpus is None:
            simulate_corpus(Path(folder) / "simulated", progress=lambda f, w: progress(0.3 * f, w))
            corpus = Path(folder) / "simulated"
        opened = open_corpus(corpus, progress=lambda f, w: progress(0.3 + 0.2 * f, w))
        progress(0.5, "measuring")
        report = run_bench(opened, full)
    with atomic_file(out) as temporary:
        temporary.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    for row in report["rows"]:
        peer = (
            f"   {row['peer']}: {row['peer_ms']:.1f} ms, x{row['peer_over_ours']:.2f}"
            if "peer" in row
            else ""
        )
        say(f"{row['ours_ms']:9.2f} ms  {row['what']}{peer}")
    if json_:
        emit_json(report)


def register(app: typer.Typer) -> None:
    """Enter the command in the app."""
    app.command("bench")(bench)
