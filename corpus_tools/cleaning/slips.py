"""Markers that slide on the skin and a jig that slips on the head: steps that stay (beyond paper A)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import median_filter

from corpus_tools.cleaning.face_model import FaceModel
from corpus_tools.cleaning.outliers import residuals_mm
from corpus_tools.core import Capture, FloatArray, FrameFlag, step

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


def _against_the_face(capture: Capture, columns: Sequence[int]) -> FloatArray:
    """Return by how much the quiet half of the face is displaced as a whole, (n_frames, 3) mm."""
    positions = np.asarray(capture.positions_mm)
    face = np.setdiff1d(np.arange(len(capture.names)), columns)
    seen = face[np.isfinite(positions[:, face]).all(axis=(0, 2))]
    if len(seen) < 4:
        return np.zeros((len(positions), 3))
    away = positions[:, seen] - np.median(positions[:, seen], axis=0)
    quiet = np.argsort(np.median(np.linalg.norm(away, axis=2), axis=0))[: max(4, len(seen) // 2)]
    return np.asarray(np.median(away[:, quiet], axis=1))


def find_slips(capture: Capture, model: FaceModel, columns: Sequence[int]) -> tuple[Slip, ...]:
    """Find markers that slid on the skin, and a slip of the head markers as one.

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
    if (jig := _step(_against_the_face(capture, columns), capture.rate_hz)) is not None:
        frame, moved = jig
        found.append(Slip(-1, frame, float(np.linalg.norm(moved))))
        positions = np.array(capture.positions_mm)
        positions[frame:, face] -= moved
        capture = replace(capture, positions_mm=positions)
    residual = residuals_mm(capture, model)
    for marker in face:
        if (own := _step(residual[:, marker], capture.rate_hz)) is not None:
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
