"""``corpus-tools warps``: what time warp and resampling do to the fragments of an utterance."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from corpus_tools.cli.common import PATH, emit_json, progress_bar, say
from corpus_tools.cli.targets import SpeakRequest
from corpus_tools.config import Config, load_config
from corpus_tools.core import counted
from corpus_tools.pipeline import compare_alignments, open_corpus, select_units
from corpus_tools.synthesis import AlignmentFacts

__all__ = ["register"]

MOST_PHONES = 5
"""Stretched phones that are named (our choice: those that are looked at first)."""


def _lines(facts: AlignmentFacts) -> Iterator[str]:
    first = facts.ways[0]
    heads = ("differs, mm", "at most", "jump, mm/s", "join peak", "cond")
    yield f"{'warp':<8}{'resampling':<12}" + "".join(f"{head:>12}" for head in heads)
    for way in facts.ways:
        yield (
            f"{way.warp:<8}{way.resampling:<12}{way.rms_mm:>12.4f}{way.largest_mm:>12.3f}"
            f"{way.jump_mm_s:>12.2f}{way.peak_ratio:>12.2f}{way.cond:>12.0e}"
        )
    yield (
        f"differs: rms and largest distance of a marker from '{first.warp} {first.resampling}'; jump: of the "
        "velocity at labels, p95; join peak: largest acceleration at a join over natural p95."
    )
    most = facts.stretches[:MOST_PHONES]
    if most:
        told = ", ".join(f"{s.phone} at {s.time_s:.2f} s x{s.factor:.2f} ({s.source})" for s in most)
        yield f"Most stretched or shortened: {told}."
    if facts.merged:
        yield f"{counted(facts.merged, 'label')} fell together with a neighbour and bend the warp no more."
    share = 100.0 * facts.outside / max(facts.samples, 1)
    yield (
        f"{counted(facts.outside, 'sample')} of {facts.samples} ({share:.1f} %) would lie outside what was "
        "captured: the end is held there, and flagged."
    )


def warps(
    corpus: Annotated[Path, typer.Argument(**PATH, help="Corpus folder, as 'corpus-tools init' made it.")],
    text: Annotated[str | None, typer.Option("--text", help="Speak this text.")] = None,
    utterance: Annotated[
        str | None, typer.Option("--utterance", help="Speak this recording's sentence; it is held out.")
    ] = None,
    labels: Annotated[
        Path | None, typer.Option("--labels", **PATH, help="Speak the timed phones of a TextGrid.")
    ] = None,
    config: Annotated[
        Path | None, typer.Option("--config", **PATH, help="A config exported from the workbench.")
    ] = None,
    json_: Annotated[bool, typer.Option("--json", help="Print one JSON object as the last line.")] = False,
) -> None:
    """Compare both time warps and both ways of resampling on the fragments that speak an utterance.

    Example: corpus-tools warps WORK --utterance bbaf2n
    """
    settings = load_config(config) if config else Config()
    asked = SpeakRequest(text, utterance, labels)
    asked.check(settings)
    with progress_bar("opening the corpus") as progress:
        opened = open_corpus(corpus, settings, lambda f, w: progress(0.9 * f, w))
        target, _ = asked.target(opened, settings)
        progress(0.9, "aligning")
        selection = select_units(opened, target, settings, asked.own_recordings(opened, target))
        facts = compare_alignments(opened, target, selection, settings)
    for line in _lines(facts):
        say(line)
    if json_:
        emit_json({"utterance": target.name, **facts.as_dict()})


def register(app: typer.Typer) -> None:
    """Enter the command in the app."""
    app.command("warps")(warps)
