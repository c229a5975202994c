"""How far a retarget can be trusted: what the warp misses, its folds, and motion outside its reach."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.spatial import Delaunay, QhullError

from corpus_tools.core import FloatArray
from corpus_tools.retarget.markers import Retargeter
from corpus_tools.retarget.warp import fold_check, leave_one_out_mm

__all__ = ["MOST_FRAMES", "RetargetReport", "retarget_report"]

MOST_FRAMES = 300
"""Frames of the motion that are looked at, evenly spaced (our choice: a second of work at most)."""
SLACK_MM = 0.01
"""Markers at rest span the hull: within this they are inside it."""


@dataclass(frozen=True, slots=True)
class RetargetReport:
    """Evidence on a retarget, in mm on the mesh unless said otherwise.

    Attributes
    ----------
    kernel, smoothing
        Of the warp.
    residual_rms_mm, residual_most_mm : float
        How far smoothing leaves the warped neutral pose from the marker vertices.
    residual_marker : str
        Where it is most.
    left_out_rms_mm : float
        How far landmarks are missed by warps that were fitted without them.
    points, folded : int
        Marker positions of the motion that were looked at, and those where the warp folds space.
    least_det : float
        Least determinant of the derivative of the warp over them.
    outside : float
        Share of them outside the convex hull of the neutral pose, where the warp extrapolates.
    """

    kernel: str
    smoothing: float
    residual_rms_mm: float
    residual_most_mm: float
    residual_marker: str
    left_out_rms_mm: float
    points: int
    folded: int
    least_det: float
    outside: float


def retarget_report(retargeter: Retargeter, values_mm: npt.ArrayLike) -> RetargetReport:
    """Return the evidence on a retarget of a motion (n_frames, n_markers, 3) of the actor, mm."""
    values = np.asarray(values_mm, float)
    values = values[:: max(-(-len(values) // MOST_FRAMES), 1)]
    points = values.reshape(-1, 3)
    warp = retargeter.warp
    residual = np.linalg.norm(retargeter.warped_neutral_mm - retargeter.rest_mm, axis=1)
    left_out = leave_one_out_mm(
        retargeter.neutral_mm, retargeter.rest_mm, kernel=warp.kernel, smoothing=warp.smoothing
    )
    folds = fold_check(warp, points)
    worst = int(residual.argmax())
    return RetargetReport(
        kernel=warp.kernel,
        smoothing=warp.smoothing,
        residual_rms_mm=_rms(residual),
        residual_most_mm=float(residual[worst]),
        residual_marker=retargeter.names[worst],
        left_out_rms_mm=_rms(left_out),
        points=len(points),
        folded=folds.n_folded,
        least_det=folds.least_det,
        outside=_outside(retargeter.neutral_mm, points),
    )


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _outside(neutral: FloatArray, points: FloatArray) -> float:
    """Return the share of points outside the hull, which reaches a hundredth of a mm further."""
    try:
        hull = Delaunay(neutral)
    except QhullError:
        return 1.0
    middle = neutral.mean(axis=0)
    away = np.linalg.norm(points - middle, axis=1, keepdims=True)
    inward = points - (points - middle) / np.maximum(away, 1e-9) * np.minimum(SLACK_MM, away)
    return float(np.mean(hull.find_simplex(inward) < 0))
