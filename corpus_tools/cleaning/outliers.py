"""Samples that cannot be where they were captured: spikes, exchanged markers, slips (beyond paper A).

A face moves together. What a marker does that the others do not tell is small and slow; a reflection that is
taken for a marker, two markers that exchange their names and a marker that slides on the skin are neither.
Speech, however fast, moves many markers, and so is told by the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import median_filter

from corpus_tools.cleaning.face_model import FaceModel
from corpus_tools.cleaning.gaps import frame_ranges
from corpus_tools.core import BoolArray, Capture, FloatArray, FrameFlag, IntArray, frozen, step

__all__ = ["Outliers", "find_outliers", "residuals_mm", "usual_spread_mm", "without_outliers"]

SPIKE_MM, SPIKE_SPREADS = 1.0, 8.0
"""A sample is a spike that lies this far off for a moment, in mm and in usual deviations (our choice)."""

ABRUPT = 0.6
"""Of its size, what a spike must come and go by from one frame to the next: motion takes longer."""

MOST_AT_ONCE = 4
"""Markers that may jump in one frame: more are no spikes."""

MOMENT_S = 0.1
"""Length of the running median that a spike stands out of, s; 5 frames at least."""

SWAP_SHARE = 0.25
"""Two markers are exchanged when the squared distances fall below this share if they change places."""

SWAP_FAR = 0.6
"""And when each lies at least this share of their distance off."""

SPAN_FRAMES = 2
"""Frames of a run of exchanges that are one: what lies between, up to so many, belongs to it."""

NEIGHBOURS = 6


@dataclass(frozen=True, slots=True, eq=False)
class Outliers:
    """What was found in one recording.

    Attributes
    ----------
    spiked, swapped : (n_frames, n_markers) bool
    swaps : tuple of (first frame, last frame, marker, marker)
    """

    spiked: BoolArray
    swapped: BoolArray
    swaps: tuple[tuple[int, int, int, int], ...]

    @property
    def doubted(self) -> BoolArray:
        """Samples that are either."""
        return self.spiked | self.swapped


def _bridged(positions: FloatArray) -> FloatArray:
    """Return positions with what is missing on a straight line between its neighbours in time."""
    whole = positions.reshape(len(positions), -1).copy()
    frames = np.arange(len(whole))
    for column in np.flatnonzero(~np.isfinite(whole).all(axis=0)):
        seen = np.isfinite(whole[:, column])
        if seen.any():
            whole[:, column] = np.interp(frames, frames[seen], whole[seen, column])
    return whole


def _precision(model: FaceModel) -> FloatArray:
    return np.asarray(np.linalg.inv(model.covariance_mm2))


def _told(away: FloatArray, precision: FloatArray, block: IntArray) -> FloatArray:
    """Return how far some coordinates lie from what all others tell, (n_frames, n_block) mm."""
    return np.asarray(np.linalg.solve(precision[np.ix_(block, block)], (away @ precision[:, block]).T).T)


def _residuals(away: FloatArray, precision: FloatArray) -> FloatArray:
    """Return the residual of each marker given all the others, (n_frames, n_markers, 3) mm."""
    n = precision.shape[0] // 3
    blocks = precision.reshape(n, 3, n, 3)[np.arange(n), :, np.arange(n)]
    pulled = (away @ precision).reshape(len(away), n, 3)
    return np.asarray(np.einsum("mij,fmj->fmi", np.linalg.inv(blocks), pulled))


def _moment_frames(rate_hz: float) -> int:
    return max(5, 2 * round(0.5 * MOMENT_S * rate_hz) + 1)


def _moment(values: FloatArray, rate_hz: float) -> FloatArray:
    """Return what stands out of the running median of the channels, (n_frames, ...)."""
    return values - median_filter(
        values, size=(_moment_frames(rate_hz), *[1] * (values.ndim - 1)), mode="nearest"
    )


def _away(capture: Capture, model: FaceModel) -> FloatArray:
    bridged = _bridged(np.asarray(capture.positions_mm))
    return np.where(np.isfinite(bridged), bridged - model.mean_mm, 0.0)


def residuals_mm(capture: Capture, model: FaceModel, markers: IntArray) -> FloatArray:
    """Return how far some markers lie from what the rest of them tell, (n_frames, n_markers, 3) mm."""
    block = (3 * markers[:, None] + np.arange(3)).ravel()
    precision = np.linalg.inv(model.covariance_mm2[np.ix_(block, block)])
    return _residuals(_away(capture, model)[:, block], np.asarray(precision))


def usual_spread_mm(captures: Sequence[Capture], model: FaceModel) -> FloatArray:
    """Return how far each marker usually leaves, for a moment, what the others tell, (n_markers,) mm.

    From the median of absolute values, as a standard deviation of one coordinate, so that outliers themselves
    do not widen it.
    """
    precision = _precision(model)
    found = [np.abs(_moment(_residuals(_away(c, model), precision), c.rate_hz)) for c in captures]
    return np.asarray(np.median(np.concatenate(found), axis=(0, 2)) / 0.6745)


def _worst_first(around: FloatArray, at: int, precision: FloatArray, limit: FloatArray) -> list[int]:
    """Return the markers of one frame that are beyond their limits, the farthest first.

    Each is judged by all but itself and those found before it: one that jumps pulls at what is told of its
    neighbours. `around` are the frames of the running median, and `at` is the one that is looked at.
    """
    found: list[int] = []
    left = np.arange(len(limit))
    while len(found) < MOST_AT_ONCE:
        block = (3 * left[:, None] + np.arange(3)).ravel()
        rest = _residuals(around[:, block], precision[np.ix_(block, block)])
        size = np.linalg.norm(rest[at] - np.median(rest, axis=0), axis=1)
        worst = int(np.argmax(size / limit[left]))
        if size[worst] <= limit[left[worst]]:
            break
        precision = _without(precision, int(left[worst]))
        found.append(int(left[worst]))
        left = np.delete(left, worst)
    return found


def _without(precision: FloatArray, marker: int) -> FloatArray:
    """Return the precision of all markers when nothing is known of one; its own rows mean nothing then."""
    own = slice(3 * marker, 3 * marker + 3)
    pull = precision[:, own]
    return precision - pull @ np.linalg.solve(precision[own, own], pull.T)


def _spikes(
    away: FloatArray, residual: FloatArray, precision: FloatArray, spread: FloatArray, rate_hz: float
) -> BoolArray:
    """Return the samples that leave for a moment what the others tell, (n_frames, n_markers)."""
    far = np.linalg.norm(_moment(residual, rate_hz), axis=2)
    limit = np.maximum(SPIKE_MM, SPIKE_SPREADS * np.sqrt(3.0) * spread)
    half = _moment_frames(rate_hz) // 2
    found = np.zeros(far.shape, bool)
    for frame in map(int, np.flatnonzero((far > limit).any(axis=1))):
        low = max(0, frame - half)
        around = away[low : frame + half + 1]
        found[frame, _worst_first(around, frame - low, precision, limit)] = True
    jumps = np.linalg.norm(np.diff(residual, axis=0, prepend=residual[:1], append=residual[-1:]), axis=2)
    for marker in np.flatnonzero(found.any(axis=0)):
        for a, b in frame_ranges(found[:, marker]):
            comes = a == 0 or jumps[a, marker] > ABRUPT * far[a, marker]
            goes = b == len(found) - 1 or jumps[b + 1, marker] > ABRUPT * far[b, marker]
            if not (comes and goes):
                found[a : b + 1, marker] = False
    return found


def _neighbours(shape_mm: FloatArray) -> list[tuple[int, int]]:
    distance = np.linalg.norm(shape_mm[:, None] - shape_mm, axis=2)
    nearest = np.argsort(distance, axis=1)[:, 1 : NEIGHBOURS + 1]
    return sorted({(min(i, int(j)), max(i, int(j))) for i, row in enumerate(nearest) for j in row})


def _exchanged(
    away: FloatArray, shape: FloatArray, precision: FloatArray, pair: tuple[int, int]
) -> BoolArray:
    """Return in which frames two markers fit what the others tell far better in each other's place."""
    i, j = pair
    block = np.r_[3 * i : 3 * i + 3, 3 * j : 3 * j + 3]
    rest = _told(away, precision, block).reshape(len(away), 2, 3)
    seen = away[:, block].reshape(len(away), 2, 3) + shape[[i, j]]
    told = seen - rest
    as_is = (rest**2).sum(axis=(1, 2))
    other = ((seen[:, ::-1] - told) ** 2).sum(axis=(1, 2))
    apart = ((told[:, 0] - told[:, 1]) ** 2).sum(axis=1)
    least = np.min((rest**2).sum(axis=2), axis=1)
    return np.asarray((other < SWAP_SHARE * as_is) & (least > SWAP_FAR**2 * apart) & (apart > SPIKE_MM**2))


def _swaps(
    away: FloatArray, residual: FloatArray, model: FaceModel, precision: FloatArray
) -> list[tuple[int, int, int, int]]:
    """Return (first, last, marker, marker) of the exchanges; only pairs with both far off are looked at."""
    shape = model.mean_mm.reshape(-1, 3)
    far = np.linalg.norm(residual, axis=2)
    found = []
    for i, j in _neighbours(shape):
        least = 0.15 * np.linalg.norm(shape[i] - shape[j])
        if not ((far[:, i] > least) & (far[:, j] > least)).any():
            continue
        frames = _exchanged(away, shape, precision, (i, j))
        joined = np.convolve(frames, np.ones(SPAN_FRAMES + 1), "same") > 0 if frames.any() else frames
        for a, b in frame_ranges(np.asarray(joined)):
            inside = np.flatnonzero(frames[a : b + 1]) + a
            found.append((int(inside[0]), int(inside[-1]), i, j))
    return sorted(found)


def find_outliers(capture: Capture, model: FaceModel, spread_mm: FloatArray) -> Outliers:
    """Find spikes and exchanged markers in a head-stabilised recording.

    Parameters
    ----------
    capture : Capture
        Head-stabilised, neither filled nor smoothed.
    model : FaceModel
        How the markers of this face move together.
    spread_mm : (n_markers,) mm
        From :func:`usual_spread_mm`.
    """
    precision = _precision(model)
    away = _away(capture, model)
    residual = _residuals(away, precision)
    missing = ~np.isfinite(capture.positions_mm).all(axis=2)
    swapped = np.zeros(missing.shape, bool)
    swaps = _swaps(away, residual, model, precision)
    for first, last, i, j in swaps:
        swapped[first : last + 1, [i, j]] = True
    spiked = _spikes(away, residual, precision, spread_mm, capture.rate_hz) & ~swapped
    return Outliers(frozen(spiked & ~missing, np.bool_), frozen(swapped & ~missing, np.bool_), tuple(swaps))


def without_outliers(capture: Capture, found: Outliers) -> Capture:
    """Return the capture with spikes and exchanged markers taken out: missing, and flagged as outliers.

    What fills them later keeps the flag, which stays with the frames to selection and the join report.
    """
    if not found.doubted.any():
        return capture
    assert capture.flags is not None
    positions, flags = np.array(capture.positions_mm), np.array(capture.flags)
    positions[found.doubted] = np.nan
    flags[found.doubted] = (flags[found.doubted] & ~np.uint8(FrameFlag.MEASURED)) | np.uint8(
        FrameFlag.OUTLIER
    )
    done = step(
        "without_outliers",
        spikes=int(found.spiked.sum()),
        swaps=", ".join(f"{capture.names[i]}-{capture.names[j]} {a}-{b}" for a, b, i, j in found.swaps),
    )
    return capture.with_step(done, positions_mm=positions, flags=flags)
