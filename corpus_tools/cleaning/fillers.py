"""The ways to fill a gap: by the other markers and a process, by a process alone, by cosines."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from corpus_tools.cleaning.face_model import FaceModel
from corpus_tools.cleaning.series import fill_dct, fill_led, fill_process
from corpus_tools.core import BoolArray, FloatArray, IntArray, Registry

__all__ = ["GAP_FILLERS", "LEAST_OTHERS", "Filler", "others_tell"]

WINDOW_S = 2.0
"""Motion on either side of a gap that its filling looks at, s."""

OWN_WINDOW_S = 0.5
"""The same where only the marker itself is looked at, or twice the gap when that is longer, s."""

DCT_CUTOFF_HZ = 12.0
LEAST_OTHERS = 8
"""Markers that must be seen throughout a gap to tell where the hidden ones are."""

Filler = Callable[
    [FloatArray, float, tuple[int, int], IntArray, FaceModel | None], tuple[FloatArray, FloatArray]
]
"""(positions, rate, gap (first, last), its markers, model) -> filled (n, n_markers, 3), sd (n, n_markers);
both in mm, NaN where it cannot say."""

Series = Callable[[FloatArray, FloatArray, BoolArray, BoolArray], tuple[FloatArray, FloatArray]]

GAP_FILLERS: Registry[Filler] = Registry("gap filling")


def _window(n_frames: int, gap: tuple[int, int], reach: int) -> slice:
    return slice(max(0, gap[0] - reach), min(n_frames, gap[1] + 1 + reach))


def _unknown(gap: tuple[int, int], markers: IntArray) -> tuple[FloatArray, FloatArray]:
    n = gap[1] - gap[0] + 1
    return np.full((n, len(markers), 3), np.nan), np.full((n, len(markers)), np.nan)


@GAP_FILLERS.register("dct")
def cosines(
    positions: FloatArray, rate_hz: float, gap: tuple[int, int], markers: IntArray, model: FaceModel | None
) -> tuple[FloatArray, FloatArray]:
    """Fill by the cosines that fit what is seen on both sides; a gap at an end is left to the smoother."""
    cutoff = min(DCT_CUTOFF_HZ, 0.45 * rate_hz)
    return _by_itself(positions, rate_hz, gap, markers, partial(fill_dct, cutoff_hz=cutoff))


def _by_itself(
    positions: FloatArray, rate_hz: float, gap: tuple[int, int], markers: IntArray, fill: Series
) -> tuple[FloatArray, FloatArray]:
    reach = round(max(OWN_WINDOW_S * rate_hz, 2 * (gap[1] - gap[0] + 1)))
    span = _window(len(positions), gap, reach)
    part = positions[span][:, markers]
    frames = np.arange(len(positions))[span]
    hidden = (frames >= gap[0]) & (frames <= gap[1])
    seen = np.isfinite(part).all(axis=(1, 2)) & ~hidden
    if not (seen[frames < gap[0]].sum() > 1 and seen[frames > gap[1]].sum() > 1):
        return _unknown(gap, markers)
    filled, sd = np.empty((hidden.sum(), len(markers), 3)), np.empty((hidden.sum(), len(markers)))
    for k in range(len(markers)):
        filled[:, k], sd[:, k] = fill(frames / rate_hz, part[:, k], seen, hidden)
    return filled, sd


def others_tell(seen: BoolArray, gap: tuple[int, int]) -> bool:
    """Return whether enough markers are seen throughout a gap to tell where the hidden ones are."""
    return int(seen[gap[0] : gap[1] + 1].all(axis=0).sum()) >= LEAST_OTHERS


def _others(seen: BoolArray, span: slice, gap: tuple[int, int]) -> IntArray:
    """Return the markers that are seen throughout the window, or at least throughout the gap."""
    steady = np.flatnonzero(seen[gap[0] : gap[1] + 1].all(axis=0))
    always = steady[seen[span][:, steady].mean(axis=0) > 0.999]
    return always if len(always) >= LEAST_OTHERS else steady


@GAP_FILLERS.register("pca-gp")
def together(
    positions: FloatArray, rate_hz: float, gap: tuple[int, int], markers: IntArray, model: FaceModel | None
) -> tuple[FloatArray, FloatArray]:
    """Fill by what the other markers say, and by a process for what a marker does of its own.

    Where the marker's own motion explains itself better, as in short gaps of smooth motion, it alone is used;
    where too few others are seen, cosines are.
    """
    seen: BoolArray = np.asarray(np.isfinite(positions).all(axis=2))
    if model is None or not others_tell(seen, gap):
        return cosines(positions, rate_hz, gap, markers, model)
    span = _window(len(positions), gap, round(WINDOW_S * rate_hz))
    others = _others(seen, span, gap)
    frames = np.arange(len(positions))[span]
    hidden = (frames >= gap[0]) & (frames <= gap[1])
    known = seen[span][:, others].all(axis=1) & seen[span][:, markers].all(axis=1) & ~hidden
    leading = positions[span][known | hidden][:, others]
    guess = model.predict(leading, others, markers)
    if known.sum() < 5:
        return guess[hidden[known | hidden]], np.full((hidden.sum(), len(markers)), np.sqrt(model.noise_mm2))
    rows = known | hidden
    own = positions[span][rows][:, markers]
    times, given, asked = frames[rows] / rate_hz, known[rows], hidden[rows]
    leaders = model.weights(leading, others) / np.sqrt(model.variances)
    filled, sd = guess[asked], np.empty((int(asked.sum()), len(markers)))
    for k in range(len(markers)):
        filled[:, k], sd[:, k] = fill_led(times, own[:, k], given, asked, guess[:, k], leaders)
    return filled, sd


@GAP_FILLERS.register("gp")
def alone(
    positions: FloatArray, rate_hz: float, gap: tuple[int, int], markers: IntArray, model: FaceModel | None
) -> tuple[FloatArray, FloatArray]:
    """Fill by a process that explains what is seen of the marker on both sides, and by nothing else."""
    return _by_itself(positions, rate_hz, gap, markers, fill_process)


@GAP_FILLERS.register("kalman")
def left_to_the_smoother(
    positions: FloatArray, rate_hz: float, gap: tuple[int, int], markers: IntArray, model: FaceModel | None
) -> tuple[FloatArray, FloatArray]:
    """Fill nothing: the Kalman smoother that comes next bridges the gap."""
    return _unknown(gap, markers)
