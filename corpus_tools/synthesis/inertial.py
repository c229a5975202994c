"""Inertial joins: no cross-fade; what two fragments differ by dies away on both sides (beyond paper A)."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from corpus_tools.core import FloatArray, InputError
from corpus_tools.synthesis.joins import piece_state
from corpus_tools.synthesis.pieces import AlignedPieces

__all__ = ["MOST_INERTIAL_S", "InertialMotion", "join_inertially", "quintic_decay"]

_BACKWARDS = np.array([1.0, -1.0, 1.0])[:, None, None]
"""Position, velocity and acceleration seen against the time."""

MOST_INERTIAL_S = 0.3
"""Longest decay, s: beyond 0.12 s closures begin to go, beyond this a join reaches into other words."""


@dataclass(frozen=True, slots=True, eq=False)
class InertialMotion:
    """Fragments joined without a cross-fade.

    Attributes
    ----------
    values_mm : (n_frames, n_markers, 3) mm
    flags : (n_frames, n_markers) uint8
        Of the one fragment that speaks in each frame.
    reach_s : (n_joins,) s
        Time over which each join moves the fragments, both sides together.
    deviation_mm : (n_frames,) mm
        How far the motion lies from what was captured: rms over markers.
    """

    values_mm: FloatArray
    flags: npt.NDArray[np.uint8]
    reach_s: FloatArray
    deviation_mm: FloatArray


def quintic_decay(times_s: FloatArray, length_s: float) -> FloatArray:
    """Return how an offset dies away, (3, n_times).

    Row k is the polynomial of degree 5 whose k-th derivative is 1 at time 0 while the other two of position,
    velocity and acceleration are 0 there, and all three are 0 from `length_s` on.
    """
    x = np.clip(np.asarray(times_s) / length_s, 0.0, 1.0)
    rest = (1.0 - x) ** 3
    position = rest * (1.0 + x * (3.0 + 6.0 * x))
    return np.stack([position, length_s * x * rest * (1.0 + 3.0 * x), 0.5 * length_s**2 * x**2 * rest])


def _cuts(aligned: AlignedPieces) -> list[int]:
    """Return the frame at which each piece begins to speak, and the number of frames."""
    frames = [round(float(t) * aligned.rate_hz) for t in aligned.join_times_s]
    return [0, *frames, len(aligned.times_s)]


def join_inertially(aligned: AlignedPieces, length_s: float = 0.12) -> InertialMotion:
    """Cut from fragment to fragment at the joins, and let half of the offset die away on each side.

    The offset in position, velocity and acceleration of the two fragments at the join is taken from the left
    one and added to the right one in halves, each under :func:`quintic_decay`: both meet midway, and the
    motion is as smooth as the fragments up to the acceleration. Decays of neighbouring joins add up; at the
    ends of the utterance they are shortened, so that it begins and ends where the fragments do.

    Parameters
    ----------
    aligned : AlignedPieces
    length_s : float
        Of the decay on either side, s.

    Raises
    ------
    InputError
        The length is out of range.
    """
    if not 0 < length_s <= MOST_INERTIAL_S:
        raise InputError(
            f"The offset of an inertial join dies away in {length_s:g} s: more than 0 and at most "
            f"{MOST_INERTIAL_S:g} s were expected."
        )
    rate, cuts = aligned.rate_hz, _cuts(aligned)
    spans = [
        slice(a - p.start, b - p.start) for p, (a, b) in zip(aligned.pieces, pairwise(cuts), strict=True)
    ]
    captured = np.concatenate([p.motion_mm[span] for p, span in zip(aligned.pieces, spans, strict=True)])
    flags = np.concatenate([p.flags[span] for p, span in zip(aligned.pieces, spans, strict=True)])
    change = np.zeros_like(captured)
    reach = np.zeros(len(cuts) - 2)
    for k, cut in enumerate(cuts[1:-1]):
        left, right = (piece_state(p, cut, rate) for p in aligned.pieces[k : k + 2])
        half = 0.5 * np.array([b - a for a, b in zip(left, right, strict=True)])
        before = min(length_s, cut / rate)
        after = min(length_s, (len(captured) - 1 - cut) / rate)
        _add_decay(change[:cut][::-1], half * _BACKWARDS, before, rate, 1)
        _add_decay(change[cut:], -half, after, rate, 0)
        reach[k] = before + after
    deviation = np.sqrt((change**2).sum(axis=2).mean(axis=1))
    return InertialMotion(captured + change, flags, reach, deviation)


def _add_decay(change: FloatArray, offsets: FloatArray, length_s: float, rate_hz: float, first: int) -> None:
    """Add offsets (3, n_markers, 3) that die away to the frames `first`, `first` + 1, ... after a join."""
    n = min(len(change), int(length_s * rate_hz) + 1)
    weights = quintic_decay(np.arange(first, first + n) / rate_hz, max(length_s, 1e-9))
    change[:n] += np.tensordot(weights.T, offsets, axes=1)
