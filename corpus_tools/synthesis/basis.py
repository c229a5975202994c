"""Postures of the corpus in a few principal components, and their values where units can be joined.

The distance of two fragments at a join is measured between postures and velocities at the centres of the
shared phone, in the space of the first principal components of all face markers (paper A asks for similar
timing and context only; the join terms are ours, after unit selection for audio).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicSpline

from corpus_tools.core import Capture, CorpusError, FloatArray, MotionError, UnitInventory, frozen
from corpus_tools.speech import lip_aperture_mm

__all__ = ["JoinFeatures", "PostureBasis", "join_features", "posture_basis", "principal_basis"]


@dataclass(frozen=True, slots=True, eq=False)
class PostureBasis:
    """Principal components of marker positions.

    Attributes
    ----------
    names : tuple of str
        The markers, in order.
    mean_mm : (3 * n_markers,) mm
    components : (n_components, 3 * n_markers)
        Orthonormal rows; the largest entry of each is positive, so that a basis does not depend on the
        eigenvalue solver's choice of sign.
    explained : (n_components,)
        Share of the variance that each component holds.
    """

    names: tuple[str, ...]
    mean_mm: FloatArray
    components: FloatArray
    explained: FloatArray

    def __post_init__(self) -> None:
        for key in ("mean_mm", "components", "explained"):
            object.__setattr__(self, key, frozen(getattr(self, key)))

    def project(self, positions_mm: npt.ArrayLike) -> FloatArray:
        """Return the weights of postures (..., n_markers, 3) mm, shape (..., n_components), mm."""
        positions = np.asarray(positions_mm, dtype=np.float64)
        flat = positions.reshape(*positions.shape[:-2], -1)
        return np.asarray((flat - self.mean_mm) @ self.components.T)

    def reconstruct(self, weights: npt.ArrayLike) -> FloatArray:
        """Return the postures (..., n_markers, 3) mm that weights (..., n_components) stand for."""
        values = np.asarray(weights, dtype=np.float64)
        flat = values @ self.components + self.mean_mm
        return np.asarray(flat.reshape(*values.shape[:-1], -1, 3))


def face_markers(capture: Capture) -> tuple[str, ...]:
    """Return the markers outside region "head" (jig or forehead: they carry no speech)."""
    return tuple(n for n, region in zip(capture.names, capture.regions, strict=True) if region != "head")


def posture_basis(
    inventory: UnitInventory, markers: Sequence[str] | None = None, n: int = 12
) -> PostureBasis:
    """Learn the principal components of all frames of the corpus, one recording in memory at a time.

    Parameters
    ----------
    inventory : UnitInventory
    markers : sequence of str, optional
        All markers outside region "head" when not given.
    n : int
        Components kept; at most 3 * n_markers.

    Raises
    ------
    CorpusError
        Fewer than two whole frames are there.
    """
    names = tuple(markers) if markers is not None else face_markers(inventory.recordings[0].capture)
    width = 3 * len(names)
    count, total, square = 0, np.zeros(width), np.zeros((width, width))
    shift: FloatArray | None = None
    for recording in inventory.recordings:
        frames = _whole_frames(recording.capture, names)
        if len(frames) == 0:
            continue
        shift = frames[0] if shift is None else shift
        centred = frames - shift  # the sums stay small, so that no digits are lost in the covariance
        count += len(centred)
        total += centred.sum(axis=0)
        square += centred.T @ centred
    if count < 2 or shift is None:
        raise CorpusError("The corpus has fewer than two frames without missing markers; clean it first.")
    mean = total / count
    return principal_basis(names, mean + shift, square / count - np.outer(mean, mean), n)


def principal_basis(
    names: tuple[str, ...], mean_mm: FloatArray, covariance_mm2: FloatArray, n: int
) -> PostureBasis:
    """Return the first `n` principal components of postures with a mean and a covariance.

    Parameters
    ----------
    names : tuple of str
    mean_mm : (3 * n_markers,) mm
    covariance_mm2 : (3 * n_markers, 3 * n_markers) mm2
    n : int
        Components kept; at most 3 * n_markers.
    """
    values, vectors = np.linalg.eigh(covariance_mm2)
    values = values[::-1].clip(min=0)
    components = vectors[:, ::-1][:, :n].T
    largest = np.abs(components).argmax(axis=1)
    signs = np.sign(components[np.arange(len(components)), largest])
    spread = max(float(values.sum()), np.finfo(float).tiny)
    return PostureBasis(names, mean_mm, components * signs[:, None], values[:n] / spread)


def _whole_frames(capture: Capture, names: tuple[str, ...]) -> FloatArray:
    positions = capture.positions_mm[:, capture.indices(names)].reshape(capture.n_frames, -1)
    return np.asarray(positions[np.isfinite(positions).all(axis=1)])


@dataclass(frozen=True, slots=True, eq=False)
class JoinFeatures:
    """Posture and how it moves at the centre of every phone of the inventory, each scaled by its own spread.

    Attributes
    ----------
    position : (n_phones, n_components) float64
        In units of `position_sd_mm`: a distance of 1 is the root mean square distance from the mean.
    velocity : (n_phones, n_components) float64
        In units of `velocity_sd_mm_s`.
    acceleration : (n_phones, n_components) float64
        In units of its rms length over the phones.
    aperture : (n_phones,) float64
        Signed lip aperture in units of its standard deviation over the phones; 0 without lips.
    position_sd_mm, velocity_sd_mm_s : float
    """

    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    aperture: FloatArray
    position_sd_mm: float
    velocity_sd_mm_s: float

    def __post_init__(self) -> None:
        for key in ("position", "velocity", "acceleration", "aperture"):
            object.__setattr__(self, key, frozen(getattr(self, key)))


def join_features(inventory: UnitInventory, basis: PostureBasis) -> JoinFeatures:
    """Evaluate a cubic spline through the frames of every recording at its phone centres.

    Centres outside the captured frames take the posture of the nearest frame.

    Raises
    ------
    MotionError
        A capture has missing markers or fewer than two frames.
    """
    centres = 0.5 * (inventory.starts_s + inventory.ends_s)
    shape = (inventory.n_phones, len(basis.components))
    position, velocity, acceleration = (np.zeros(shape) for _ in range(3))
    aperture = np.zeros(inventory.n_phones)
    for index, recording in enumerate(inventory.recordings):
        rows = slice(int(inventory.offsets[index]), int(inventory.offsets[index + 1]))
        capture = recording.capture
        weights = basis.project(capture.positions_mm[:, capture.indices(basis.names)])
        if len(weights) < 2 or not np.isfinite(weights).all():
            raise MotionError(
                f"The capture of '{recording.name}' has missing markers or fewer than two frames; "
                "clean it first."
            )
        times = capture.times_s
        spline = CubicSpline(times, weights)
        at = np.clip(centres[rows], times[0], times[-1])
        position[rows], velocity[rows], acceleration[rows] = spline(at), spline(at, 1), spline(at, 2)
        aperture[rows] = np.interp(at, times, lip_aperture_mm(capture.positions_mm, capture.names))
    position_sd = _spread(position - position.mean(axis=0))
    velocity_sd = _spread(velocity)
    apart = aperture - aperture.mean()
    return JoinFeatures(
        position / position_sd,
        velocity / velocity_sd,
        acceleration / _spread(acceleration),
        apart / _spread(apart[:, None]),
        position_sd,
        velocity_sd,
    )


def _spread(values: FloatArray) -> float:
    """Root mean square length of the rows; 1 where nothing moves, so that a division changes nothing."""
    spread = float(np.sqrt((values**2).sum(axis=1).mean()))
    return spread if spread > 0 else 1.0
