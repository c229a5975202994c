"""What the corpus page knows of a corpus: tallies, one row a recording, diphones; plain data, worst first."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from corpus_tools.fragments import coverage
from corpus_tools.pipeline import OpenCorpus, check_corpus

__all__ = ["CorpusFacts", "RecordingRow", "corpus_facts", "recording_rows"]


@dataclass(frozen=True, slots=True)
class RecordingRow:
    """One recording of the list.

    Attributes
    ----------
    name, text : str
    duration_s : float or None
        None when its motion cannot be read.
    gap_frames : int or None
        Frames in which markers are missing; None before the check.
    covered : float or None
        Share of its diphones that the other recordings hold, 0-1; None when it gives no units.
    usable : bool
        Whether units are cut from it.
    problems : tuple of str or None
        Sentences; None before the check.
    """

    name: str
    text: str
    duration_s: float | None
    gap_frames: int | None
    covered: float | None
    usable: bool
    problems: tuple[str, ...] | None


@dataclass(frozen=True, slots=True, eq=False)
class CorpusFacts:
    """What a check of an opened corpus found.

    Attributes
    ----------
    corpus : OpenCorpus
    health : dict
        As of :func:`corpus_tools.pipeline.check_corpus`.
    cover : dict
        As of :meth:`corpus_tools.fragments.CoverageReport.as_dict`, each recording judged by the others.
    """

    corpus: OpenCorpus
    health: dict[str, Any]
    cover: dict[str, Any]


def corpus_facts(corpus: OpenCorpus, progress: Callable[[float, str], None]) -> CorpusFacts:
    """Check an opened corpus as ``corpus-tools check`` and ``coverage`` do.

    Parameters
    ----------
    corpus : OpenCorpus
    progress : callable
        ``progress(fraction, what)``; may raise to cancel.
    """
    cover = coverage(corpus.inventory, [r.utterance for r in corpus.recordings], leave_one_out=True)
    health = check_corpus(corpus.description.folder, lambda f, what: progress(0.95 * f, what))
    return CorpusFacts(corpus, health, cover.as_dict())


def _n_frames(gaps: list[list[int]]) -> int:
    return sum(last - first + 1 for first, last in gaps)


def recording_rows(corpus: OpenCorpus, facts: CorpusFacts | None = None) -> tuple[RecordingRow, ...]:
    """Return one row for every recording: those that give no units first, then those with most problems.

    Parameters
    ----------
    corpus : OpenCorpus
    facts : CorpusFacts, optional
        Without them gaps, problems and coverage are unknown.
    """
    known = {r["id"]: r for r in facts.health["recordings"]} if facts else {}
    share = {u["id"]: u["coverage"] for u in facts.cover["utterances"]} if facts else {}
    lengths = {r.name: r.capture.duration_s for r in corpus.recordings}
    rows = []
    for name in (*corpus.skipped, *corpus.names):
        row = known.get(name)
        why = (corpus.skipped[name],) if name in corpus.skipped else ()
        problems = tuple(dict.fromkeys((*why, *row["problems"]))) if row else (why or None)
        rows.append(
            RecordingRow(
                name,
                corpus.utterance(name).text if name in lengths else "",
                row["duration_s"] if row else lengths.get(name),
                _n_frames(row["gaps"]) if row else None,
                share.get(name),
                name in lengths,
                problems,
            )
        )
    return tuple(sorted(rows, key=lambda r: (r.usable, -len(r.problems or ()), -(r.gap_frames or 0))))
