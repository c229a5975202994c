"""How the markers of one face move together: what the seen ones say about the hidden ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from corpus_tools.core import Capture, FloatArray, IntArray, frozen

__all__ = ["FaceModel", "face_model"]

MOST_FRAMES = 6000
"""Frames that the model is made of, evenly spaced over the recordings (our choice: more do not change it)."""

SHRINKAGE = 0.01
"""Of the mean variance of a coordinate, added to every one: a face that is seen for seconds only has shown
few of its postures, and coordinates that never moved apart would otherwise lead far beyond what was seen (our
choice; measured: errors of filled gaps fall by a fifth in optical capture and by half in video)."""

ROUNDS, ROUGH_COMPONENTS = 10, 8
"""Rounds in which hidden coordinates are guessed again when too few frames are whole, by a rougher model: a
finer one would learn its own guesses."""


@dataclass(frozen=True, slots=True, eq=False)
class FaceModel:
    """A normal distribution of postures, and its principal components.

    Attributes
    ----------
    mean_mm : (n_markers * 3,) mm
    covariance_mm2 : (n_markers * 3, n_markers * 3) mm2
        With :data:`SHRINKAGE` on its diagonal.
    components : (n_components, n_markers * 3)
        Orthonormal rows.
    variances : (n_components,) mm2
        Of the weights.
    noise_mm2 : float
        Variance that every coordinate has of its own.
    """

    mean_mm: FloatArray
    covariance_mm2: FloatArray
    components: FloatArray
    variances: FloatArray
    noise_mm2: float

    def predict(self, seen_mm: FloatArray, seen: IntArray, wanted: IntArray) -> FloatArray:
        """Return the likeliest positions of some markers given those of others, (n_frames, n_wanted, 3) mm.

        Parameters
        ----------
        seen_mm : (n_frames, n_seen, 3) mm
        seen, wanted : sequences of int
            Columns of the markers.
        """
        known, asked = _coordinates(seen), _coordinates(wanted)
        among, across = (self.covariance_mm2[np.ix_(known, to)] for to in (known, asked))
        away = seen_mm.reshape(len(seen_mm), -1) - self.mean_mm[known]
        posture = self.mean_mm[asked] + away @ np.linalg.solve(among, across)
        return np.asarray(posture.reshape(len(seen_mm), -1, 3))

    def weights(self, seen_mm: FloatArray, seen: IntArray) -> FloatArray:
        """Return the likeliest weights of the components given some markers, (n_frames, n_components) mm."""
        known = _coordinates(seen)
        basis = self.components[:, known]
        precision = np.diag(self.noise_mm2 / self.variances) + basis @ basis.T
        away = seen_mm.reshape(len(seen_mm), -1) - self.mean_mm[known]
        return np.asarray(np.linalg.solve(precision, basis @ away.T).T)


def _coordinates(markers: IntArray) -> IntArray:
    return np.asarray((3 * np.asarray(markers)[:, None] + np.arange(3)).ravel(), dtype=np.int64)


def _fitted(frames: FloatArray, n_components: int) -> FaceModel:
    mean = frames.mean(axis=0)
    centred = frames - mean
    covariance = centred.T @ centred / max(1, len(frames) - 1)
    values, vectors = np.linalg.eigh(covariance)
    n = min(n_components, len(values) - 1)
    noise = max(float(values[:-n].mean()), 1e-6)
    variances = np.maximum(values[-n:], 1e-6)
    shrunk = covariance + max(SHRINKAGE * float(values.mean()), noise) * np.eye(len(values))
    return FaceModel(frozen(mean), frozen(shrunk), frozen(vectors[:, -n:].T), frozen(variances), noise)


def _guessed(model: FaceModel, frames: FloatArray, missing: FloatArray) -> FloatArray:
    """Return the frames with hidden coordinates replaced by what the model makes of the frame."""
    away = frames - model.mean_mm
    shrink = model.variances / (model.variances + model.noise_mm2)
    guess = model.mean_mm + ((away @ model.components.T) * shrink) @ model.components
    return np.where(missing, guess, frames)


def face_model(
    captures: Sequence[Capture], n_components: int = 24, without: slice | None = None
) -> FaceModel | None:
    """Learn how the markers move together from the frames in which most are seen.

    Parameters
    ----------
    captures : sequence of Capture
        In the head-stabilised space; the same markers in all.
    n_components : int
    without : slice, optional
        Frames, counted over all captures, that are left out.

    Returns
    -------
    FaceModel or None
        None when too few frames show anything.
    """
    every = np.concatenate([np.asarray(c.positions_mm).reshape(c.n_frames, -1) for c in captures])
    if without is not None:
        every = np.concatenate([every[: without.start], every[without.stop :]])
    whole = np.isfinite(every).all(axis=1)
    if whole.sum() >= 10 * n_components:
        return _fitted(_evenly(every[whole]), n_components)
    frames = _evenly(every[np.isfinite(every).mean(axis=1) > 0.5])
    missing = ~np.isfinite(frames)
    if len(frames) < 2 * n_components or missing.all(axis=0).any():
        return None
    frames = np.where(missing, np.nanmean(frames, axis=0), frames)
    for _ in range(ROUNDS):
        frames = _guessed(_fitted(frames, min(n_components, ROUGH_COMPONENTS)), frames, missing)
    return _fitted(frames, n_components)


def _evenly(frames: FloatArray) -> FloatArray:
    step = max(1, -(-len(frames) // MOST_FRAMES))
    return frames[::step]
