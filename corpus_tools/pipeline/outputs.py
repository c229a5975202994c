"""The folder that ``synth`` writes: motion, mesh, sound, labels, joins, manifest; whole or not at all."""

from __future__ import annotations

import csv
import datetime
import json
import math
import platform
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np

import corpus_tools
from corpus_tools.config import ConfigBase
from corpus_tools.core import Audio, Join, Labels, Selection, Tier, Trajectory, Utterance, atomic_folder
from corpus_tools.io import file_hash, write_textgrid, write_wav
from corpus_tools.pipeline.code import code_hash, library_versions
from corpus_tools.pipeline.head import Head
from corpus_tools.pipeline.speaking import speech_facts
from corpus_tools.pipeline.stages import Synthesis
from corpus_tools.retarget import retarget_report
from corpus_tools.synthesis import Contact

__all__ = ["JOIN_COLUMNS", "write_motion", "write_synthesis"]

JOIN_COLUMNS = ("join", *(f.name for f in fields(Join) if f.name != "index"))
"""Columns of ``joins.csv``: the fields of :class:`~corpus_tools.core.trajectory.Join`, which says what they
are; gap_mm, gap_mm_s and gap_mm_s2: how far two fragments differ in position, velocity and acceleration."""


def write_motion(path: Path, trajectory: Trajectory) -> None:
    """Write ``motion.npz``: times_s (F,), markers_mm (F, M, 3) float64, names (M,), flags (F, M)."""
    assert trajectory.flags is not None
    np.savez(
        path,
        times_s=trajectory.times_s,
        markers_mm=trajectory.values_mm,
        names=np.array(trajectory.names),
        flags=trajectory.flags,
    )


def _retarget_facts(head: Head, trajectory: Trajectory) -> dict[str, Any]:
    columns = [trajectory.names.index(n) for n in head.names]
    return asdict(retarget_report(head.retargeter, np.asarray(trajectory.values_mm)[:, columns]))


def _write_mesh(path: Path, head: Head, synthesis: Synthesis) -> None:
    mesh = head.mesh
    np.savez(
        path,
        vertices_mm=synthesis.vertices_mm,
        faces=mesh.faces,
        part=mesh.part,
        names=np.array(mesh.part_names),
        rest_mm=mesh.vertices_mm.astype(np.float32),
        marker_names=np.array(list(mesh.markers)),
        marker_vertices=np.array(list(mesh.markers.values()), dtype=np.int64),
        lip_pairs=mesh.lip_pairs,
    )


_DECIMALS = {"time_s": 4, "overlap_s": 4, "natural_percentile": 1, "flagged": 3, "peak_ratio": 3}
_DECIMALS |= {"start_s": 4, "end_s": 4, "held_s": 4}
_DIGITS = 4
"""Significant digits of the gaps (our choice: capture is no better than some hundredths of a millimetre)."""


def _number(column: str, value: float) -> str:
    """Return a number as it is written: times to 0.1 ms, gaps to four significant digits; blank: unknown."""
    if not np.isfinite(value):
        return ""
    if column in _DECIMALS:
        return f"{value:.{_DECIMALS[column]}f}"
    digits = _DIGITS - 1 - math.floor(math.log10(abs(value))) if value else 0
    return f"{round(value, digits):.{min(max(digits, 0), 6)}f}"


def _write_rows(path: Path, columns: Sequence[str], rows: Sequence[Join] | Sequence[Contact]) -> None:
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(columns)
        for row in rows:
            values = [(f.name, getattr(row, f.name)) for f in fields(row)]
            writer.writerow([_number(name, v) if isinstance(v, float) else v for name, v in values])


def _labels_of(utterance: Utterance) -> Labels:
    tiers: list[Tier] = [Tier("phones", utterance.phones.intervals)]
    if utterance.syllables is not None:
        tiers.append(Tier("syllables", utterance.syllables.intervals))
    if utterance.words is not None:
        tiers.append(Tier("words", utterance.words.intervals))
    return Labels(tuple(tiers), 0.0, utterance.duration_s)


def _selection_rows(selection: Selection, utterance: Utterance) -> list[dict[str, Any]]:
    return [
        {
            "first": c.first,
            "last": c.last,
            "phones": list(utterance.labels[c.first : c.last + 1]),
            "unit": c.unit.key,
            "target": dict(c.costs.target),
            "join": dict(c.costs.join),
            "backoff": [list(b) for b in c.backoff],
        }
        for c in selection.chosen
    ]


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    if isinstance(value, np.generic):
        return value.item()
    return value


def _write_json(path: Path, data: Mapping[str, Any]) -> None:
    text = json.dumps(_plain(data), indent=1, sort_keys=True, ensure_ascii=False, default=str)
    path.write_text(text + "\n", encoding="utf-8")


def _silence(duration_s: float) -> Audio:
    return Audio(np.zeros(round(16000 * duration_s), np.float32), 16000)


def write_synthesis(
    folder: str | Path,
    synthesis: Synthesis,
    head: Head,
    config: ConfigBase,
    provenance: Mapping[str, Any],
    request: Mapping[str, Any],
    exports: Callable[[Path], Mapping[str, Any]] | None = None,
    replaceable: Callable[[Path], bool] = lambda folder: False,
) -> Path:
    """Write every file of a synthesis.

    Parameters
    ----------
    folder : path
        Made when it does not exist; files of the same name are replaced together at the end.
    synthesis, head, config
        The result and what made it.
    provenance : mapping
        Of the corpus, as of :func:`~corpus_tools.pipeline.provenance.corpus_provenance`.
    request : mapping
        What was asked for: utterance, labels, whether it was held out.
    exports : callable, optional
        ``exports(folder)`` adds files of its own to those that stand there already and returns, by name, what
        is to be known of them; they are listed in the manifest with all others.
    replaceable : callable, optional
        As of :func:`~corpus_tools.core.files.atomic_folder`, for folders that exports make.

    Raises
    ------
    OutputError
        The folder cannot be written; nothing remains of the attempt.
    """
    utterance = synthesis.utterance
    with atomic_folder(folder, replaceable) as out:
        write_motion(out / "motion.npz", synthesis.trajectory)
        _write_mesh(out / "mesh.npz", head, synthesis)
        write_wav(out / "speech.wav", utterance.audio or _silence(utterance.duration_s))
        write_textgrid(out / "labels.TextGrid", _labels_of(utterance))
        _write_rows(out / "joins.csv", JOIN_COLUMNS, synthesis.trajectory.joins)
        _write_rows(out / "contacts.csv", [f.name for f in fields(Contact)], synthesis.contacts)
        clock = time.perf_counter()
        facts = exports(out) if exports else {}
        export_ms = {"export": 1000 * (time.perf_counter() - clock)} if exports else {}
        files = {p.relative_to(out).as_posix(): file_hash(p) for p in sorted(out.rglob("*")) if p.is_file()}
        manifest = {
            "program": {
                "name": "corpus-tools",
                "version": corpus_tools.__version__,
                "code_sha256": code_hash(),
            },
            "libraries": library_versions(),
            "corpus": provenance,
            "request": request,
            "speech": speech_facts(utterance),
            "config": config.values(),
            "retarget": _retarget_facts(head, synthesis.trajectory),
            "selection": _selection_rows(synthesis.selection, utterance),
            "selection_cost": synthesis.selection.total_cost,
            "history": [s.as_dict() for s in synthesis.trajectory.history],
            "exports": facts,
            "files": files,
        }
        _write_json(out / "manifest.json", manifest)
        run = {
            "timings_ms": {k: round(v, 3) for k, v in (synthesis.timings_ms | export_ms).items()},
            "host": platform.node(),
            "system": platform.platform(),
            "date": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        }
        _write_json(out / "run.json", run)
    return Path(folder)
