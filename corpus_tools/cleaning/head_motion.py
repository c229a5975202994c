"""Removal of rigid head motion: robust similarity or rigid fits of the head markers, frame by frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from corpus_tools.core import BoolArray, Capture, FloatArray, FrameFlag, MotionError, step

__all__ = [
    "REFERENCE_FRAMES",
    "HeadMotion",
    "estimate_head_motion",
    "fitted_frames",
    "reference_shape",
    "remove_head_motion",
]

REFERENCE_FRAMES = 25
"""Frames of each recording that the reference is made of, at most."""


@dataclass(frozen=True, slots=True, eq=False)
class HeadMotion:
    """How the head lay in every frame: captured = (stabilised @ rotation) / scale + translation.

    Attributes
    ----------
    rotation : (n_frames, 3, 3)
        Proper rotations (determinant +1) that turn row vectors of the stabilised space into captured ones.
    translation_mm : (n_frames, 3) mm
        Where the origin of the stabilised space lay.
    scale : (n_frames,)
        Factor from captured to stabilised size; all 1 for a rigid fit.
    residual_mm : (n_frames,) mm
        Weighted rms distance of the head markers from the reference after the fit.
    fitted : (n_frames,) bool
        False where fewer than 3 head markers were seen (or all on one line); the pose there lies between
        those of the neighbours: linear in place and scale, spherical in rotation.
    """

    rotation: FloatArray
    translation_mm: FloatArray
    scale: FloatArray
    residual_mm: FloatArray
    fitted: BoolArray

    def stabilise(self, positions_mm: FloatArray) -> FloatArray:
        """Return positions (n_frames, n_markers, 3) in the head-stabilised space."""
        centred = np.asarray(positions_mm) - self.translation_mm[:, None]
        return np.asarray(self.scale[:, None, None] * (centred @ self.rotation.swapaxes(1, 2)))


def _weighted_fit(
    points: FloatArray, reference: FloatArray, weights: FloatArray, allow_scale: bool
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return rotation, translation, scale of the weighted least-squares fit in every frame (Umeyama 1991)."""
    share = weights / weights.sum(1, keepdims=True)
    centre = (share[:, None] @ points)[:, 0]
    aim = share @ reference
    p, q = points - centre[:, None], reference[None] - aim[:, None]
    u, s, vt = np.linalg.svd((share[..., None] * q).swapaxes(1, 2) @ p)
    sign = np.ones_like(s)
    sign[:, 2] = np.where(np.linalg.det(u @ vt) < 0, -1.0, 1.0)  # the nearest rotation, never a reflection
    rotation = (u * sign[:, None]) @ vt
    scale = np.ones(len(points))
    if allow_scale:
        scale = (s * sign).sum(1) / (share * (p**2).sum(2)).sum(1)
    translation = centre - (aim[:, None] @ rotation)[:, 0] / scale[:, None]
    return rotation, translation, scale


def _can_be_fitted(points: FloatArray, seen: BoolArray) -> BoolArray:
    """Return in which frames at least 3 markers are seen that do not lie on one line, (n_frames,)."""
    share = seen / np.maximum(seen.sum(axis=1, keepdims=True), 1)
    centred = np.where(seen[..., None], points - (share[:, None] @ points), 0.0)
    spread = np.linalg.eigvalsh(centred.swapaxes(1, 2) @ centred)
    return np.asarray((seen.sum(axis=1) >= 3) & (spread[:, 1] > 1e-6 * spread[:, 2]))


def fitted_frames(positions_mm: FloatArray, columns: Sequence[int]) -> BoolArray:
    """Return the frames in which the head can be found by the markers `columns`, (n_frames,).

    Raises
    ------
    MotionError
        No frame shows 3 of them that are not on one line.
    """
    points = np.asarray(positions_mm, dtype=np.float64)[:, np.asarray(columns, dtype=np.int64)]
    seen = np.asarray(np.isfinite(points).all(axis=2))
    fitted = _can_be_fitted(np.where(seen[..., None], points, 0.0), seen)
    if not fitted.any():
        raise MotionError(
            "Head motion needs at least 3 head markers, not on one line, seen together in a frame; "
            "name others in reference_markers."
        )
    return fitted


def _interpolated(motion: HeadMotion) -> HeadMotion:
    """Give frames without a fit a pose between those of their neighbours; at the ends the nearest one's."""
    good, lost = np.flatnonzero(motion.fitted), np.flatnonzero(~motion.fitted)
    if not len(lost):
        return motion
    rotation, translation = motion.rotation.copy(), motion.translation_mm.copy()
    scale, residual = motion.scale.copy(), motion.residual_mm.copy()
    turns = Rotation.from_matrix(rotation[good])
    if len(good) == 1:
        rotation[lost] = rotation[good]
    else:
        rotation[lost] = Slerp(good, turns)(np.clip(lost, good[0], good[-1])).as_matrix()
    for axis in range(3):
        translation[lost, axis] = np.interp(lost, good, translation[good, axis])
    scale[lost] = np.interp(lost, good, scale[good])
    residual[lost] = np.nan
    return HeadMotion(rotation, translation, scale, residual, motion.fitted)


def estimate_head_motion(
    positions_mm: FloatArray,
    reference_mm: FloatArray,
    columns: Sequence[int],
    allow_scale: bool,
    cutoff_mm: float = 1.0,
    iterations: int = 6,
) -> HeadMotion:
    """Fit the head markers of every frame to the reference, doubting those that lie off.

    Iteratively reweighted least squares with Geman-McClure weights ``1 / (1 + (r / cutoff)^2)^2`` around a
    closed-form fit (paper A section 4: "a combination of the estimate from the head mounted jig and a
    least-squares approach"; the weights are our choice, so that a slipping marker loses its say).

    Parameters
    ----------
    positions_mm : (n_frames, n_markers, 3) mm
        NaN where missing.
    reference_mm : (n_markers, 3) mm
        The shape of the head, all markers.
    columns : sequence of int
        The markers that move with the skull; at least 3.
    allow_scale : bool
        Similarity instead of rigid fit: for monocular video, never for optical capture.
    cutoff_mm : float
        Residual at which a marker has a quarter of its weight, mm.
    iterations : int

    Raises
    ------
    MotionError
        No frame shows 3 head markers that are not on one line.
    """
    chosen = np.asarray(columns, dtype=np.int64)
    points = np.asarray(positions_mm, dtype=np.float64)[:, chosen]
    reference = np.asarray(reference_mm, dtype=np.float64)[chosen]
    seen = np.asarray(np.isfinite(points).all(axis=2))
    points = np.where(seen[..., None], points, 0.0)
    fitted = fitted_frames(positions_mm, columns)
    points[~fitted] = reference  # any pose will do: it is replaced by that of a neighbour
    base = np.where(fitted[:, None], seen, True).astype(np.float64)
    weights = base
    for _ in range(max(1, iterations)):
        rotation, translation, scale = _weighted_fit(points, reference, weights, allow_scale)
        turned = (points - translation[:, None]) @ rotation.swapaxes(1, 2)
        distance = np.linalg.norm(scale[:, None, None] * turned - reference, axis=2)
        kept = weights
        weights = base / (1.0 + (distance / cutoff_mm) ** 2) ** 2
    residual = np.sqrt((kept * distance**2).sum(1) / kept.sum(1))
    return _interpolated(HeadMotion(rotation, translation, scale, residual, fitted))


def reference_shape(
    captures: Sequence[Capture],
    columns: Sequence[int],
    allow_scale: bool,
    cutoff_mm: float = 1.0,
    rounds: int = 3,
) -> FloatArray:
    """Return the mean face (n_markers, 3) mm, head markers centred: the frame of the stabilised space.

    Starts from the median with the head markers centred and fits the corpus to it `rounds` times. With
    `allow_scale` its size is that of the head in the median frame (not that of the first median, which heads
    turned every way make too small). At most :data:`REFERENCE_FRAMES` frames of a recording take part, evenly
    spaced, so that no recording outvotes the others (our choice: the paper does not say what the head is
    fitted to).
    A marker that is never seen has NaN.

    Raises
    ------
    MotionError
        No frame of the corpus shows all head markers.
    """
    chosen = list(columns)
    positions = [np.asarray(c.positions_mm) for c in captures]
    every = np.concatenate([_evenly(p[np.isfinite(p[:, chosen]).all(axis=(1, 2))]) for p in positions])
    if not len(every):
        raise MotionError(
            "No frame of the corpus shows all head markers together, so that head motion cannot be found; "
            "leave out of reference_markers those that are often hidden."
        )
    size = float(np.median(_spread(every[:, chosen])))
    shape = _median(every - every[:, chosen].mean(1, keepdims=True))
    shape = shape - shape[chosen].mean(0)
    for _ in range(rounds):
        motion = estimate_head_motion(every, shape, chosen, allow_scale, cutoff_mm, 3)
        new = _median(motion.stabilise(every)[motion.fitted])
        if allow_scale:
            new = new * size / _spread(new[chosen])
        shape = new - new[chosen].mean(0)
    return np.asarray(shape)


def _evenly(positions: FloatArray, most: int = REFERENCE_FRAMES) -> FloatArray:
    if len(positions) <= most:
        return positions
    return positions[np.linspace(0, len(positions) - 1, most).round().astype(np.int64)]


def _median(positions: FloatArray) -> FloatArray:
    """Return the median over frames (n_markers, 3) of what is seen; NaN for a marker that never is."""
    missing = ~np.isfinite(positions)
    if not missing.any():
        return np.asarray(np.median(positions, axis=0))
    never = missing.all(axis=0)
    return np.where(never, np.nan, np.nanmedian(np.where(never, 0.0, positions), axis=0))


def _spread(points: FloatArray) -> FloatArray:
    """Return the root sum of squared distances from the centroid, over the last two axes."""
    return np.asarray(np.sqrt(((points - points.mean(axis=-2, keepdims=True)) ** 2).sum(axis=(-2, -1))))


def remove_head_motion(
    capture: Capture,
    reference_mm: FloatArray,
    columns: Sequence[int],
    allow_scale: bool,
    cutoff_mm: float = 1.0,
    iterations: int = 6,
) -> tuple[Capture, HeadMotion]:
    """Return the capture in the head-stabilised space, and the motion that was removed.

    Frames whose head could not be fitted are flagged doubtful. Parameters as of :func:`estimate_head_motion`.
    """
    motion = estimate_head_motion(
        capture.positions_mm, reference_mm, columns, allow_scale, cutoff_mm, iterations
    )
    assert capture.flags is not None
    flags = np.array(capture.flags)
    flags[~motion.fitted] |= np.uint8(FrameFlag.DOUBTFUL)
    done = step(
        "remove_head_motion",
        fit="similarity" if allow_scale else "rigid",
        cutoff_mm=cutoff_mm,
        markers=",".join(capture.names[i] for i in columns),
    )
    return capture.with_step(done, positions_mm=motion.stabilise(capture.positions_mm), flags=flags), motion
