"""Synthesised motion: marker positions over time, with the joins it was made from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from corpus_tools.core.arrays import FloatArray, frozen
from corpus_tools.core.history import History

__all__ = ["Join", "Trajectory"]


@dataclass(frozen=True, slots=True)
class Join:
    """One join between two fragments (columns of ``joins.csv``).

    The gaps are rms over markers of the difference of the two aligned fragments at `time_s`, before blending:
    position (mm), velocity (mm/s), acceleration (mm/s2). `overlap_s` is the time over which the join is
    spread: the cross-fade, or both decays of an inertial join. `natural_percentile` says where the blended
    peak acceleration around the join stands in the natural distribution of the corpus, 0-100; NaN when
    unknown. `flagged` is the share of marker samples of both fragments within the overlap that were filled,
    are doubtful or were outliers, 0 to 1. `peak_ratio` is that peak acceleration over the natural 95th
    percentile; NaN when unknown.
    """

    index: int
    time_s: float
    phone: str
    left_source: str
    right_source: str
    overlap_s: float
    gap_mm: float
    gap_mm_s: float
    gap_mm_s2: float
    natural_percentile: float = float("nan")
    flagged: float = 0.0
    peak_ratio: float = float("nan")


@dataclass(frozen=True, slots=True, eq=False)
class Trajectory:
    """Marker motion on a uniform clock.

    Attributes
    ----------
    times_s : (n_frames,) float64, s
    values_mm : (n_frames, n_markers, 3) float64, mm
    names : tuple of str
    joins : tuple of Join
    flags : (n_frames, n_markers) uint8
        Bits of :class:`~corpus_tools.core.capture.FrameFlag` carried over from the fragments.
    history : tuple of Step
    """

    times_s: FloatArray
    values_mm: FloatArray
    names: tuple[str, ...]
    joins: tuple[Join, ...] = ()
    flags: npt.NDArray[np.uint8] | None = None
    history: History = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "times_s", frozen(self.times_s))
        object.__setattr__(self, "values_mm", frozen(self.values_mm))
        object.__setattr__(self, "names", tuple(self.names))
        flags = np.ones(self.values_mm.shape[:2], np.uint8) if self.flags is None else self.flags
        object.__setattr__(self, "flags", frozen(flags, np.uint8))

    @property
    def rate_hz(self) -> float:
        """Frames per second of the uniform clock."""
        return 1.0 / float(np.median(np.diff(self.times_s)))

    @property
    def peak_ratios(self) -> tuple[float, ...]:
        """Of each join: its peak acceleration over the natural 95th percentile, NaN when unknown."""
        return tuple(join.peak_ratio for join in self.joins)
