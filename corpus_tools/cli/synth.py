"""``corpus-tools synth``: one utterance, from text, labels or a recording to a moving head."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from corpus_tools.cli.common import PATH, check_out_folder, emit_json, progress_bar, say
from corpus_tools.cli.contact_facts import contact_facts, contact_line
from corpus_tools.cli.join_facts import join_facts, join_line
from corpus_tools.cli.targets import SpeakRequest
from corpus_tools.config import Config, ConfigBase, config_with, load_config
from corpus_tools.core import InputError, NoUnitError, SynthesisError, Utterance, counted
from corpus_tools.mesh import mesh_by_name_or_file
from corpus_tools.methods import SEARCHES
from corpus_tools.pipeline import (
    Head,
    OpenCorpus,
    Synthesis,
    banned_pins,
    corpus_provenance,
    listed_files,
    open_corpus,
    prepare_head,
    remove_stale,
    sound_problem,
    speech_facts,
    synthesise,
    write_synthesis,
)
from corpus_tools.render import EXPORTERS, check_exports, export_all, export_names, is_export_folder
from corpus_tools.synthesis import StandIn, stand_ins, stand_ins_told

__all__ = ["register"]


OPTIONS = {
    "speech__language": "--lang",
    "speech__engine": "--engine",
    "speech__voice": "--voice",
    "speech__rate": "--rate",
    "speech__sound": "--sound",
    "selection__method": "--method",
    "deform__mesh": "--mesh",
    "alignment__rate_hz": "--fps",
    "output__seed": "--seed",
    "film__rate_hz": "--film-fps",
}
"""Values of a config that have an option of their own."""


def _config(path: Path | None, typed: dict[str, Any]) -> ConfigBase:
    """Return the config of the command line: that of the file, with the options that were given."""
    config = load_config(path) if path else Config()
    given = {key: typed[option] for key, option in OPTIONS.items() if typed[option] is not None}
    config = config_with(config, options=OPTIONS, **given)
    if typed["--sound"] == "units" and not config.selection.sound:
        config = config_with(config, selection__sound=1.0)
    SEARCHES[config.selection.method]
    return config


def _few(names: Sequence[str], most: int = 3) -> str:
    """Return the first names, and how many more there are."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(list(names)[:most]) + more


def _left_out(opened: OpenCorpus) -> str:
    """Return a clause on the recordings that could not be used, empty without any."""
    if not opened.skipped:
        return ""
    names = ", ".join(list(opened.skipped)[:3]) + (", ..." if len(opened.skipped) > 3 else "")
    n = counted(len(opened.skipped), "recording was", "recordings were")
    return f"{n} left out ({names}); 'corpus-tools check' says why."


def _synthesise(
    opened: OpenCorpus, target: Utterance, settings: ConfigBase, head: Head, exclude: tuple[str, ...]
) -> Synthesis:
    try:
        return synthesise(opened, target, settings, head, exclude)
    except NoUnitError as error:
        if not opened.skipped:
            raise
        raise SynthesisError(f"{str(error).rstrip('.')}; {_left_out(opened)}") from error


def _as_row(stand_in: StandIn) -> dict[str, Any]:
    return {
        "diphone": "-".join(stand_in.diphone),
        "stood_in": "-".join(stand_in.used),
        "time_s": round(stand_in.time_s, 4),
        "unit": stand_in.source,
        "differs": stand_in.differs,
    }


def _summary(
    synthesis: Synthesis, missing: Sequence[StandIn], opened: OpenCorpus, settings: ConfigBase, out: Path
) -> dict[str, Any]:
    return {
        "out": str(out),
        "utterance": synthesis.utterance.name,
        "speech": speech_facts(synthesis.utterance),
        "sound_problem": sound_problem(synthesis.utterance),
        "frames": len(synthesis.trajectory.times_s),
        "fragments": [c.unit.key for c in synthesis.selection.chosen],
        "joins": synthesis.selection.n_joins,
        "join_peaks": join_facts(synthesis.trajectory.joins),
        "contacts": contact_facts(synthesis.contacts),
        "cost": synthesis.selection.total_cost,
        "banned_pins": banned_pins(settings),
        "missing_diphones": [_as_row(m) for m in missing],
        "timings_ms": {k: round(v, 2) for k, v in synthesis.timings_ms.items()},
        "left_out": opened.skipped,
    }


def _tell(
    summary: dict[str, Any], missing: Sequence[StandIn], n_phones: int, opened: OpenCorpus, labelled: bool
) -> None:
    """Print for people what came out, and what they would not see at once."""
    fragments = summary["fragments"]
    say(
        f"{summary['utterance']}: {counted(summary['frames'], 'frame')} "
        f"from {counted(len(fragments), 'fragment')} "
        f"({', '.join(fragments)}) in {summary['out']}"
    )
    for line in filter(None, (join_line(summary["join_peaks"]), contact_line(summary["contacts"]))):
        say(line)
    most, sentences = stand_ins_told(missing, n_phones - 1)
    for sentence in filter(None, (most, *sentences)):
        say(f"▲ {sentence}")
    for pin, ban in summary["banned_pins"]:
        say(f"▲ The pin '{pin}' speaks what the ban '{ban}' forbids; the pin holds: take one of them out.")
    if labelled and summary["held_out"]:
        say(
            f"The labels are those of the recording {_few(summary['held_out'])}: it is held out "
            "(--include-self lets it be used)."
        )
    if summary["removed"]:
        say(f"Removed what an earlier result left in {summary['out']}: {_few(summary['removed'])}.")
    if summary["speech"]["silent"]:
        say("▲ There is no sound: speech.wav is silence; --audio FILE.wav gives the sound of the labels.")
    if summary["sound_problem"]:
        say(f"▲ {summary['sound_problem']}")
    if opened.skipped:
        say(_left_out(opened))


def synth(
    corpus: Annotated[Path, typer.Argument(**PATH, help="Corpus folder, as 'corpus-tools init' made it.")],
    out: Annotated[
        Path, typer.Option("--out", **PATH, help="Folder for motion.npz, mesh.npz, speech.wav, ...")
    ],
    text: Annotated[str | None, typer.Option("--text", help="Speak this text.")] = None,
    utterance: Annotated[
        str | None, typer.Option("--utterance", help="Speak this recording's sentence.")
    ] = None,
    labels: Annotated[
        Path | None,
        typer.Option(
            "--labels",
            **PATH,
            help="Speak the timed phones of a TextGrid; the recording that has them is held out.",
        ),
    ] = None,
    audio: Annotated[
        Path | None, typer.Option("--audio", **PATH, help="Sound that goes with --labels.")
    ] = None,
    lang: Annotated[
        str | None, typer.Option("--lang", help="Language of --text: en, en-gb, ...; the corpus's own.")
    ] = None,
    engine: Annotated[
        str | None, typer.Option("--engine", help="Who speaks --text: espeak, the embedded voice.")
    ] = None,
    voice: Annotated[str | None, typer.Option("--voice", help="Variant of the voice, such as f2.")] = None,
    rate: Annotated[
        float | None, typer.Option("--rate", help="Speaking rate: 1 as usual, 2 twice as fast.")
    ] = None,
    sound: Annotated[
        str | None,
        typer.Option(
            "--sound",
            help="voice, or units: the sound of the chosen fragments, in their own times; how they sound at "
            "a join then counts as their posture does (selection.sound).",
        ),
    ] = None,
    method: Annotated[str | None, typer.Option("--method", help="greedy or viterbi.")] = None,
    config: Annotated[
        Path | None, typer.Option("--config", **PATH, help="A config exported from the workbench.")
    ] = None,
    mesh: Annotated[
        str | None, typer.Option("--mesh", help="A bundled head by name, or a mesh file.")
    ] = None,
    fps: Annotated[float | None, typer.Option("--fps", help="Frames per second of the motion.")] = None,
    seed: Annotated[int | None, typer.Option("--seed", help="Seed of everything random.")] = None,
    export: Annotated[
        str | None, typer.Option("--export", help=f"Also write, by comma: {', '.join(EXPORTERS)}.")
    ] = None,
    film_fps: Annotated[
        float | None, typer.Option("--film-fps", help="Pictures per second of the film (30).")
    ] = None,
    include_self: Annotated[
        bool, typer.Option("--include-self", help="Let the utterance's own recording be used.")
    ] = False,
    json_: Annotated[bool, typer.Option("--json", help="Print one JSON object as the last line.")] = False,
) -> None:
    """Synthesise one utterance: a text, a recording of the corpus, or labels.

    The recording itself is held out: that of --utterance, and any with the phones and times of --labels.
    --include-self lets it be used.

    Example: corpus-tools synth WORK --text "place blue by f two now" --out OUT

    Example: corpus-tools synth WORK --utterance bbaf2n --method viterbi --out OUT
    """
    spoken = {"--lang": lang, "--engine": engine, "--voice": voice, "--rate": rate}
    other = {
        "--method": method,
        "--sound": sound,
        "--mesh": mesh,
        "--fps": fps,
        "--seed": seed,
        "--film-fps": film_fps,
    }
    asked = SpeakRequest(text, utterance, labels, audio, tuple(k for k, v in spoken.items() if v is not None))
    settings = _config(config, spoken | other)
    asked.check(settings)
    exports = export_names(export)
    if film_fps is not None and not {"mp4", "frames"} & set(exports):
        raise InputError("--film-fps goes with --export mp4 or frames; --fps is the rate of the motion.")
    check_out_folder(out, corpus)
    check_exports(exports, out)
    head_mesh = mesh_by_name_or_file(settings.deform.mesh)
    with progress_bar("opening the corpus") as progress:
        share = 0.3 if exports else 0.95  # of the bar, for what comes before the exports
        opened = open_corpus(corpus, settings, lambda f, w: progress(0.85 * share * f, w))
        target, request = asked.target(opened, settings)
        own = asked.own_recordings(opened, target)
        exclude = () if include_self else own
        progress(0.87 * share, "binding the head")
        head = prepare_head(opened, head_mesh, settings)
        progress(0.93 * share, "synthesising")
        synthesis = _synthesise(opened, target, settings, head, exclude)
        progress(share, "writing")
        request["held_out"] = list(exclude)
        extra = functools.partial(
            export_all,
            exports,
            synthesis=synthesis,
            head=head,
            config=settings,
            progress=lambda f, w: progress(share + (1 - share) * f, w),
        )
        provenance, before = corpus_provenance(opened), listed_files(out)
        write_synthesis(
            *(out, synthesis, head, settings, provenance, request),
            exports=extra if exports else None,
            replaceable=is_export_folder,
        )
        removed = remove_stale(out, before)
    missing = stand_ins(synthesis.selection, synthesis.utterance, opened.phones)
    summary = _summary(synthesis, missing, opened, settings, out)
    summary |= {"held_out": list(exclude), "removed": list(removed)}
    _tell(summary, missing, len(target.phones), opened, labels is not None)
    if json_:
        emit_json(summary)


def register(app: typer.Typer) -> None:
    """Enter the command in the app."""
    app.command("synth")(synth)
