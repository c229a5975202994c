"""Which recordings of a corpus can be used: one that cannot is left out and named, the others go on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from corpus_tools.core import BoolArray, Capture, FloatArray, Utterance, speech_span_s

__all__ = [
    "COVER_TOLERANCE_S",
    "LEAST_RATE_HZ",
    "chosen_markers",
    "frozen_problem",
    "in_order_of",
    "motion_problem",
    "seen_markers",
    "usual_markers",
]

LEAST_RATE_HZ = 10.0
"""Slower motion, captured or synthesised, has no frame of its own for a phone (our choice)."""

FROZEN_S = 1.0
"""Longest stretch of speech in which no marker moves at all (our choice: no pause is still)."""

COVER_TOLERANCE_S = 0.1
"""How far speech may reach beyond the motion, s: the nearest pose is held there (our choice: one phone)."""


def usual_markers(captures: Iterable[Capture]) -> tuple[str, ...]:
    """Return the marker names that most captures have; those of the earliest when as many have others."""
    return Counter(capture.names for capture in captures).most_common(1)[0][0]


def chosen_markers(capture: Capture, keep: Sequence[int]) -> Capture:
    """Return a capture with the markers of the columns `keep` alone."""
    assert capture.flags is not None
    return replace(
        capture,
        positions_mm=capture.positions_mm[:, keep],
        names=tuple(capture.names[i] for i in keep),
        regions=tuple(capture.regions[i] for i in keep),
        flags=capture.flags[:, keep],
    )


def in_order_of(capture: Capture, names: Sequence[str]) -> Capture:
    """Return a capture with its markers in the order of `names`; as it is when it has others."""
    if capture.names == tuple(names) or sorted(capture.names) != sorted(names):
        return capture
    return chosen_markers(capture, [capture.names.index(n) for n in names])


def seen_markers(captures: Iterable[Capture]) -> list[int]:
    """Return the columns of the markers that at least one frame of the corpus shows."""
    seen = [np.isfinite(np.asarray(c.positions_mm)).all(axis=2).any(axis=0) for c in captures]
    return [int(i) for i in np.flatnonzero(np.any(seen, axis=0))]


def _spread_out(points: FloatArray, seen: BoolArray) -> BoolArray:
    """Return in which frames 3 markers are seen that do not lie on one line, (n_frames,)."""
    count = seen.sum(axis=1)
    known = np.where(seen[..., None], points, 0.0)
    centre = known.sum(axis=1) / np.maximum(count, 1)[:, None]
    centred = np.where(seen[..., None], points - centre[:, None], 0.0)
    spread = np.linalg.svd(centred, compute_uv=False)
    return np.asarray((count >= 3) & (spread[:, 1] > 1e-3 * spread[:, 0]))


def frozen_problem(capture: Capture, low_s: float, high_s: float) -> str | None:
    """Return a sentence when motion between two times stands still to the last digit, or None.

    Nothing that is measured does: frames that are equal in every marker for longer than :data:`FROZEN_S`, or
    all frames of a recording, are one frame written again and again.

    Parameters
    ----------
    capture : Capture
    low_s, high_s : float
        Only frames between them count, s.
    """
    times, points = capture.times_s, np.asarray(capture.positions_mm)
    seen: BoolArray = np.asarray(np.isfinite(points).all(axis=2))
    both = seen[1:] & seen[:-1]
    equal = ((points[1:] == points[:-1]).all(axis=2) | ~both).all(axis=1) & both.any(axis=1)
    if len(equal) and equal.all():
        first, last = 0, len(equal)
    else:
        first, last = _longest(equal & (times[:-1] >= low_s) & (times[1:] <= high_s))
        if last - first <= FROZEN_S * capture.rate_hz:
            return None
    return (
        f"its motion stands still to the last digit from {times[first]:.3f} to {times[last]:.3f} s, which "
        "no capture does; export it again, or leave the recording out."
    )


def _longest(true: BoolArray) -> tuple[int, int]:
    """Return where the longest stretch of true values begins and ends; (0, 0) when there is none."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], true.astype(np.int8), [0]])))
    starts, stops = edges[::2], edges[1::2]
    at = int(np.argmax(stops - starts)) if len(starts) else 0
    return (int(starts[at]), int(stops[at])) if len(starts) else (0, 0)


def motion_problem(
    capture: Capture, utterance: Utterance, columns: Sequence[int], silence: str
) -> str | None:
    """Return why no units can be cut from a recording, or None.

    Parameters
    ----------
    capture : Capture
        As captured, NaN where a marker is missing.
    utterance : Utterance
    columns : sequence of int
        The markers that move with the skull.
    silence : str
        The silence of the phone set.
    """
    points = np.asarray(capture.positions_mm)[:, list(columns)]
    seen: BoolArray = np.asarray(np.isfinite(points).all(axis=2))
    if not (seen.sum(axis=1) >= 3).any():
        return "no frame shows 3 of the reference markers together, so its head motion cannot be removed."
    if not _spread_out(points, seen).any():
        return "its reference markers lie on one line or in one point, so its head motion cannot be removed."
    if capture.rate_hz < LEAST_RATE_HZ:
        return f"it has {capture.rate_hz:g} frames per second; at least {LEAST_RATE_HZ:g} are needed."
    times = capture.times_s
    low, high = speech_span_s(utterance, silence)
    if len(times) < 2 or times[0] > low + COVER_TOLERANCE_S or times[-1] < high - COVER_TOLERANCE_S:
        return (
            f"its motion runs from {times[0]:.3f} to {times[-1]:.3f} s but its labels speak from {low:.3f} "
            f"to {high:.3f} s; check the frame rate and audio_offset_s, or give the whole recording."
        )
    return frozen_problem(capture, low, high)
