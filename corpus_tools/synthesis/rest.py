"""Motion that starts and ends in the neutral pose: the silences at the ends of an utterance lead there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from corpus_tools.core import FloatArray, Interval, Trajectory, step
from corpus_tools.synthesis.weighting import smootherstep

__all__ = ["rest_at_ends"]


def _rise(times_s: FloatArray, start_s: float, end_s: float) -> FloatArray:
    """Return a C2 step from 0 at `start_s` to 1 at `end_s`; a cut at `end_s` when nothing lies between."""
    if not end_s > start_s:
        return (times_s >= end_s).astype(np.float64)
    return 1.0 - smootherstep(np.clip((times_s - start_s) / (end_s - start_s), 0.0, 1.0))


def rest_at_ends(
    trajectory: Trajectory,
    phones: Sequence[Interval],
    *,
    neutral_mm: FloatArray,
    silence: str,
    ease_s: float = 0.15,
) -> Trajectory:
    """Let the motion leave the neutral pose in the first silence and come back to it in the last.

    The face between neutral and the blended motion is ``neutral + w (motion - neutral)``, with w a quintic
    step: 0 until `ease_s` before the first phone and from `ease_s` after the last, 1 where there is speech; a
    shorter silence is used whole. The motion stays C1 (C2 where it was), its speed at both ends is 0, and no
    frame of speech changes.

    What a speaker does in silence earlier than that, such as opening the mouth to breathe, belongs to the
    recording that a fragment is from; lips and jaw prepare for the phone itself within 0.15 s (our choice:
    with 0.2 s half of a breath right before speech stays on the lips, with 0.1 s some fragments set out as
    fast as speech).

    It holds for every utterance, a recorded one too: equal phones give equal motion whether they come from
    a text, a label file or a recording, sentences can be put one after another, and a comparison with a
    recording loses nothing, for it is made where there is speech. (Our choice; 0 s leaves the motion as the
    fragments have it.)

    Parameters
    ----------
    trajectory : Trajectory
    phones : sequence of Interval
        Of the utterance; nothing is done at an end that is not silent.
    neutral_mm : (n_markers, 3) mm
        The rest pose of the corpus.
    silence : str
    ease_s : float
        Longest time of the way from the neutral pose to the first phone, and from the last one back, s.
    """
    times = np.asarray(trajectory.times_s)
    weight = np.ones(len(times))
    lead_s = tail_s = 0.0
    if ease_s > 0 and phones[0].text == silence:
        lead_s = min(ease_s, phones[0].end_s - float(times[0]))
        weight *= _rise(times, phones[0].end_s - lead_s, phones[0].end_s)
    if ease_s > 0 and phones[-1].text == silence:
        tail_s = min(ease_s, float(times[-1]) - phones[-1].start_s)
        weight *= _rise(-times, -phones[-1].start_s - tail_s, -phones[-1].start_s)
    moving = np.flatnonzero(weight < 1.0)
    values = np.array(trajectory.values_mm)
    away = values[moving] - neutral_mm
    values[moving] = neutral_mm + weight[moving, None, None] * away
    moved = float(np.abs((1.0 - weight[moving, None, None]) * away).max(initial=0.0))
    done = step("rest_at_ends", lead_s=round(lead_s, 6), tail_s=round(tail_s, 6), largest_mm=round(moved, 4))
    return replace(trajectory, values_mm=values, history=(*trajectory.history, done))
