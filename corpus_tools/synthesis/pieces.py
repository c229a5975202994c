"""Fragments laid onto the clock of the target, ready to be blended: what a change of g(u) need not repeat."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from corpus_tools.core import FloatArray, Fragment, FrameFlag, Selection, Utterance, frozen
from corpus_tools.synthesis.alignment import REST_S, TimeWarp, WarpKind, fragment_warp, rest_clock
from corpus_tools.synthesis.resampling import fit_time_rbf, resample_uniform

__all__ = ["MARGIN_S", "AlignedPieces", "Piece", "align_fragments"]

MARGIN_S = 0.26
"""Motion kept on both sides of a unit's centres: half the longest overlap that can be asked for."""

Resampling = Literal["inverse", "paper"]


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """One fragment on the target's clock.

    Attributes
    ----------
    source : str
        ``recording:first-last``.
    first, last : int
        Target phones that it speaks.
    start : int
        Index of its first sample among the target's frames.
    motion_mm : (n, n_markers, 3) float64, mm
    flags : (n, n_markers) uint8
        Doubtful too where a time outside the captured range was asked for.
    cond : float
        Condition number of the resampling.
    outside : int
        Samples for which a time outside the captured range was asked; they hold its end.
    """

    source: str
    first: int
    last: int
    start: int
    motion_mm: FloatArray
    flags: npt.NDArray[np.uint8]
    cond: float
    outside: int = 0

    @property
    def stop(self) -> int:
        """Index after its last sample among the target's frames."""
        return self.start + len(self.motion_mm)


@dataclass(frozen=True, slots=True, eq=False)
class AlignedPieces:
    """All fragments of an utterance on its clock.

    Attributes
    ----------
    utterance : Utterance
    times_s : (n_frames,) s
        Uniform, from 0 to the end of the utterance.
    names : tuple of str
        Marker names.
    pieces : tuple of Piece
    settings : tuple of (str, value)
        For the history of the result.
    """

    utterance: Utterance
    times_s: FloatArray
    names: tuple[str, ...]
    pieces: tuple[Piece, ...]
    settings: tuple[tuple[str, object], ...]

    @property
    def rate_hz(self) -> float:
        """Frames per second of the target."""
        return 1.0 / float(self.times_s[1] - self.times_s[0])

    @property
    def join_phones(self) -> tuple[int, ...]:
        """Index of the phone that is shared at each join."""
        return tuple(piece.last for piece in self.pieces[:-1])

    @property
    def join_times_s(self) -> FloatArray:
        """Centres of the shared phones, s."""
        phones = self.utterance.phones.intervals
        return np.array([phones[j].centre_s for j in self.join_phones])


def _source_times(
    warp: TimeWarp, times: FloatArray, fragment: Fragment
) -> tuple[FloatArray, npt.NDArray[np.bool_]]:
    """Return the captured times to read, and where the capture had nothing there."""
    asked = warp.to_source(times)
    slack = 0.5 * float(np.median(np.diff(fragment.times_s))) + 1e-9
    outside = (asked < fragment.times_s[0] - slack) | (asked > fragment.times_s[-1] + slack)
    return np.clip(asked, fragment.times_s[0], fragment.times_s[-1]), outside


def _flags_at(fragment: Fragment, asked: FloatArray, outside: npt.NDArray[np.bool_]) -> npt.NDArray[np.uint8]:
    """Return the flags of the captured frames on either side of each time, joined."""
    right = np.clip(np.searchsorted(fragment.times_s, asked), 1, len(fragment.times_s) - 1)
    flags = fragment.flags[right - 1] | fragment.flags[right]
    return np.where(outside[:, None], flags | np.uint8(FrameFlag.DOUBTFUL), flags).astype(np.uint8)


def _resample(
    fragment: Fragment, warp: TimeWarp, times: FloatArray, mode: Resampling, c: float
) -> tuple[FloatArray, npt.NDArray[np.uint8], float, int]:
    asked, outside = _source_times(warp, times, fragment)
    if mode == "inverse":
        rate = 1.0 / float(np.median(np.diff(fragment.times_s)))
        motion, cond = resample_uniform(float(fragment.times_s[0]), rate, fragment.motion_mm, asked, c)
    else:
        curve = fit_time_rbf(warp.to_target(fragment.times_s), fragment.motion_mm, c)
        motion, cond = curve(warp.to_target(asked)), curve.cond
    return motion, _flags_at(fragment, asked, outside), cond, int(outside.sum())


def align_fragments(
    selection: Selection,
    utterance: Utterance,
    fragments: Sequence[Fragment],
    *,
    names: Sequence[str],
    rate_hz: float = 120.0,
    warp: WarpKind = "linear",
    resampling: Resampling = "inverse",
    c: float = 0.2,
    silence: str = "SIL",
) -> AlignedPieces:
    """Warp and resample the chosen fragments (paper A section 5.1.2).

    Parameters
    ----------
    selection : Selection
    utterance : Utterance
    fragments : sequence of Fragment
        One for each chosen unit, in order, with motion on both sides.
    names : sequence of str
        Marker names.
    rate_hz : float
        Of the result, Hz.
    warp : {"linear", "pchip"}
    resampling : {"inverse", "paper"}
        "inverse" fits the captured samples once on their own uniform clock and reads the curve at the warped
        times (default: 30 to 700 times more accurate, our measurement); "paper" fits the warped samples.
    c : float
        Shape of the inverse multiquadric.
    silence : str
        Label of silence.

    Raises
    ------
    SynthesisError
        The resampling is ill-conditioned.
    """
    phones = utterance.phones.intervals
    duration = utterance.duration_s
    times = np.arange(int(np.floor(duration * rate_hz + 1e-6)) + 1) / rate_hz
    lead = min(REST_S, 0.5 * phones[0].duration_s) if phones[0].text == silence else 0.0
    tail = min(REST_S, 0.5 * phones[-1].duration_s) if phones[-1].text == silence else 0.0
    clock = rest_clock(times, float(times[-1]), lead, tail)
    pieces = []
    for chosen, fragment in zip(selection.chosen, fragments, strict=True):
        low = 0 if chosen.first == 0 else _index(phones[chosen.first].centre_s - MARGIN_S, rate_hz)
        at_end = chosen.last == len(phones) - 1
        high = len(times) if at_end else _index(phones[chosen.last].centre_s + MARGIN_S, rate_hz) + 1
        low, high = max(0, low), min(len(times), high)
        mapping = fragment_warp(fragment, phones[chosen.first : chosen.last + 1], warp, silence)
        motion, flags, cond, outside = _resample(fragment, mapping, clock[low:high], resampling, c)
        place = chosen.unit.key, chosen.first, chosen.last, low
        pieces.append(Piece(*place, frozen(motion), flags, cond, outside))
    settings = (("c", c), ("resampling", resampling), ("warp", warp))
    return AlignedPieces(utterance, frozen(times), tuple(names), tuple(pieces), settings)


def _index(time_s: float, rate_hz: float) -> int:
    return int(np.floor(time_s * rate_hz))
