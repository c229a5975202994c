"""``corpus-tools init|check|units|coverage``: a folder of recordings becomes a corpus, and what is in it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from textwrap import wrap
from typing import Annotated, Any

import typer

from corpus_tools.cli.common import PATH, emit_json, progress_bar, say
from corpus_tools.core import InputError, counted
from corpus_tools.fragments import coverage, unit_views
from corpus_tools.io import find_recordings, init_corpus
from corpus_tools.pipeline import check_corpus, health_lines, open_corpus
from corpus_tools.speech import phone_set

__all__ = ["register"]

Folder = Annotated[Path, typer.Argument(**PATH, help="Corpus folder (with corpus.toml).")]
MOST_SENTENCES = 10
"""Sentences that `coverage` names, least covered first (our choice: a screen is read, not a list of all)."""
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object as the last line.")]


def _settings(pairs: list[str]) -> dict[str, str]:
    settings: dict[str, str] = {}
    for pair in pairs:
        key, sign, value = pair.partition("=")
        if not sign or not key.strip():
            raise InputError(f"--set '{pair}' is not of the form KEY=VALUE, as in --set frame_time=centre.")
        settings[key.strip()] = value.strip()
    return settings


def init(
    folder: Annotated[Path, typer.Argument(**PATH, help="New folder for corpus.toml and the work files.")],
    motion: Annotated[
        str,
        typer.Option(
            "--motion", help="Pattern of the motion files (npz, c3d, trc, csv, mat), e.g. 'm/{id}.c3d'."
        ),
    ],
    audio: Annotated[str | None, typer.Option("--audio", help="Pattern of the sound files.")] = None,
    labels: Annotated[str | None, typer.Option("--labels", help="Pattern of the TextGrids.")] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            help="KEY=VALUE for corpus.toml: frame_time=start|centre, head_scale=true|false, phones=arpabet, "
            "marker_units=mm, marker_axes=x,z,-y, rate_hz=120, "
            "reference_markers='head*', language=en, ... May stand several times.",
        ),
    ] = None,
    json_: Json = False,
) -> None:
    """Describe existing recordings as a corpus: they are used where they are, never copied or altered.

    Example: corpus-tools init WORK --motion 'm/{id}.npz' --audio 'a/{id}.wav' --labels 't/{id}.TextGrid'
    """
    settings = _settings(set_ or [])
    if settings.get("phones"):
        phone_set(settings["phones"])  # an unknown one is refused before anything is written
    description = init_corpus(folder, motion=motion, audio=audio, labels=labels, settings=settings)
    found = find_recordings(description)
    told = counted(len(found), "recording")
    for what, pattern in (("audio", description.audio), ("labels", description.labels)):
        have = sum(getattr(files, what) is not None for files in found)
        if pattern and have < len(found):
            told += f", {have} with {what}"
    say(f"{folder / 'corpus.toml'}: {told}. Next: corpus-tools check {folder}")
    if json_:
        emit_json({"corpus": str(folder), "recordings": len(found)})


def check(corpus: Folder, json_: Json = False) -> None:
    """Say what is in a corpus and what to mend: rates, gaps, missing files, labels, lengths, head scale."""
    with progress_bar("reading") as progress:
        report = check_corpus(corpus, progress)
    if json_:
        emit_json(report)
        return
    for line in health_lines(report):
        say(line)


def units(corpus: Folder, json_: Json = False) -> None:
    """Count the units that the recordings give: sentences, words, syllables, diphones."""
    with progress_bar("reading") as progress:
        opened = open_corpus(corpus, progress=progress)
    views = unit_views(opened.inventory)
    data: dict[str, Any] = {
        "corpus": opened.description.name,
        "recordings": len(opened.recordings),
        **views.as_dict(),
    }
    for key, value in data.items():
        if not isinstance(value, dict | list):
            say(f"{key.replace('_', ' ')}: {value}")
    if json_:
        emit_json(data)


def coverage_(corpus: Folder, json_: Json = False) -> None:
    """Say which diphones the corpus covers, and how much of each sentence the others cover."""
    with progress_bar("reading") as progress:
        opened = open_corpus(corpus, progress=progress)
    report = coverage(opened.inventory, [r.utterance for r in opened.recordings], leave_one_out=True)
    data = report.as_dict()
    types, sentences = counted(data["n_diphone_types"], "diphone type"), data["n_utterances"]
    say(
        f"{types}; leave-one-out coverage mean {data['mean']:.3f}, least {data['min']:.3f}; "
        f"{data['n_full']} of {counted(sentences, 'sentence')} fully covered."
    )
    for line in _diphone_lines(data):
        say(line)
    if json_:
        emit_json(data)


def _diphone_lines(data: dict[str, Any]) -> Iterator[str]:
    """Tell the diphones, most frequent first, then the sentences that the others cover least."""
    often = sorted(data["diphones"].items(), key=lambda item: (-item[1], item[0]))
    yield "Diphones, with how often each was recorded:"
    told = ", ".join(f"{diphone}\u00a0{n}" for diphone, n in often)  # a line never ends inside one
    for row in wrap(told, 96, break_on_hyphens=False):
        yield "  " + row.replace("\u00a0", " ")
    least = sorted((u for u in data["utterances"] if u["missing"]), key=lambda u: (u["coverage"], u["id"]))
    if not least:
        return
    yield "Sentences that the others cover least:"
    for u in least[:MOST_SENTENCES]:
        yield f"  {u['id']}  {u['coverage']:.3f}  lacks {', '.join(u['missing'])}"
    if len(least) > MOST_SENTENCES:
        yield f"  and {counted(len(least) - MOST_SENTENCES, 'more sentence')} (all of them with --json)"


def register(app: typer.Typer) -> None:
    """Enter the commands in the app."""
    app.command("init")(init)
    app.command("check")(check)
    app.command("units")(units)
    app.command("coverage")(coverage_)
