"""What lane, curve and inspector show, as plain data made from a result: no drawing, no Panel."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from corpus_tools.core import ChosenUnit, FloatArray, Selection, Utterance
from corpus_tools.speech import PhoneSet, lip_aperture_mm
from corpus_tools.synthesis import weighting
from workbench.state.stages import Result
from workbench.state.tokens import source_slots

__all__ = [
    "FragmentDetails",
    "aperture_curves",
    "fragment_details",
    "joins_data",
    "phone_rows",
    "score",
    "weighting_samples",
]


def _float32(values: FloatArray) -> bytes:
    return np.ascontiguousarray(values, np.float32).tobytes()


def phone_rows(utterance: Utterance, phones: PhoneSet) -> list[list[Any]]:
    """Return ``[start_s, end_s, phone, display class]`` of every phone.

    Parameters
    ----------
    utterance : Utterance
    phones : PhoneSet
    """
    return [[p.start_s, p.end_s, p.text, phones.display_class(p.text)] for p in utterance.phones]


def _place(unit: ChosenUnit, utterance: Utterance, n_phones: int) -> tuple[float, float]:
    """Where a fragment speaks: from the centre of its first phone to that of its last; the ends reach out."""
    intervals = utterance.phones.intervals
    start = 0.0 if unit.first == 0 else intervals[unit.first].centre_s
    end = intervals[-1].end_s if unit.last == n_phones - 1 else intervals[unit.last].centre_s
    return start, end


def _fragments(result: Result) -> list[dict[str, Any]]:
    utterance, chosen = result.utterance, result.selection.chosen
    slots = source_slots(tuple(c.unit.recording for c in chosen))
    rows = []
    for unit, slot in zip(chosen, slots, strict=True):
        start, end = _place(unit, utterance, len(utterance.labels))
        rows.append(
            {
                "start": start,
                "end": end,
                "id": unit.unit.recording,
                "text": result.request.corpus.utterance(unit.unit.recording).text,
                "phones": " ".join(utterance.labels[unit.first : unit.last + 1]),
                "cost": unit.costs.total,
                "slot": slot,
                "backoff": [list(b) for b in unit.backoff],
            }
        )
    return rows


def score(result: Result) -> dict[str, Any]:
    """Return phones and fragments of a result as the lane draws them; times in seconds."""
    return {
        "duration": result.utterance.duration_s,
        "phones": phone_rows(result.utterance, result.request.corpus.phones),
        "fragments": _fragments(result),
    }


def joins_data(result: Result) -> list[dict[str, Any]]:
    """Return time (s), overlap (s), phone, gap (mm) and natural percentile (None: unknown) of each join."""
    return [
        {
            "time": j.time_s,
            "overlap": j.overlap_s,
            "phone": j.phone,
            "gap": j.gap_mm,
            "percentile": j.natural_percentile if math.isfinite(j.natural_percentile) else None,
        }
        for j in result.trajectory.joins
    ]


def aperture_curves(result: Result) -> dict[str, Any]:
    """Return the lip aperture (mm, float32 bytes) of the blend and of the recording, with rates and starts.

    The recording's own capture is shown only as a reference; it is empty when the markers do not hold the
    inner lips. `threshold` is the aperture (mm) below which this speaker's lips count as closed.
    """
    corpus, trajectory = result.request.corpus, result.trajectory
    capture = corpus.recording(result.request.sentence).capture
    threshold = corpus.lips.threshold_mm
    return {
        "blend": _float32(lip_aperture_mm(trajectory.values_mm, trajectory.names)),
        "rate": trajectory.rate_hz,
        "start": float(trajectory.times_s[0]),
        "recorded": _float32(lip_aperture_mm(capture.positions_mm, capture.names)),
        "recorded_rate": capture.rate_hz,
        "recorded_start": capture.start_s,
        "threshold": threshold if math.isfinite(threshold) else None,
    }


def weighting_samples(name: str, shape: float, n: int = 101) -> FloatArray:
    """Return g(u) at `n` even values of u in [0, 1] (paper A eq. (2))."""
    return np.asarray(weighting(name, shape)(np.linspace(0.0, 1.0, n)))


@dataclass(frozen=True, slots=True)
class FragmentDetails:
    """What the inspector says of one fragment.

    Attributes
    ----------
    index, n_fragments : int
    slot : int
        Colour slot of its source.
    source, text, phones : str
    first_s, last_s : float
        Where it comes from, on the clock of its source, s.
    costs : tuple of (term, value)
        Target terms, then join terms.
    join_costs : tuple of (term, value)
        The join terms alone.
    total : float
    backoff : tuple of (target phone, phone spoken instead)
    join : dict or None
        The join with the fragment before it, as of :func:`joins_data`, with `gap_mm_s` and `before` (its id).
    rejected : tuple of (source, text, target cost, join cost)
    """

    index: int
    n_fragments: int
    slot: int
    source: str
    text: str
    phones: str
    first_s: float
    last_s: float
    costs: tuple[tuple[str, float], ...]
    join_costs: tuple[tuple[str, float], ...]
    total: float
    backoff: tuple[tuple[str, str], ...]
    join: dict[str, Any] | None
    rejected: tuple[tuple[str, str, float, float], ...]


def _source_span(result: Result, unit: ChosenUnit) -> tuple[float, float]:
    intervals = result.request.corpus.utterance(unit.unit.recording).phones.intervals
    return intervals[unit.unit.first].centre_s, intervals[unit.unit.last].centre_s


def _join_before(result: Result, selection: Selection, index: int) -> dict[str, Any] | None:
    if index == 0 or index > len(result.trajectory.joins):
        return None
    join = result.trajectory.joins[index - 1]
    before = selection.chosen[index - 1].unit.recording
    return {**joins_data(result)[index - 1], "gap_mm_s": join.gap_mm_s, "before": before}


def fragment_details(result: Result, index: int) -> FragmentDetails:
    """Return what there is to say of fragment `index`."""
    corpus, selection = result.request.corpus, result.selection
    unit = selection.chosen[index]
    slots = source_slots(tuple(c.unit.recording for c in selection.chosen))
    first_s, last_s = _source_span(result, unit)
    return FragmentDetails(
        index=index,
        n_fragments=len(selection.chosen),
        slot=slots[index],
        source=unit.unit.recording,
        text=corpus.utterance(unit.unit.recording).text,
        phones=" ".join(result.utterance.labels[unit.first : unit.last + 1]),
        first_s=first_s,
        last_s=last_s,
        costs=(*unit.costs.target, *unit.costs.join),
        join_costs=unit.costs.join,
        total=unit.costs.total,
        backoff=tuple((target, used) for _, target, used in unit.backoff),
        join=_join_before(result, selection, index),
        rejected=tuple(
            (
                c.unit.recording,
                corpus.utterance(c.unit.recording).text,
                c.costs.target_total,
                c.costs.join_total,
            )
            for c in unit.rejected
        ),
    )
