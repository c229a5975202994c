"""Markers that slide on the skin and a jig that slips on the head: steps that stay (beyond paper A)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import median_filter

from corpus_tools.cleaning.face_model import FaceModel
from corpus_tools.cleaning.head_motion import estimate_head_motion
from corpus_tools.cleaning.outliers import residuals_mm
from corpus_tools.core import Capture, FloatArray, FrameFlag, IntArray, MotionError, step

__all__ = ["Slip", "find_slips", "with_slips_marked"]

SLIP_MM, SLIP_SPREADS = 0.8, 5.0
"""A step that stays is a slip from this size on, in mm and in usual deviations (both; our choice)."""

SETTLING_S = 0.25
"""Length of the running median in which a step is looked for, s."""

STAYING = 0.7
"""Share of a step that must be left when all of the motion before and after is compared."""

AT_ENDS_S = 0.5
"""Motion that is needed on either side, s."""


@dataclass(frozen=True, slots=True)
class Slip:
    """One slip.

    Attributes
    ----------
    marker : int
        Column, or -1: the head markers against the face.
    frame : int
        First frame behind it.
    size_mm : float
    """

    marker: int
    frame: int
    size_mm: float


def _step(track: FloatArray, rate_hz: float) -> tuple[int, FloatArray] | None:
    """Return frame and vector (3,) mm of the one step that stays in a track (n_frames, 3), or None."""
    n, half, least = len(track), max(3, round(0.5 * SETTLING_S * rate_hz)), round(AT_ENDS_S * rate_hz)
    if n < 2 * least + 2:
        return None
    low = median_filter(track, size=(2 * half + 1, 1), mode="nearest")
    jump = np.linalg.norm(low[2 * half :] - low[: -2 * half], axis=1)
    jump[: max(0, least - half)] = 0.0
    jump[len(jump) - max(0, least - half) :] = 0.0
    if not jump.any():
        return None
    frame = int(np.argmax(jump)) + half
    before, after = np.median(track[: frame - half], axis=0), np.median(track[frame + half :], axis=0)
    stays = float(np.linalg.norm(after - before))
    rest = np.concatenate([low[: frame - half] - before, low[frame + half :] - after])
    spread = float(np.median(np.linalg.norm(rest, axis=1)))
    size = float(jump.max())
    if stays < max(SLIP_MM, SLIP_SPREADS * spread) or stays < STAYING * size or size < STAYING * stays:
        return None
    along = (low - before) @ (after - before) / stays**2
    near = slice(frame - half, frame + half + 1)
    return frame - half + int(np.argmax(along[near] > 0.5)), np.asarray(after - before)


def _face_as_whole(positions: FloatArray, face: IntArray, rate_hz: float) -> FloatArray:
    """Return how the quiet half of the face is displaced as a whole, (n_frames, 3) mm.

    The median over markers of the displacement from the first half second: a slip in the middle of a
    recording has no place that is usual.
    """
    seen = face[np.isfinite(positions[:, face]).all(axis=(0, 2))]
    if len(seen) < 4:
        return np.zeros((len(positions), 3))
    away = positions[:, seen] - np.median(positions[: max(1, round(AT_ENDS_S * rate_hz)), seen], axis=0)
    quiet = np.argsort(np.median(np.linalg.norm(np.diff(away, axis=0), axis=2), axis=0))
    return np.asarray(np.median(away[:, quiet[: max(4, len(seen) // 2)]], axis=1))


def _seen_from_the_head(positions: FloatArray, columns: Sequence[int]) -> FloatArray | None:
    """Return the positions as the head markers alone hold them; None where they cannot.

    Where markers of the face help to find the head, a slip is shared out between them and the jig, and its
    better part looks like a turn of both.
    """
    shape = np.full(positions.shape[1:], np.nan)
    known = [c for c in columns if np.isfinite(positions[:, c]).any()]
    shape[known] = np.nanmedian(positions[:, known], axis=0)
    try:
        return estimate_head_motion(positions, shape, known, False, iterations=3).stabilise(positions)
    except MotionError:
        return None


def find_slips(capture: Capture, model: FaceModel, columns: Sequence[int]) -> tuple[Slip, ...]:
    """Find markers that slid on the skin, and a slip of the head markers as one.

    The head markers slip when face and head part, whichever of them the head was found by. What a marker of
    the face should do is told by the face alone: then a jig that slips is not taken for skin that does.

    Parameters
    ----------
    capture : Capture
        Head-stabilised.
    model : FaceModel
        How the markers of this face move together.
    columns : sequence of int
        Head markers: they slip together or not at all.
    """
    found = []
    face = np.setdiff1d(np.arange(len(capture.names)), columns)
    positions, rate_hz = np.array(capture.positions_mm), capture.rate_hz
    held = _seen_from_the_head(positions, columns)
    jig = None if held is None else _step(_face_as_whole(held, face, rate_hz), rate_hz)
    if jig is not None:
        frame, apart = jig
        found.append(Slip(-1, frame, float(np.linalg.norm(apart))))
        of_face = _face_as_whole(positions, face, rate_hz)
        positions[frame:, face] -= np.median(of_face[frame:], axis=0) - np.median(of_face[:frame], axis=0)
    residual = residuals_mm(replace(capture, positions_mm=positions), model, face)
    for index, marker in enumerate(face):
        if (own := _step(residual[:, index], capture.rate_hz)) is not None:
            found.append(Slip(int(marker), own[0], float(np.linalg.norm(own[1]))))
    return tuple(found)


def with_slips_marked(capture: Capture, slips: Sequence[Slip]) -> Capture:
    """Return the capture with everything a slid marker shows behind its slip flagged doubtful.

    A slip of the head markers displaces the whole face, evenly: it is written down and nothing is flagged
    (what a recording keeps constantly is freed later; a fit to more markers than the jig prevents it).
    """
    if not slips:
        return capture
    assert capture.flags is not None
    flags = np.array(capture.flags)
    for slip in slips:
        if slip.marker >= 0:
            flags[slip.frame :, slip.marker] |= np.uint8(FrameFlag.DOUBTFUL)
    told = (
        f"{'head' if s.marker < 0 else capture.names[s.marker]} {s.frame} {s.size_mm:.2f} mm" for s in slips
    )
    return capture.with_step(step("with_slips_marked", slips=", ".join(told)), flags=flags)
