"""Is this corpus usable, and what must be mended first: the report behind ``corpus-tools check``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from corpus_tools.cleaning import CleanedCorpus, clean_captures, gaps, remove_head_motion
from corpus_tools.core import Capture, CorpusError, Labels, Utterance, WorkbenchError, counted
from corpus_tools.fragments.posture import bias_rms_mm, posture_offsets_mm
from corpus_tools.io import (
    CorpusDescription,
    RecordingFiles,
    check_word_tier,
    find_recordings,
    load_capture,
    load_labels,
    read_description,
    reading_notes,
)
from corpus_tools.pipeline.lacking import axes_advice, offset_advice, what_is_lacking, what_is_left_out
from corpus_tools.pipeline.reading import Progress, reference_columns, silent
from corpus_tools.pipeline.usable import (
    frozen_problem,
    in_order_of,
    motion_problem,
    seen_markers,
    usual_markers,
)
from corpus_tools.speech import PhoneSet, closure_offset, phone_set, recorded_utterance

__all__ = ["check_corpus", "health_lines"]

SCALE_SD_LIMIT = 0.01
"""Spread of the head scale above which a similarity fit is advised (our choice: GRID has 0.025, optical
capture stays below 0.003)."""


@dataclass(slots=True)
class _Entry:
    files: RecordingFiles
    capture: Capture | None = None
    labels: Labels | None = None
    utterance: Utterance | None = None
    problems: list[str] = field(default_factory=list)

    def row(self) -> dict[str, Any]:
        """Return what ``check --json`` says of one recording."""
        capture = self.capture
        return {
            "id": self.files.id,
            "n_frames": capture.n_frames if capture else 0,
            "rate_hz": capture.rate_hz if capture else None,
            "duration_s": round(capture.duration_s, 6) if capture else None,
            "gaps": [list(g) for g in gaps(capture)] if capture else [],
            "problems": self.problems,
        }


def _read(description: CorpusDescription, item: RecordingFiles, phones: PhoneSet) -> _Entry:
    entry = _Entry(item)
    try:
        entry.capture = load_capture(description, item)
    except WorkbenchError as error:
        entry.problems.append(str(error))
        return entry
    entry.problems.extend(reading_notes(entry.capture))
    if item.audio is None and description.audio:
        entry.problems.append(f"no audio file: '{description.audio}' with id {item.id} is not there.")
    if item.labels is None:
        if description.labels:
            entry.problems.append("no labels: it cannot give units until it is labelled.")
        return entry
    try:
        entry.labels = load_labels(description, item)
        entry.utterance = recorded_utterance(
            item.id,
            entry.labels,
            entry.capture.audio,
            phones,
            phone_tier=description.phone_tier,
            word_tier=description.word_tier,
            duration_s=entry.capture.times_s[-1],
            language=description.language,
        )
    except WorkbenchError as error:
        entry.problems.append(str(error))
    return entry


def _check_lengths(entry: _Entry) -> None:
    capture = entry.capture
    if capture is None or capture.audio is None:
        return
    frame_s = 1.0 / capture.rate_hz
    motion_s, audio_s = capture.duration_s, capture.audio.duration_s
    if abs(motion_s - audio_s) > 1.5 * frame_s:
        entry.problems.append(
            f"length mismatch: motion {motion_s:.3f} s ({capture.n_frames} frames), audio {audio_s:.3f} s."
        )
    if entry.labels is not None and entry.labels.end_s > audio_s + frame_s:
        entry.problems.append(f"labels end at {entry.labels.end_s:.3f} s, after the audio ({audio_s:.3f} s).")


def _check_gaps(entry: _Entry) -> None:
    if entry.capture is None:
        return
    found = gaps(entry.capture)
    if found:
        ranges = ", ".join(f"{a}-{b}" if b > a else f"{a}" for a, b in found[:6])
        more = f" and {counted(len(found) - 6, 'more gap')}" if len(found) > 6 else ""
        entry.problems.append(f"markers missing in frames {ranges}{more}.")
    keep, regions = seen_markers([entry.capture]), entry.capture.regions
    never = [n for i, n in enumerate(entry.capture.names) if i not in keep and regions[i] != "head"]
    if 0 < len(never) < len(entry.capture.names) - regions.count("head"):
        more = f" and {counted(len(never) - 6, 'more marker')}" if len(never) > 6 else ""
        entry.problems.append(f"no frame shows {', '.join(never[:6])}{more}.")


def _check_frozen(entry: _Entry) -> None:
    """Name motion that stands still where no labels say when somebody speaks (else `_usable` does)."""
    if entry.capture is None or entry.utterance is not None:
        return
    if problem := frozen_problem(entry.capture, 0.0, np.inf):
        entry.problems.append(problem)


def _check_alike(entries: Sequence[_Entry]) -> None:
    captures = [e.capture for e in entries if e.capture is not None]
    if not captures:
        return
    rate = float(np.median([c.rate_hz for c in captures]))
    names = usual_markers(captures)
    for entry in entries:
        if entry.capture is None:
            continue
        entry.capture = in_order_of(entry.capture, names)
        if abs(entry.capture.rate_hz - rate) > 1e-6 * rate:
            entry.problems.append(f"frame rate {entry.capture.rate_hz:g} Hz; the others have {rate:g} Hz.")
        if entry.capture.names != names:
            entry.problems.append("its markers are named otherwise than those of most recordings.")


def _usable(
    description: CorpusDescription, entries: Sequence[_Entry], phones: PhoneSet
) -> list[tuple[Capture, Utterance]]:
    """Return what can be cleaned together; why a labelled recording cannot is entered in its problems."""
    captures = [e.capture for e in entries if e.capture is not None]
    if not captures:
        return []
    names = usual_markers(captures)
    columns = reference_columns(description, next(c for c in captures if c.names == names))
    usable = []
    for entry in entries:
        if entry.capture is None or entry.utterance is None or entry.capture.names != names:
            continue
        if problem := motion_problem(entry.capture, entry.utterance, columns, phones.silence):
            entry.problems.append(problem)
        else:
            usable.append((entry.capture, entry.utterance))
    return usable


def _slips(cleaned: CleanedCorpus, names: Sequence[str]) -> dict[str, list[str]]:
    """Return what slipped in each recording, in sentences, by the name of the recording."""
    told: dict[str, list[str]] = {}
    for name, capture, slips in zip(names, cleaned.captures, cleaned.slips, strict=True):
        for slip in slips:
            what = "the head markers" if slip.marker < 0 else f"marker {capture.names[slip.marker]}"
            at_s = float(capture.times_s[slip.frame])
            told.setdefault(name, []).append(f"{what} slipped by {slip.size_mm:.1f} mm at {at_s:.2f} s.")
    return told


def _advice(
    description: CorpusDescription,
    usable: Sequence[tuple[Capture, Utterance]],
    phones: PhoneSet,
    entries: Sequence[_Entry],
) -> dict[str, Any]:
    """Return head-scale spread and closure offset with the lines that would set them.

    What slipped is entered in the problems of its recording.
    """
    if not usable:
        return {}
    captures = [capture for capture, _ in usable]
    columns = reference_columns(description, captures[0])
    names = [utterance.name for _, utterance in usable]
    cleaned = clean_captures(captures, columns, allow_scale=True, names=names)
    slips = _slips(cleaned, names)
    for entry in entries:
        entry.problems.extend(slips.get(entry.files.id, ()))
    scale_sd = float(cleaned.scale_sd)
    offset = closure_offset(cleaned.captures, [utterance for _, utterance in usable], phones)
    lines: list[str] = []
    if scale_sd > SCALE_SD_LIMIT and not description.head_scale:
        lines.append("head_scale = true")
    lines += offset_advice(description, offset, captures[0].rate_hz)
    return {
        "head_scale_sd": round(scale_sd, 5),
        "posture_offsets": _postures(description, usable, cleaned, phones.silence),
        "closure_offset_s": None if offset is None else round(float(offset), 4),
        "advice": lines,
    }


def _postures(
    description: CorpusDescription,
    usable: Sequence[tuple[Capture, Utterance]],
    cleaned: CleanedCorpus,
    silence: str,
) -> dict[str, Any]:
    """Return how much of a constant posture the recordings keep, with the head removed as the corpus says."""
    utterances = [utterance for _, utterance in usable]
    still = cleaned.captures
    if not description.head_scale:
        columns = reference_columns(description, still[0])
        still = tuple(
            remove_head_motion(capture, cleaned.reference_mm, columns, allow_scale=False)[0]
            for capture, _ in usable
        )
    offsets = posture_offsets_mm(list(zip(still, utterances, strict=True)), silence)
    sizes = bias_rms_mm(offsets, still[0].regions)
    largest = max(sizes, key=lambda name: sizes[name])
    return {
        "rms_mm": round(float(np.sqrt(np.mean(np.square(list(sizes.values()))))), 3),
        "largest": largest,
        "largest_mm": round(sizes[largest], 3),
    }


def check_corpus(folder: str | Path, progress: Progress = silent) -> dict[str, Any]:
    """Examine every recording of a corpus.

    Returns
    -------
    dict
        ``recordings``: id, n_frames, rate_hz, duration_s, gaps ([first, last] frames, inclusive), problems;
        ``summary``: counts; ``head_scale_sd``; ``posture_offsets``: what recordings keep constantly
        (rms over lips and chin, and the largest, mm); ``closure_offset_s``: by how much later (s) the motion
        would have to lie for the lips to be closed in the bilabials; ``advice``: lines for corpus.toml;
        ``told``: what the corpus lacks, and what it can do without.

    Raises
    ------
    CorpusError
        There is no corpus, or nothing in it.
    """
    description = read_description(folder)
    phones = phone_set(description.phones)
    entries = []
    files = find_recordings(description)
    for index, item in enumerate(files):
        progress(0.7 * index / len(files), f"reading {item.id}")
        entries.append(_read(description, item, phones))
    for entry in entries:
        _check_lengths(entry)
        _check_frozen(entry)
        _check_gaps(entry)
    _check_alike(entries)
    progress(0.75, "head motion and lip closures")
    check_word_tier(description, [e.labels for e in entries if e.labels is not None])
    told = [*what_is_lacking(description), *what_is_left_out(description, [f.id for f in files])]
    try:
        advice = _advice(description, _usable(description, entries, phones), phones, entries)
    except CorpusError as error:  # no rigid markers: a corpus that is only read needs none
        if any(e.utterance for e in entries):
            raise
        told.append(str(error))
        advice = {}
    if axes := axes_advice(description, [e.capture for e in entries if e.capture]):
        advice["advice"] = [*advice.get("advice", []), *axes]
    rows = [entry.row() for entry in entries]
    summary = {
        "recordings": len(rows),
        "duration_s": round(sum(r["duration_s"] or 0.0 for r in rows), 3),
        "labelled": sum(e.utterance is not None for e in entries),
        "with_gaps": sum(bool(r["gaps"]) for r in rows),
        "with_problems": sum(bool(r["problems"]) for r in rows),
    }
    return {"corpus": description.name, "summary": summary, **advice, "told": told, "recordings": rows}


def health_lines(report: dict[str, Any]) -> list[str]:
    """Return the report of :func:`check_corpus` as lines for people, worst first."""
    s = report["summary"]
    lines = [
        f"{report['corpus']}: {counted(s['recordings'], 'recording')}, {s['duration_s'] / 60:.1f} min, "
        f"{s['labelled']} labelled, {s['with_gaps']} with gaps, "
        f"{s['with_problems']} with something to look at."
    ]
    if "head_scale_sd" in report:
        lines.append(
            f"Head scale spread: {100 * report['head_scale_sd']:.2f} % (0.3 % or less in optical capture)."
        )
    if posture := report.get("posture_offsets"):
        lines.append(
            f"Posture offset of the recordings: {posture['rms_mm']:.2f} mm rms, largest {posture['largest']} "
            f"{posture['largest_mm']:.2f} mm (taken out of the fragments: cleaning.remove_bias)."
        )
    if report.get("closure_offset_s") is not None:
        lines.append(
            f"Lips close best when the motion is moved by {1000 * report['closure_offset_s']:+.0f} ms "
            "against the labels (0 is right)."
        )
    lines += report.get("told", [])
    lines += [f"Advice: set '{line}' in corpus.toml." for line in report.get("advice", [])]
    for row in sorted(report["recordings"], key=lambda r: -len(r["problems"])):
        lines += [f"  {row['id']}: {problem}" for problem in row["problems"]]
    return lines
