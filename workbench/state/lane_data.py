"""What lane, curve and inspector show, as plain data made from a result: no drawing, no Panel."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from corpus_tools import synthesis
from corpus_tools.core import ChosenUnit, FloatArray, Selection, Utterance
from corpus_tools.speech import PhoneSet, lip_aperture_mm
from corpus_tools.synthesis import DEFAULT_CURVE, stand_ins_told, weighting, weightings_of_joins
from workbench.state.effects import Effects
from workbench.state.picks import pin_at
from workbench.state.stages import Result
from workbench.state.tokens import source_slots

__all__ = [
    "FragmentDetails",
    "aperture_curves",
    "band_data",
    "fragment_details",
    "joins_data",
    "phone_rows",
    "score",
    "stand_ins",
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
    pins = result.request.config.overrides.pins
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
                "pinned": bool(pin_at(pins, unit.first, unit.last)),
                "others": [c.unit.recording for c in unit.rejected],
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


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None


def joins_data(result: Result, other: Result | None = None) -> list[dict[str, Any]]:
    """Return what is known of each join.

    Time and overlap (s), phone, gap (mm), natural percentile, ratio of its peak acceleration to the natural
    95th percentile, and `other`: the ratio in setting A where the same fragments meet there. None: unknown.
    """
    before: dict[tuple[str, str], float] = {}
    if other is not None and other.request.same_target(result.request):
        pairs = zip(other.trajectory.joins, other.ratios, strict=True)
        before = {(j.left_source, j.right_source): r for j, r in pairs}
    return [
        {
            "time": j.time_s,
            "overlap": j.overlap_s,
            "phone": j.phone,
            "gap": j.gap_mm,
            "percentile": _known(j.natural_percentile),
            "ratio": _known(ratio),
            "other": _known(before.get((j.left_source, j.right_source), math.nan)),
        }
        for j, ratio in zip(result.trajectory.joins, result.ratios, strict=True)
    ]


def aperture_curves(result: Result, other: Result | None = None) -> dict[str, Any]:
    """Return lip apertures (mm, float32 bytes) with their rates (Hz) and starts (s).

    `blend` is the result, `other` that of setting A, `recorded` the capture of the same sentence (empty for a
    text), `pieces` the fragments' own motion on the clock of the target, `threshold` the aperture (mm) below
    which this speaker's lips count as closed.

    Parameters
    ----------
    result : Result
    other : Result, optional
        Of the same target.
    """
    corpus, trajectory = result.request.corpus, result.trajectory
    threshold = corpus.lips.threshold_mm
    found = {
        "blend": _float32(lip_aperture_mm(trajectory.values_mm, trajectory.names)),
        "rate": trajectory.rate_hz,
        "start": float(trajectory.times_s[0]),
        "recorded": b"",
        "threshold": threshold if math.isfinite(threshold) else None,
        "pieces": [
            {
                "start": float(trajectory.times_s[0]) + p.start / trajectory.rate_hz,
                "values": _float32(lip_aperture_mm(p.motion_mm, result.pieces.names)),
            }
            for p in result.pieces.pieces
        ],
        "other": b"",
    }
    if not result.request.text:
        capture = corpus.recorded(result.request.sentence)
        found["recorded"] = _float32(lip_aperture_mm(capture.positions_mm, capture.names))
        found |= {"recorded_rate": capture.rate_hz, "recorded_start": capture.start_s}
    if other is not None and other.request.same_target(result.request):
        found["other"] = _float32(lip_aperture_mm(other.trajectory.values_mm, other.trajectory.names))
    return found


def band_data(effects: Effects | None) -> dict[str, bytes]:
    """Return the natural range of the lip aperture (float32 bytes: times s, low mm, high mm)."""
    if effects is None:
        return {}
    return dict(zip(("times", "low", "high"), map(_float32, effects.band), strict=True))


def stand_ins(result: Result) -> tuple[str, tuple[str, ...]]:
    """Return what the command line tells of stand-ins too (:func:`corpus_tools.synthesis.stand_ins_told`)."""
    utterance = result.utterance
    found = synthesis.stand_ins(result.selection, utterance, result.request.corpus.phones)
    return stand_ins_told(found, len(utterance.labels) - 1)


def weighting_samples(
    name: str, shape: float, curve_weights: Sequence[float] = DEFAULT_CURVE, n: int = 101
) -> FloatArray:
    """Return g(u) at `n` even values of u in [0, 1] (paper A eq. (2))."""
    return np.asarray(weighting(name, shape, curve_weights)(np.linspace(0.0, 1.0, n)))


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
    total, of_all : float
    backoff : tuple of (target phone, phone spoken instead)
    join : dict or None
        The join with the fragment before it, as of :func:`joins_data`, with `gap_mm_s`, and of that fragment
        `before` (its id), `before_text` and `before_slot`; `inertial`: the duration of an inertial join, s;
        `g`: its weighting function where the config makes exceptions, else empty.
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
    total: float
    of_all: float
    backoff: tuple[tuple[str, str], ...]
    join: dict[str, Any] | None


def _source_span(result: Result, unit: ChosenUnit) -> tuple[float, float]:
    intervals = result.request.corpus.utterance(unit.unit.recording).phones.intervals
    return intervals[unit.unit.first].centre_s, intervals[unit.unit.last].centre_s


def _join_before(result: Result, selection: Selection, index: int) -> dict[str, Any] | None:
    if index == 0 or index > len(result.trajectory.joins):
        return None
    join = result.trajectory.joins[index - 1]
    before = selection.chosen[index - 1].unit.recording
    slots = source_slots(tuple(c.unit.recording for c in selection.chosen))
    blend = result.request.config.blend
    classes = result.request.corpus.phones.display_classes
    own = weightings_of_joins(
        [j.phone for j in result.trajectory.joins],
        (blend.weighting, blend.shape),
        blend.weighting_at,
        classes,
    )
    return {
        **joins_data(result)[index - 1],
        "g": own[index - 1][0] if blend.mode != "inertial" and blend.weighting_at else "",
        "inertial": blend.inertial_s if blend.mode == "inertial" else None,
        "gap_mm_s": join.gap_mm_s,
        "before": before,
        "before_text": result.request.corpus.utterance(before).text,
        "before_slot": slots[index - 1],
    }


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
        total=unit.costs.total,
        of_all=result.selection.total_cost,
        backoff=tuple((target, used) for _, target, used in unit.backoff),
        join=_join_before(result, selection, index),
    )
