"""Volume warp between two faces: radial basis functions with an affine part (paper A section 6).

The paper takes f: R3 -> R3 from landmarks of a neutral pose; kernel and smoothing are ours, since the paper
is silent. The affine part is not optional: without it the motion error grows tenfold.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.spatial.distance import cdist

from corpus_tools.core import FloatArray, MeshError, Registry, counted, frozen

__all__ = [
    "WARP_KERNELS",
    "FoldReport",
    "VolumeWarp",
    "WarpKernel",
    "choose_smoothing",
    "fit_volume_warp",
    "fold_check",
    "leave_one_out_mm",
]


@dataclass(frozen=True, slots=True)
class WarpKernel:
    """A radial function of the squared distance s = r^2 and its derivative by s, in unit-box coordinates.

    `sign` makes the smoothing term act in the right direction: +1 for kernels that are (conditionally)
    positive definite, -1 for their negatives.
    """

    value: Callable[[FloatArray], FloatArray]
    slope: Callable[[FloatArray], FloatArray]
    sign: float = 1.0


WARP_KERNELS: Registry[WarpKernel] = Registry("warp kernel")
WARP_KERNELS.add("cubic", WarpKernel(lambda s: s * np.sqrt(s), lambda s: 1.5 * np.sqrt(s)))
WARP_KERNELS.add(
    "linear", WarpKernel(lambda s: np.sqrt(s), lambda s: 0.5 / np.sqrt(np.maximum(s, 1e-24)), sign=-1.0)
)
WARP_KERNELS.add(
    "thin-plate",
    WarpKernel(
        lambda s: 0.5 * s * np.log(np.maximum(s, 1e-300)),
        lambda s: 0.5 * (np.log(np.maximum(s, 1e-300)) + 1.0),
    ),
)
MQ_WIDTH = 0.15
BLOCK = 1024
"""Points that are warped at a time: their distances to the landmarks stay in the cache (twice as fast)."""
WARP_KERNELS.add(
    "multiquadric",
    WarpKernel(
        lambda s: np.sqrt(s + MQ_WIDTH**2),
        lambda s: 0.5 / np.sqrt(s + MQ_WIDTH**2),
        sign=-1.0,
    ),
)
WARP_KERNELS.add(
    "inverse-multiquadric",
    WarpKernel(
        lambda s: 1.0 / np.sqrt(s + MQ_WIDTH**2),
        lambda s: -0.5 * (s + MQ_WIDTH**2) ** -1.5,
    ),
)


@dataclass(frozen=True, slots=True, eq=False)
class VolumeWarp:
    """A map R3 -> R3, mm to mm: x -> sum_i c_i phi(|x - s_i|) + A x + b; call it on points (..., 3).

    Attributes
    ----------
    centre_mm, scale_mm : (3,), float
        Source coordinates are put into a unit box by (x - centre) / scale before anything else.
    sources : (n, 3)
        Landmarks in the unit box.
    weights : (n, 3) mm
    affine : (4, 3) mm
        Constant row, then the linear part, on unit-box coordinates.
    kernel : str
    smoothing : float
    """

    centre_mm: FloatArray
    scale_mm: float
    sources: FloatArray
    weights: FloatArray
    affine: FloatArray
    kernel: str
    smoothing: float

    def __post_init__(self) -> None:
        for key in ("centre_mm", "sources", "weights", "affine"):
            object.__setattr__(self, key, frozen(getattr(self, key)))

    def __call__(self, points_mm: npt.ArrayLike) -> FloatArray:
        """Return the warped points, same shape, mm."""
        points = np.asarray(points_mm, float)
        x = (points.reshape(-1, 3) - self.centre_mm) / self.scale_mm
        moved = x @ self.affine[1:] + self.affine[0]
        kernel = WARP_KERNELS[self.kernel].value
        for low in range(0, len(x), BLOCK):
            part = slice(low, low + BLOCK)
            moved[part] += kernel(_squares(x[part], self.sources)) @ self.weights
        return np.asarray(moved.reshape(points.shape))

    def jacobian(self, points_mm: npt.ArrayLike) -> FloatArray:
        """Return dW_i/dx_j at each point, shape (n_points, 3, 3); no unit."""
        x = (np.asarray(points_mm, float).reshape(-1, 3) - self.centre_mm) / self.scale_mm
        slope = 2.0 * WARP_KERNELS[self.kernel].slope(_squares(x, self.sources))
        far = np.einsum("pn,ni,pnj->pij", slope, self.weights, x[:, None] - self.sources, optimize=True)
        result: FloatArray = (far + self.affine[1:].T) / self.scale_mm
        return result

    def jacobian_det(self, points_mm: npt.ArrayLike) -> FloatArray:
        """Return det J at each point, shape (n_points,); not above zero where the warp folds space."""
        return np.asarray(np.linalg.det(self.jacobian(points_mm)))


@dataclass(frozen=True, slots=True)
class FoldReport:
    """Least det J over the checked points, where it is, and how many points are folded (det J <= 0)."""

    least_det: float
    at_mm: tuple[float, float, float]
    n_folded: int


def fit_volume_warp(
    source_mm: npt.ArrayLike, target_mm: npt.ArrayLike, *, kernel: str = "cubic", smoothing: float = 1e-2
) -> VolumeWarp:
    """Fit the warp that takes source landmarks to target landmarks (paper A section 6).

    Parameters
    ----------
    source_mm, target_mm : (n, 3), mm
        Neutral pose of the actor and the same points on the mesh.
    kernel : str
        One of :data:`WARP_KERNELS`.
    smoothing : float
        Ridge on the kernel weights, in unit-box coordinates; 0 passes through every landmark exactly.

    Raises
    ------
    MeshError
        Fewer than four landmarks, another number on either side, values that are not finite, or landmarks
        that all lie in one plane.
    """
    source, target = np.asarray(source_mm, float), np.asarray(target_mm, float)
    _check_landmarks(source, target)
    centre = 0.5 * (source.max(axis=0) + source.min(axis=0))
    scale = float(np.ptp(source, axis=0).max())
    x = (source - centre) / scale
    n = len(x)
    phi = WARP_KERNELS[kernel]
    tail = np.concatenate([np.ones((n, 1)), x], axis=1)
    system = np.zeros((n + 4, n + 4))
    system[:n, :n] = phi.value(_squares(x, x)) + phi.sign * smoothing * np.eye(n)
    system[:n, n:], system[n:, :n] = tail, tail.T
    right = np.concatenate([target, np.zeros((4, 3))])
    try:
        solution = np.linalg.solve(system, right)
    except np.linalg.LinAlgError as error:
        raise MeshError(
            "The landmarks of the warp coincide or lie in one plane; check the neutral pose and the markers."
        ) from error
    return VolumeWarp(centre, scale, x, solution[:n], solution[n:], kernel, float(smoothing))


def fold_check(warp: VolumeWarp, points_mm: npt.ArrayLike) -> FoldReport:
    """Return the least det J of a warp over points in its source space, e.g. all captured positions, mm."""
    points = np.asarray(points_mm, float).reshape(-1, 3)
    dets = warp.jacobian_det(points)
    worst = int(np.argmin(dets))
    x, y, z = (float(c) for c in points[worst])
    return FoldReport(float(dets[worst]), (x, y, z), int((dets <= 0).sum()))


def leave_one_out_mm(
    source_mm: npt.ArrayLike, target_mm: npt.ArrayLike, *, kernel: str = "cubic", smoothing: float = 1e-2
) -> FloatArray:
    """Return how far each landmark is missed by a warp fitted without it, shape (n,), mm."""
    source, target = np.asarray(source_mm, float), np.asarray(target_mm, float)
    errors = np.empty(len(source))
    for i in range(len(source)):
        rest = np.arange(len(source)) != i
        warp = fit_volume_warp(source[rest], target[rest], kernel=kernel, smoothing=smoothing)
        errors[i] = np.linalg.norm(warp(source[i]) - target[i])
    return errors


def choose_smoothing(
    source_mm: npt.ArrayLike,
    target_mm: npt.ArrayLike,
    *,
    kernel: str = "cubic",
    candidates: Sequence[float] = (0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1),
) -> float:
    """Return the candidate with the least rms leave-one-out error."""
    scores = [
        float(np.sqrt(np.mean(leave_one_out_mm(source_mm, target_mm, kernel=kernel, smoothing=s) ** 2)))
        for s in candidates
    ]
    return float(candidates[int(np.argmin(scores))])


def _squares(x: FloatArray, sources: FloatArray) -> FloatArray:
    """Return squared distances (n_points, n_sources); differences first: exact at landmarks."""
    return np.asarray(cdist(x, sources, "sqeuclidean"))


def _check_landmarks(source: FloatArray, target: FloatArray) -> None:
    if source.shape != target.shape or source.ndim != 2 or source.shape[1] != 3:
        raise MeshError(
            f"The warp has landmarks of shapes {source.shape} and {target.shape}; (n, 3) twice was expected."
        )
    if len(source) < 4:
        raise MeshError(
            f"The warp has {counted(len(source), 'landmark')}; at least 4 that do not lie in one plane are "
            "needed."
        )
    if not (np.isfinite(source).all() and np.isfinite(target).all()):
        raise MeshError("A landmark of the warp is not finite; fill the gaps of the neutral pose first.")
    if np.linalg.matrix_rank(source - source.mean(axis=0), tol=1e-6 * max(float(np.ptp(source)), 1e-9)) < 3:
        raise MeshError(
            "The landmarks of the warp coincide or lie in one plane; check the neutral pose and the markers."
        )
