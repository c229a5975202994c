"""What is said of a result in a line: how many contacts the lips make, how far it lies from the recording."""

from __future__ import annotations

import numpy as np

from corpus_tools.core import counted
from corpus_tools.synthesis import Contact, lip_contacts
from workbench.state.stages import Result

__all__ = ["contacts_of", "contacts_text", "distance_mm", "held_out_text", "lane_text", "missed_text"]

_MOUTH = ("lip_in", "lip_out", "chin")
_MOST_MISSED = 2


def contacts_of(result: Result) -> tuple[Contact, ...]:
    """Return every p b m and f v of a result, as the motion makes them."""
    corpus = result.request.corpus
    return lip_contacts(corpus.lips, result.trajectory, result.utterance, corpus.phones)


def contacts_text(contacts: tuple[Contact, ...]) -> str:
    """Return how many of p b m and f v are made, as in "5/6 contacts"; empty without any."""
    made = sum(c.made for c in contacts)
    return f"{made}/{counted(len(contacts), 'contact')}" if contacts else ""


def missed_text(contacts: tuple[Contact, ...]) -> str:
    """Return which contacts are not made; empty when all are."""
    missed = [f"{c.phone} at {c.time_s:.2f} s" for c in contacts if not c.made]
    if not missed:
        return ""
    more = f" and {len(missed) - _MOST_MISSED} more" if len(missed) > _MOST_MISSED else ""
    return f"The lips make no contact: {', '.join(missed[:_MOST_MISSED])}{more}"


def lane_text(result: Result) -> str:
    """Return method, fragments and contacts of the lips, in one line."""
    parts = [
        result.selection.method,
        counted(len(result.selection.chosen), "fragment"),
        contacts_text(contacts_of(result)),
    ]
    return " · ".join(filter(None, parts))


def distance_mm(result: Result) -> float:
    """Return how far lips and chin are from the recording of the sentence while it speaks, rms, mm.

    Every marker at every frame of the recording from the first phone to the last; the posture that the
    recording keeps constantly counts. NaN for a text, or without lips and chin.
    """
    if result.request.text:
        return float("nan")
    capture = result.request.corpus.recorded(result.request.sentence)
    mouth = [i for i, n in enumerate(result.trajectory.names) if n.rstrip("0123456789") in _MOUTH]
    spoken = [p for p in result.utterance.phones if p.text != result.request.corpus.phones.silence]
    if not mouth or not spoken:
        return float("nan")
    at = np.asarray(capture.times_s)
    times = np.asarray(result.trajectory.times_s)
    at = at[(at >= max(spoken[0].start_s, times[0])) & (at <= min(spoken[-1].end_s, times[-1]))]
    frames = np.searchsorted(capture.times_s, at)
    moved = np.asarray(result.trajectory.values_mm)[:, mouth].reshape(len(times), -1)
    there = np.stack([np.interp(at, times, column) for column in moved.T], axis=1)
    apart = there - np.asarray(capture.positions_mm)[frames][:, mouth].reshape(len(at), -1)
    return float(np.sqrt((apart**2).sum() / (len(at) * len(mouth)))) if len(at) else float("nan")


def held_out_text(result: Result) -> str:
    """Return that the recording is held out, and how far from it lips and chin are; empty when it is not."""
    if not result.request.exclude:
        return ""
    distance = distance_mm(result)
    away = f" · {distance:.1f} mm away" if np.isfinite(distance) else ""
    return f"held out{away}"
