"""The constant posture of each recording of a corpus: taken out of what units are cut from, and told."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from corpus_tools.cleaning import holding, phone_halves, recording_bias
from corpus_tools.core import (
    SPEECH_REGIONS,
    Capture,
    FloatArray,
    Recording,
    Utterance,
    frozen,
    region_columns,
    step,
)
from corpus_tools.speech import lip_pair_functionals

__all__ = ["as_recorded", "bias_rms_mm", "posture_offsets_mm", "without_bias"]


def posture_offsets_mm(spoken: Sequence[tuple[Capture, Utterance]], silence: str) -> dict[str, FloatArray]:
    """Return the constant offset of every recording, (n_markers, 3) mm; together they sum to 0.

    How far the lips are apart is held: lips that touch touch in any posture, so that an offset between them
    is none of their closures (our choice; without it the closures of GRID spread over 2.5 mm, not 1.2).

    Parameters
    ----------
    spoken : sequence of (Capture, Utterance)
        Head-stabilised, the same markers in all. Filled and doubtful samples are not used.
    silence : str
        The silence of the phone set: posture in silence is no part of the offset.
    """
    halves = [
        phone_halves(
            np.asarray(capture.positions_mm),
            capture.times_s,
            capture.measured,
            [(p.start_s, p.end_s, p.text) for p in utterance.phones],
            silence,
        )
        for capture, utterance in spoken
    ]
    names = spoken[0][0].names
    offsets = holding(recording_bias(halves).offsets_mm, lip_pair_functionals(names))
    return {u.name: frozen(offset) for (_, u), offset in zip(spoken, offsets, strict=True)}


def bias_rms_mm(offsets_mm: Mapping[str, FloatArray], regions: Sequence[str]) -> dict[str, float]:
    """Return the size of every offset: the rms length over lips and chin (over all markers without them)."""
    columns = region_columns(regions, SPEECH_REGIONS)
    return {
        name: float(np.sqrt((np.asarray(offset)[columns] ** 2).sum(axis=1).mean()))
        for name, offset in offsets_mm.items()
    }


def without_bias(
    recordings: Sequence[Recording], silence: str
) -> tuple[tuple[Recording, ...], dict[str, FloatArray]]:
    """Return the recordings freed of the posture that each keeps constantly, and what was taken out.

    Every recording of the corpus takes part, also one that is held out later at synthesis: through the phone
    means it then still shifts the offsets of the others, by about 1/n of its own (0.007 mm rms among 203
    recordings, 0.3 % of the error of a synthesis). Its own motion is never used.
    """
    offsets = posture_offsets_mm([(r.capture, r.utterance) for r in recordings], silence)
    sizes = bias_rms_mm(offsets, recordings[0].capture.regions) if recordings else {}
    freed = []
    for recording in recordings:
        name, capture = recording.name, recording.capture
        moved = capture.with_step(
            step("remove_bias", offset_rms_mm=round(sizes[name], 4)),
            positions_mm=np.asarray(capture.positions_mm) - offsets[name],
        )
        freed.append(replace(recording, capture=moved))
    return tuple(freed), offsets


def as_recorded(capture: Capture, offset_mm: FloatArray | None) -> Capture:
    """Return a cleaned capture with its own posture put back; as it is when none was taken out."""
    if offset_mm is None:
        return capture
    return replace(
        capture,
        positions_mm=np.asarray(capture.positions_mm) + offset_mm,
        history=tuple(s for s in capture.history if s.name != "remove_bias"),
    )
