"""Markers of the upper face that help the head markers to find the head (paper A section 4).

"A combination of the estimate from the head mounted jig and a least-squares approach": markers on skin that
hardly moves against the skull take part in the fit. Which ones is found from the recordings (our choice), for
seven landmarks of a forehead, or a jig that slips, leave the head uncertain by more than such skin moves.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from corpus_tools.cleaning.head_motion import REFERENCE_FRAMES, remove_head_motion
from corpus_tools.core import SPEECH_REGIONS, Capture, FloatArray, MotionError

__all__ = ["LEAST_SEEN", "STEADY_MM", "supporting_columns"]

STEADY_MM = 1.0
"""Spread against the head within a recording up to which a marker supports the fit, mm (our choice)."""

LEAST_SEEN = 0.95
"""Share of frames in which a supporting marker must be seen (our choice)."""

_SPEAKING = frozenset({*SPEECH_REGIONS, "head"})


def supporting_columns(
    captures: Sequence[Capture],
    reference_mm: FloatArray,
    columns: Sequence[int],
    allow_scale: bool,
    cutoff_mm: float = 1.0,
    steady_mm: float = STEADY_MM,
) -> list[int]:
    """Return the markers that stay where they are on the head while the speaker talks.

    Parameters
    ----------
    captures : sequence of Capture
    reference_mm : (n_markers, 3) mm
        The head as the head markers alone find it.
    columns : sequence of int
        Head markers.
    allow_scale, cutoff_mm
        As of :func:`~corpus_tools.cleaning.head_motion.estimate_head_motion`.
    steady_mm : float
        Largest rms distance (3-D) from their mean within a recording, over all recordings. Lips and chin
        never support.

    Returns
    -------
    list of int
        Ascending, without `columns`.
    """
    n_markers = len(captures[0].names)
    square, count, frames, seen = np.zeros(n_markers), np.zeros(n_markers), 0, np.zeros(n_markers)
    for capture in captures:
        whole = np.asarray(np.isfinite(np.asarray(capture.positions_mm)).all(axis=2))
        seen += whole.sum(axis=0)
        frames += len(whole)
        spread, n = _within(capture, reference_mm, columns, allow_scale, cutoff_mm)
        square += spread
        count += n
    within = np.sqrt(square / np.maximum(count, 1.0))
    steady = (within <= steady_mm) & (count > 0) & (seen >= LEAST_SEEN * frames)
    return [
        i
        for i in np.flatnonzero(steady).tolist()
        if i not in set(columns) and captures[0].regions[i] not in _SPEAKING
    ]


def _within(
    capture: Capture, reference_mm: FloatArray, columns: Sequence[int], allow_scale: bool, cutoff_mm: float
) -> tuple[FloatArray, FloatArray]:
    """Return the sum of squared distances of each marker from its mean in a recording, and of how many."""
    try:
        still, motion = remove_head_motion(capture, reference_mm, columns, allow_scale, cutoff_mm, 3)
    except MotionError:  # it shows no head, and is told by name when it is cleaned
        nothing = np.zeros(len(capture.names))
        return nothing, nothing
    every = np.flatnonzero(motion.fitted)
    places = np.linspace(0, len(every) - 1, min(len(every), REFERENCE_FRAMES)).round()
    some = every[places.astype(np.int64)]
    positions = np.asarray(still.positions_mm)[some]
    here = np.asarray(np.isfinite(positions).all(axis=2))
    known = np.where(here[..., None], positions, 0.0)
    n = here.sum(axis=0).astype(np.float64)
    mean = known.sum(axis=0) / np.maximum(n, 1.0)[:, None]
    away = np.where(here, ((known - mean) ** 2).sum(axis=2), 0.0)
    return np.asarray(away.sum(axis=0)), n
