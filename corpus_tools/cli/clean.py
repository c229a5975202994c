"""``corpus-tools clean``: what cleaning does to a corpus, told and drawn."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from corpus_tools.cli.common import PATH, check_out_folder, emit_json, progress_bar, say
from corpus_tools.config import Config, load_config
from corpus_tools.pipeline import clean_corpus, cleaning_lines, cleaning_report, read_corpus, write_cleaning

__all__ = ["register"]


def clean(
    corpus: Annotated[Path, typer.Argument(**PATH, help="Corpus folder (with corpus.toml).")],
    out: Annotated[
        Path | None, typer.Option("--out", **PATH, help="Folder for cleaning.json and report.html.")
    ] = None,
    config: Annotated[
        Path | None, typer.Option("--config", **PATH, help="Config file; its section cleaning is used.")
    ] = None,
    json_: Annotated[bool, typer.Option("--json", help="Print one JSON object as the last line.")] = False,
) -> None:
    """Clean all recordings and say what was found: gaps, spikes, swaps, slips, head motion, timing.

    Nothing is applied to the recordings: synthesis cleans in the same way each time it opens a corpus.

    Example: corpus-tools clean WORK --out OUT
    """
    if out is not None:
        check_out_folder(out, corpus)
    settings = load_config(config) if config is not None else Config()
    with progress_bar("reading") as progress:
        raw = read_corpus(corpus, lambda f, w: progress(0.4 * f, w), unlabelled=True)
        cleaned = clean_corpus(raw, settings, progress=lambda f, w: progress(0.4 + 0.5 * f, w))
        report = cleaning_report(raw, cleaned, lambda f, w: progress(0.9 + 0.1 * f, w))
        if out is not None:
            write_cleaning(out, report)
    for line in cleaning_lines(report):
        say(line)
    if out is not None:
        say(f"{out / 'report.html'} shows it.")
    if json_:
        for row in report["recordings"]:  # a number for every frame is drawn, and written to cleaning.json
            del row["head"]["residual_mm"], row["flagged_by_frame"]
        emit_json(report)


def register(app: typer.Typer) -> None:
    """Enter the command in the app."""
    app.command("clean")(clean)
