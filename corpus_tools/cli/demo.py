"""``corpus-tools demo``: a simulated corpus to begin with."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from corpus_tools.cli.common import emit_json, progress_bar, say
from corpus_tools.core import OutputError
from corpus_tools.demo import simulate_corpus
from corpus_tools.io import find_recordings

__all__ = ["register"]


def demo(
    folder: Annotated[Path, typer.Argument(help="New folder for the simulated corpus.")],
    seed: Annotated[
        int, typer.Option("--seed", min=0, help="Another seed is another recording session.")
    ] = 0,
    json_: Annotated[bool, typer.Option("--json", help="Print one JSON object as the last line.")] = False,
) -> None:
    """Make a small simulated corpus: time sentences, 73 markers at 120 Hz, sound, labels."""
    if folder.exists() and any(folder.iterdir() if folder.is_dir() else [folder]):
        raise OutputError(f"'{folder}' is there already; name a new folder for the simulated corpus.")
    with progress_bar("simulating") as progress:
        description = simulate_corpus(folder, seed=seed, progress=progress)
    n = len(find_recordings(description))
    say(f"{folder}: {n} simulated recordings. Next: corpus-tools check {folder}, or: workbench {folder}")
    if json_:
        emit_json({"corpus": str(folder), "recordings": n, "simulated": True})


def register(app: typer.Typer) -> None:
    """Enter the command in the app."""
    app.command("demo")(demo)
