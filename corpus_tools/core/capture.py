"""Captured motion: marker positions with per-frame flags, and the sound recorded with them."""

from __future__ import annotations

import enum
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from corpus_tools.core.arrays import BoolArray, FloatArray, IntArray, frozen
from corpus_tools.core.errors import MotionError
from corpus_tools.core.history import History, Step

__all__ = ["FLAGGED", "SPEECH_REGIONS", "Audio", "Capture", "FrameFlag", "region_columns"]

SPEECH_REGIONS = ("lip_out", "lip_in", "chin")
"""Regions of the markers that speech moves most."""


class FrameFlag(enum.IntFlag):
    """What a marker sample is; the flags stay with the frames from the file to the join report.

    OUTLIER: it was captured where it cannot have been (a spike, exchanged markers), and was replaced.
    """

    MISSING = 0
    MEASURED = 1
    FILLED = 2
    DOUBTFUL = 4
    OUTLIER = 8


FLAGGED = np.uint8(FrameFlag.FILLED | FrameFlag.DOUBTFUL | FrameFlag.OUTLIER)
"""Any of these: a sample to be wary of."""


@dataclass(frozen=True, slots=True, eq=False)
class Audio:
    """Mono sound: float32 samples in [-1, 1], shape (n_samples,), and their rate."""

    samples: npt.NDArray[np.float32]
    rate_hz: int

    def __post_init__(self) -> None:
        object.__setattr__(self, "samples", frozen(self.samples, np.float32))

    @property
    def duration_s(self) -> float:
        """Length in seconds."""
        return len(self.samples) / self.rate_hz


@dataclass(frozen=True, slots=True, eq=False)
class Capture:
    """Motion of markers on a face (paper A section 4).

    Attributes
    ----------
    positions_mm : (n_frames, n_markers, 3) float64, mm
        NaN where a marker is missing; y up, z out of the face.
    rate_hz : float
    names, regions : tuple of str, n_markers each
    flags : (n_frames, n_markers) uint8
        Bits of :class:`FrameFlag`; made from the NaNs when not given.
    start_s : float
        Time of frame 0 on the clock of the audio (0.5 / rate_hz for centred frames).
    audio : Audio or None
    history : tuple of Step
    """

    positions_mm: FloatArray
    rate_hz: float
    names: tuple[str, ...]
    regions: tuple[str, ...] = ()
    flags: npt.NDArray[np.uint8] | None = None
    start_s: float = 0.0
    audio: Audio | None = None
    history: History = ()

    def __post_init__(self) -> None:
        positions = frozen(self.positions_mm)
        names = tuple(str(n) for n in self.names)
        _check_positions(positions, names, self.rate_hz)
        flags = self.flags
        if flags is None:
            flags = np.isfinite(positions).all(axis=2).astype(np.uint8) * np.uint8(FrameFlag.MEASURED)
        for key, value in {
            "positions_mm": positions,
            "names": names,
            "regions": tuple(self.regions) or tuple(region_of(n) for n in names),
            "flags": frozen(flags, np.uint8),
        }.items():
            object.__setattr__(self, key, value)

    @property
    def n_frames(self) -> int:
        """Number of frames."""
        return int(self.positions_mm.shape[0])

    @property
    def times_s(self) -> FloatArray:
        """Time of each frame in seconds, shape (n_frames,)."""
        return self.start_s + np.arange(self.n_frames) / self.rate_hz

    @property
    def duration_s(self) -> float:
        """n_frames / rate_hz, in seconds."""
        return self.n_frames / self.rate_hz

    @property
    def measured(self) -> BoolArray:
        """Samples that were captured, neither filled nor doubtful, (n_frames, n_markers)."""
        assert self.flags is not None
        kept = self.flags & (FrameFlag.MEASURED | FrameFlag.FILLED | FrameFlag.DOUBTFUL)
        return np.asarray(kept == FrameFlag.MEASURED)

    @property
    def flagged(self) -> BoolArray:
        """Samples that were filled, are doubtful or were outliers, (n_frames, n_markers)."""
        assert self.flags is not None
        return np.asarray((self.flags & FLAGGED) > 0)

    def indices(self, names: tuple[str, ...] | list[str]) -> IntArray:
        """Return the column of each marker name, shape (len(names),).

        Raises
        ------
        MotionError
            A name is not among the markers; the message names it.
        """
        where = {n: i for i, n in enumerate(self.names)}
        missing = [n for n in names if n not in where]
        if missing:
            raise MotionError(f"The capture has no marker '{missing[0]}'; it has {', '.join(self.names)}.")
        return np.array([where[n] for n in names], dtype=np.int64)

    def with_step(self, step: Step, **changes: Any) -> Capture:
        """Return a copy with `changes` applied and `step` appended to the history."""
        return replace(self, history=(*self.history, step), **changes)


def region_of(name: str) -> str:
    """Return the region a marker name stands for: its letters before the number ("lip_in3" -> "lip_in")."""
    return name.rstrip("0123456789").rstrip("_") or name


def region_columns(regions: Sequence[str], wanted: Collection[str] | None) -> IntArray:
    """Return the columns of the markers of some regions; all when None, or when there are none of them.

    Parameters
    ----------
    regions : sequence of str
        Of every marker.
    wanted : collection of str or None
        Such as :data:`SPEECH_REGIONS`.
    """
    found = [i for i, region in enumerate(regions) if wanted is not None and region in wanted]
    return np.array(found or range(len(regions)), dtype=np.int64)


def _check_positions(positions: FloatArray, names: tuple[str, ...], rate_hz: float) -> None:
    if positions.ndim != 3 or positions.shape[2] != 3:
        raise MotionError(
            f"Marker positions have shape {positions.shape}; (frames, markers, 3) was expected."
        )
    if positions.shape[1] != len(names):
        raise MotionError(f"There are {positions.shape[1]} markers and {len(names)} marker names.")
    if len(set(names)) != len(names):
        twice = next(n for n in names if names.count(n) > 1)
        raise MotionError(f"The marker name '{twice}' stands more than once.")
    if not rate_hz > 0:
        raise MotionError(f"The frame rate is {rate_hz:g}; a positive number of Hz was expected.")
