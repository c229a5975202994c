"""Cutting a fragment out of its recording, with motion on both sides for the overlaps."""

from __future__ import annotations

import numpy as np

from corpus_tools.core import Fragment, InputError, MotionError, UnitInventory, UnitRef

__all__ = ["cut_fragment"]


def cut_fragment(inventory: UnitInventory, unit: UnitRef, context_s: float = 0.25) -> Fragment:
    """Cut the motion of a unit (paper A section 5.1).

    The unit runs from the centre of its first phone to the centre of its last, so that neighbouring units
    share a phone; "a small degree of context is required in the fragments" for the overlaps (section 5.1.3).

    Parameters
    ----------
    inventory : UnitInventory
    unit : UnitRef
    context_s : float
        Motion kept before and after the unit, s; less where the recording ends.

    Raises
    ------
    InputError
        The recording is unknown or has no such phones.
    MotionError
        The capture has fewer than two frames there.
    """
    recording = inventory.recordings[inventory.recording_index(unit.recording)]
    intervals = recording.utterance.phones.intervals
    if not 0 <= unit.first < unit.last < len(intervals):
        raise InputError(
            f"'{unit.key}' is not a unit of '{unit.recording}': phones 0 to {len(intervals) - 1} are there, "
            "and the first must come before the last."
        )
    spoken = intervals[unit.first : unit.last + 1]
    capture = recording.capture
    low_s, high_s = spoken[0].centre_s - context_s, spoken[-1].centre_s + context_s
    low, high = np.searchsorted(capture.times_s, [low_s - 1e-9, high_s + 1e-9])
    if high - low < 2:
        raise MotionError(
            f"The capture of '{unit.recording}' has {high - low} frames between {low_s:.3f} s and "
            f"{high_s:.3f} s where a unit needs at least 2; check the frame rate and the offset of the "
            "recording."
        )
    assert capture.flags is not None
    return Fragment(
        unit=unit,
        phones=tuple(interval.text for interval in spoken),
        edges_s=np.array([interval.start_s for interval in spoken] + [spoken[-1].end_s]),
        times_s=capture.times_s[low:high],
        motion_mm=capture.positions_mm[low:high],
        flags=capture.flags[low:high],
    )
