"""The command itself: which topics, where the figures go, and the table that people read."""

from __future__ import annotations

import json
import os
import platform
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

import typer

from corpus_tools.cli.bench.rows import BENCHMARKS, Ground, Row
from corpus_tools.cli.common import PATH, emit_json, progress_bar, say
from corpus_tools.core import InputError, OutputError, atomic_file, check_writable, counted
from corpus_tools.demo import simulate_corpus
from corpus_tools.pipeline import OpenCorpus, Progress, library_versions, open_corpus

__all__ = ["register", "run_bench", "table_lines"]

MARKS = {True: "met", False: "NOT MET", None: ""}


def run_bench(
    corpus: OpenCorpus, topics: Iterable[str], full: bool = False, progress: Progress = lambda f, w: None
) -> dict[str, list[Row]]:
    """Measure topics on a corpus, in the order given.

    Parameters
    ----------
    corpus : OpenCorpus
    topics : iterable of str
        Names in :data:`BENCHMARKS`.
    full : bool
        The large sizes and the slow peers too; takes minutes.
    progress : callable
        ``progress(fraction, what)``.
    """
    ground = Ground(corpus, full)
    names = list(topics)
    found = {}
    for index, name in enumerate(names):
        progress(index / len(names), f"measuring {name}")
        found[name] = BENCHMARKS[name](ground)
    return found


def _limit(row: Row) -> str:
    parts = []
    if row.bar is not None:
        parts.append(f"{'>=' if row.at_least else '<='} {row.bar:g} {row.unit}")
    if row.least_ratio is not None:
        parts.append(f"x{row.least_ratio:g}")
    return ", ".join(parts)


def table_lines(rows: Iterable[Row]) -> list[str]:
    """Return a line a row: figure, bar, whether it is met, what it is, and the peer."""
    lines = []
    for row in rows:
        figure = f"{row.measured:.4g} {row.unit}"
        peer = (
            f"   [{row.peer}: {row.peer_measured:.4g} {row.unit}, x{row.ratio:.3g}]"
            if row.ratio is not None
            else ""
        )
        note = f"   ({row.note})" if row.note else ""
        lines.append(f"{figure:>18}  {_limit(row):<18} {MARKS[row.met]:<8} {row.what}{peer}{note}")
    return lines


def _topics(only: str | None) -> list[str]:
    names = [n.strip() for n in only.split(",") if n.strip()] if only is not None else list(BENCHMARKS)
    for name in names:
        BENCHMARKS[name]
    if not names:
        raise InputError(f"--only names no topic; known: {', '.join(BENCHMARKS)}.")
    return names


def _report(corpus: OpenCorpus, found: dict[str, list[Row]]) -> dict[str, Any]:
    rows = [{"topic": topic, **row.as_dict()} for topic, measured in found.items() for row in measured]
    return {
        "corpus": corpus.description.name,
        "rows": rows,
        "met": sum(row["met"] is True for row in rows),
        "not_met": [row["what"] for row in rows if row["met"] is False],
        "machine": {"cores": os.cpu_count(), "system": platform.platform(), **library_versions()},
    }


def _verdict(met: int, not_met: int) -> str:
    if not met + not_met:
        return "Nothing here has a bar"
    return f"{met} of {counted(met + not_met, 'bar')} met here"


def bench(
    out: Annotated[Path, typer.Option("--out", **PATH, help="JSON file for the figures.")],
    corpus: Annotated[
        Path | None, typer.Option("--corpus", **PATH, help="A corpus of your own; else a simulated one.")
    ] = None,
    only: Annotated[
        str | None, typer.Option("--only", help=f"Topics, by comma, of: {', '.join(BENCHMARKS)}.")
    ] = None,
    full: Annotated[
        bool, typer.Option("--full", help="Also the large sizes and slow peers; takes minutes.")
    ] = False,
    json_: Annotated[bool, typer.Option("--json", help="Print one JSON object as the last line.")] = False,
) -> None:
    """Measure every stage (best of 3 after a warm-up) against its bar and named peers in the same run."""
    topics = _topics(only)
    check_writable(out.parent)
    if out.is_dir():
        raise OutputError(f"Cannot write '{out}': it is a folder; name a file for --out.")
    with tempfile.TemporaryDirectory() as folder, progress_bar("measuring") as progress:
        if corpus is None:
            simulate_corpus(Path(folder) / "simulated", progress=lambda f, w: progress(0.2 * f, w))
            corpus = Path(folder) / "simulated"
        opened = open_corpus(corpus, progress=lambda f, w: progress(0.2 + 0.1 * f, w))
        found = run_bench(opened, topics, full, lambda f, w: progress(0.3 + 0.7 * f, w))
    report = _report(opened, found)
    with atomic_file(out) as temporary:
        temporary.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    for topic, rows in found.items():
        say(topic)
        for line in table_lines(rows):
            say(line)
    say(f"{_verdict(report['met'], len(report['not_met']))}; figures in {out}")
    if json_:
        emit_json(report)


def register(app: typer.Typer) -> None:
    """Enter the command in the app."""
    app.command("bench")(bench)
