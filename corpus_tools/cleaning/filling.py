"""Filling of gaps, each filled sample with its uncertainty and its flag (paper A section 4)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from corpus_tools.cleaning.face_model import FaceModel
from corpus_tools.cleaning.gaps import frame_ranges
from corpus_tools.cleaning.series import fill_dct, fill_process
from corpus_tools.core import BoolArray, Capture, FloatArray, FrameFlag, IntArray, Registry, step

__all__ = ["GAP_FILLERS", "fill_gaps"]

WINDOW_S = 2.0
"""Motion on either side of a gap that its filling looks at, s."""

DCT_WINDOW_S = 0.5
"""The same for the cosines, or twice the gap when that is longer, s."""

DCT_CUTOFF_HZ = 12.0
LEAST_OTHERS = 8
"""Markers that must be seen throughout a gap to tell where the hidden ones are."""

Filler = Callable[
    [FloatArray, float, tuple[int, int], IntArray, FaceModel | None], tuple[FloatArray, FloatArray]
]
"""(positions, rate, gap (first, last), its markers, model) -> filled (n, n_markers, 3), sd (n, n_markers);
both in mm, NaN where it cannot say."""

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
    reach = round(max(DCT_WINDOW_S * rate_hz, 2 * (gap[1] - gap[0] + 1)))
    span = _window(len(positions), gap, reach)
    part = positions[span][:, markers]
    frames = np.arange(len(positions))[span]
    hidden = (frames >= gap[0]) & (frames <= gap[1])
    seen = np.isfinite(part).all(axis=(1, 2)) & ~hidden
    if not (seen[frames < gap[0]].sum() > 1 and seen[frames > gap[1]].sum() > 1):
        return _unknown(gap, markers)
    filled, sd = np.empty((hidden.sum(), len(markers), 3)), np.empty((hidden.sum(), len(markers)))
    cutoff = min(DCT_CUTOFF_HZ, 0.45 * rate_hz)
    for k in range(len(markers)):
        filled[:, k], sd[:, k] = fill_dct(frames / rate_hz, part[:, k], seen, hidden, cutoff)
    return filled, sd


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

    Where the marker's own motion tells more, as in short gaps of smooth motion, it alone is used; where too
    few others are seen, cosines are.
    """
    seen: BoolArray = np.asarray(np.isfinite(positions).all(axis=2))
    span = _window(len(positions), gap, round(WINDOW_S * rate_hz))
    others = _others(seen, span, gap)
    if model is None or len(others) < LEAST_OTHERS:
        return cosines(positions, rate_hz, gap, markers, model)
    frames = np.arange(len(positions))[span]
    hidden = (frames >= gap[0]) & (frames <= gap[1])
    known = seen[span][:, others].all(axis=1) & seen[span][:, markers].all(axis=1) & ~hidden
    guess = model.predict(positions[span][known | hidden][:, others], others, markers)
    if known.sum() < 5:
        return guess[hidden[known | hidden]], np.full((hidden.sum(), len(markers)), np.sqrt(model.noise_mm2))
    rows = known | hidden
    own = positions[span][rows][:, markers]
    times, given, asked = frames[rows] / rate_hz, known[rows], hidden[rows]
    filled, sd = guess[asked], np.empty((int(asked.sum()), len(markers)))
    for k in range(len(markers)):
        rest, sd[:, k] = fill_process(times, own[:, k] - guess[:, k], given, asked)
        alone, alone_sd = fill_process(times, own[:, k], given, asked)
        filled[:, k] += rest
        if alone_sd.mean() < sd[:, k].mean():
            filled[:, k], sd[:, k] = alone, alone_sd
    return filled, sd


@GAP_FILLERS.register("kalman")
def left_to_the_smoother(
    positions: FloatArray, rate_hz: float, gap: tuple[int, int], markers: IntArray, model: FaceModel | None
) -> tuple[FloatArray, FloatArray]:
    """Fill nothing: the Kalman smoother that comes next bridges the gap."""
    return _unknown(gap, markers)


def _gap_groups(seen: BoolArray) -> dict[tuple[int, int], list[int]]:
    """Return the gaps (first, last) and the markers that have each."""
    found: dict[tuple[int, int], list[int]] = {}
    for column in np.flatnonzero(~seen.all(axis=0) & seen.any(axis=0)):
        for gap in frame_ranges(~seen[:, column]):
            found.setdefault(gap, []).append(int(column))
    return found


def fill_gaps(
    capture: Capture,
    method: str = "pca-gp",
    *,
    model: FaceModel | None = None,
    longest_s: float = 1.0,
    doubt_mm: float = 1.0,
) -> tuple[Capture, FloatArray]:
    """Fill what is missing; what was measured is not touched.

    Parameters
    ----------
    capture : Capture
        In the head-stabilised space, not smoothed yet.
    method : str
        A name of :data:`GAP_FILLERS`.
    model : FaceModel, optional
        How the markers of this face move together, for "pca-gp".
    longest_s : float
        A longer gap is filled too, but marked doubtful.
    doubt_mm : float
        Uncertainty (one standard deviation) from which on a filled sample is marked doubtful, mm.

    Returns
    -------
    Capture
        Filled samples are flagged. What a method cannot say stays NaN: a marker that is never seen, and a gap
        of the whole face at either end; the smoother holds the nearest pose there and marks it doubtful.
    sd_mm : (n_frames, n_markers) mm
        One standard deviation of each filled sample (of a coordinate); 0 where nothing was filled.

    Raises
    ------
    InputError
        There is no such method.
    """
    filler = GAP_FILLERS[method]
    positions = np.array(capture.positions_mm)
    seen: BoolArray = np.asarray(np.isfinite(positions).all(axis=2))
    sd_mm = np.zeros(seen.shape)
    if seen.all():
        return capture, sd_mm
    assert capture.flags is not None
    flags, filled = np.array(capture.flags), np.zeros(seen.shape, bool)
    measured = np.where(seen[..., None], positions, np.nan)
    for gap, columns in _gap_groups(seen).items():
        markers = np.array(columns)
        values, sd = filler(measured, capture.rate_hz, gap, markers, model)
        block = np.ix_(np.arange(gap[0], gap[1] + 1), markers)
        said = np.isfinite(values).all(axis=2)
        positions[block] = values
        sd_mm[block] = np.where(said, sd, 0.0)
        long = (gap[1] - gap[0] + 1) / capture.rate_hz > longest_s
        doubt = np.where(long | (sd > doubt_mm), FrameFlag.DOUBTFUL, 0).astype(np.uint8)
        marked = (flags[block] & FrameFlag.DOUBTFUL) | np.uint8(FrameFlag.FILLED) | doubt
        flags[block] = np.where(said, marked, flags[block])
        filled[block] = said
    done = step(
        "fill_gaps", method=method, samples=int(filled.sum()), largest_sd_mm=round(float(sd_mm.max()), 4)
    )
    return capture.with_step(done, positions_mm=positions, flags=flags), sd_mm
