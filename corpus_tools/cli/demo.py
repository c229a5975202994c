"""``corpus-tools demo``: a simulated corpus to begin with."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from corpus_tools.cli.common import PATH, emit_json, progress_bar, say
from corpus_tools.core import InputError, OutputError, counted
from corpus_tools.demo import LAYOUTS, N_SENTENCES, all_sentences, simulate_corpus, usual_voice
from corpus_tools.io import find_recordings

__all__ = ["register"]


def demo(
    folder: Annotated[Path, typer.Argument(**PATH, help="New folder for the simulated corpus.")],
    sentences: Annotated[
        int, typer.Option("--sentences", help="How many of the 2880 time sentences to record.")
    ] = N_SENTENCES,
    seed: Annotated[
        int, typer.Option("--seed", min=0, help="Another seed is another recording session.")
    ] = 0,
    layout: Annotated[
        str, typer.Option("--layout", help=f"Which markers there are: {', '.join(LAYOUTS)}.")
    ] = "full",
    json_: Annotated[bool, typer.Option("--json", help="Print one JSON object as the last line.")] = False,
) -> None:
    """Make a simulated corpus: time sentences of the embedded voice, 66 + 7 markers at 120 Hz, labels."""
    if folder.exists() and any(folder.iterdir() if folder.is_dir() else [folder]):
        raise OutputError(f"'{folder}' is there already; name a new folder for the simulated corpus.")
    if not 1 <= sentences <= len(all_sentences()):
        raise InputError(f"--sentences {sentences}: a number from 1 to {len(all_sentences())} was expected.")
    voice = usual_voice()
    with progress_bar("simulating") as progress:
        description = simulate_corpus(folder, sentences, seed, progress, layout=layout, voice=voice)
    n = len(find_recordings(description))
    say(f"{folder}: {counted(n, 'simulated recording')}, spoken by {voice.summary}.")
    say(f"Next: corpus-tools check {folder}, or: workbench {folder}")
    if json_:
        emit_json({"corpus": str(folder), "recordings": n, "simulated": True, "voice": voice.name})


def register(app: typer.Typer) -> None:
    """Enter the command in the app."""
    app.command("demo")(demo)
