"""``corpus-tools synth``: one utterance, from labels to a moving head."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from corpus_tools.cli.common import emit_json, progress_bar, say
from corpus_tools.config import Config, ConfigBase, config_with, load_config
from corpus_tools.core import InputError, NoUnitError, OutputError, SynthesisError, Utterance, check_writable
from corpus_tools.io import find_recordings, read_audio, read_description, read_labels
from corpus_tools.mesh import mesh_by_name_or_file
from corpus_tools.methods import METHODS
from corpus_tools.pipeline import (
    Head,
    OpenCorpus,
    Synthesis,
    corpus_provenance,
    open_corpus,
    prepare_head,
    synthesise,
    write_synthesis,
)
from corpus_tools.speech import labelled_utterance

__all__ = ["register"]


def _config(
    path: Path | None, method: str | None, mesh: str | None, fps: float | None, seed: int | None
) -> ConfigBase:
    config = load_config(path) if path else Config()
    changes: dict[str, Any] = {
        "selection__method": method,
        "deform__mesh": mesh,
        "alignment__rate_hz": fps,
        "output__seed": seed,
    }
    config = config_with(config, **{k: v for k, v in changes.items() if v is not None})
    METHODS[config.selection.method]
    return config


def _target(
    corpus: OpenCorpus, utterance: str | None, labels: Path | None, audio: Path | None
) -> tuple[Utterance, dict[str, Any]]:
    if utterance is not None:
        return corpus.utterance(utterance), {"utterance": utterance}
    assert labels is not None
    sound = read_audio(audio) if audio else None
    target = labelled_utterance(
        labels.stem,
        read_labels(labels),
        sound,
        corpus.phones,
        phone_tier=corpus.description.phone_tier,
        word_tier=corpus.description.word_tier,
        source=str(labels),
    )
    return target, {"labels": labels.name, "audio": audio.name if audio else None}


def _check_request(utterance: str | None, labels: Path | None, audio: Path | None) -> None:
    if (utterance is None) == (labels is None):
        raise InputError(
            "Say what to speak: either --utterance NAME or --labels FILE.TextGrid (one of them)."
        )
    if audio is not None and labels is None:
        raise InputError(
            "--audio goes with --labels FILE.TextGrid; a recorded utterance brings its own sound."
        )


def _check_out(out: Path, corpus: Path) -> None:
    """Refuse a folder that holds recordings: what is written must neither replace nor become one."""
    check_writable(out)
    description = read_description(corpus)
    folders = {description.folder.resolve()}
    for files in find_recordings(description):
        folders |= {p.parent.resolve() for p in (files.motion, files.audio, files.labels) if p}
    if out.resolve() in folders:
        raise OutputError(f"'{out}' belongs to the corpus '{corpus}'; choose a folder of its own for --out.")


def _left_out(opened: OpenCorpus) -> str:
    """Return a clause on the recordings that could not be used, empty without any."""
    if not opened.skipped:
        return ""
    names = ", ".join(list(opened.skipped)[:3]) + (", ..." if len(opened.skipped) > 3 else "")
    return f"{len(opened.skipped)} recordings were left out ({names}); 'corpus-tools check' says why."


def _synthesise(
    opened: OpenCorpus, target: Utterance, settings: ConfigBase, head: Head, exclude: tuple[str, ...]
) -> Synthesis:
    try:
        return synthesise(opened, target, settings, head, exclude)
    except NoUnitError as error:
        if not opened.skipped:
            raise
        raise SynthesisError(f"{str(error).rstrip('.')}; {_left_out(opened)}") from error


def _summary(synthesis: Synthesis, opened: OpenCorpus, out: Path) -> dict[str, Any]:
    return {
        "out": str(out),
        "utterance": synthesis.utterance.name,
        "frames": len(synthesis.trajectory.times_s),
        "fragments": [c.unit.key for c in synthesis.selection.chosen],
        "joins": synthesis.selection.n_joins,
        "cost": synthesis.selection.total_cost,
        "timings_ms": {k: round(v, 2) for k, v in synthesis.timings_ms.items()},
        "left_out": opened.skipped,
    }


def synth(
    corpus: Annotated[Path, typer.Argument(help="Corpus folder, as 'corpus-tools init' made it.")],
    out: Annotated[Path, typer.Option("--out", help="Folder for motion.npz, mesh.npz, speech.wav, ...")],
    utterance: Annotated[
        str | None, typer.Option("--utterance", help="Speak this recording's sentence.")
    ] = None,
    labels: Annotated[
        Path | None, typer.Option("--labels", help="Speak the timed phones of a TextGrid.")
    ] = None,
    audio: Annotated[Path | None, typer.Option("--audio", help="Sound that goes with --labels.")] = None,
    method: Annotated[str | None, typer.Option("--method", help="greedy or viterbi.")] = None,
    config: Annotated[
        Path | None, typer.Option("--config", help="A config exported from the workbench.")
    ] = None,
    mesh: Annotated[
        str | None, typer.Option("--mesh", help="A bundled head by name, or a mesh file.")
    ] = None,
    fps: Annotated[float | None, typer.Option("--fps", help="Frames per second of the motion.")] = None,
    seed: Annotated[int | None, typer.Option("--seed", help="Seed of everything random.")] = None,
    include_self: Annotated[
        bool, typer.Option("--include-self", help="Let the utterance's own recording be used.")
    ] = False,
    json_: Annotated[bool, typer.Option("--json", help="Print one JSON object as the last line.")] = False,
) -> None:
    """Synthesise one utterance; its own recording is kept out of the inventory unless --include-self.

    Example: corpus-tools synth WORK --utterance bbaf2n --method viterbi --out OUT
    """
    _check_request(utterance, labels, audio)
    settings = _config(config, method, mesh, fps, seed)
    _check_out(out, corpus)
    head_mesh = mesh_by_name_or_file(settings.deform.mesh)
    with progress_bar("opening the corpus") as progress:
        opened = open_corpus(corpus, settings, lambda f, w: progress(0.8 * f, w))
        target, request = _target(opened, utterance, labels, audio)
        exclude = () if include_self or utterance is None else (utterance,)
        progress(0.82, "binding the head")
        head = prepare_head(opened, head_mesh, settings)
        progress(0.88, "synthesising")
        synthesis = _synthesise(opened, target, settings, head, exclude)
        progress(0.95, "writing")
        request["held_out"] = list(exclude)
        write_synthesis(out, synthesis, head, settings, corpus_provenance(opened), request)
    summary = _summary(synthesis, opened, out)
    say(
        f"{target.name}: {summary['frames']} frames from {len(summary['fragments'])} fragments "
        f"({', '.join(summary['fragments'])}) in {out}"
    )
    if opened.skipped:
        say(_left_out(opened))
    if json_:
        emit_json(summary)


def register(app: typer.Typer) -> None:
    """Enter the command in the app."""
    app.command("synth")(synth)
