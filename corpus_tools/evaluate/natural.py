"""What is natural for this speaker, told by the recordings that are not tested: the scale of every metric."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from corpus_tools.core import (
    SPEECH_REGIONS,
    BoolArray,
    Capture,
    FloatArray,
    IntArray,
    region_columns,
    speech_span_s,
)
from corpus_tools.methods import SPEECH_MARGIN_S, TrainingSet
from corpus_tools.speech import (
    closure_threshold_mm,
    jaw_mm,
    lip_aperture_mm,
    lip_protrusion_mm,
    lip_width_mm,
)
from corpus_tools.synthesis import PostureBasis, natural_distribution

__all__ = [
    "ARTICULATORS",
    "Moments",
    "Natural",
    "articulators",
    "natural_of",
]

ARTICULATORS = ("aperture", "width", "protrusion", "jaw")
COMPONENTS = 8
"""Principal components in the Frechet distance: as many as paper B takes of the face."""


def articulators(positions_mm: FloatArray, names: Sequence[str]) -> FloatArray:
    """Return lip aperture, width, protrusion and jaw, (n_frames, 4) mm.

    NaN in frames that miss a marker of it (the aperture: any marker). Width and jaw are NaN throughout where
    the layout lacks one of their two markers; aperture and protrusion are 0 where it has no lips.
    """
    columns = []
    for measure in (lip_aperture_mm, lip_width_mm, lip_protrusion_mm, jaw_mm):
        try:
            columns.append(measure(positions_mm, names))
        except ValueError:  # the layout has no such marker
            columns.append(np.full(len(positions_mm), np.nan))
    return np.stack(columns, axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class Moments:
    """Sums over frames from which mean and covariance follow, so that sentences can be added up.

    Attributes
    ----------
    n : float
    total : (n_features,)
    square : (n_features, n_features)
    """

    n: float
    total: FloatArray
    square: FloatArray

    @staticmethod
    def of(features: FloatArray) -> Moments:
        """Return the moments of frames (n_frames, n_features)."""
        return Moments(float(len(features)), features.sum(axis=0), features.T @ features)

    def flat(self) -> FloatArray:
        """Return everything as one row, (1 + n + n * n,)."""
        return np.concatenate([[self.n], self.total, self.square.ravel()])


@dataclass(frozen=True, slots=True, eq=False)
class Natural:
    """Natural speech of the speaker, measured on recordings that are not tested.

    Attributes
    ----------
    rate_hz : float
        At which motion is compared where it is not compared at the captured frames.
    columns : (n,) int64
        Lips and chin.
    posture_sd_mm : float
        Rms distance of the lips and chin from their mean, 3-D, over frames of speech.
    face_sd_mm, face_speed_p95_mm_s, face_acceleration_p95_mm_s2 : float
        Of all face markers, rms over markers: what gaps at joins are measured by.
    articulator_sd_mm : (4,) mm
        Of :data:`ARTICULATORS`.
    acceleration_p95_mm_s2 : float
        95th percentile over frames of the rms acceleration of lips and chin.
    stretch_p95_mm_s2 : float
        95th percentile over stretches of :data:`~corpus_tools.synthesis.JOIN_WINDOW_S` of the largest such
        acceleration in each: a peak passes that of frames much more often than a frame does.
    closed_mm : float
        Lip aperture below which lips are closed; NaN without bilabials.
    basis : PostureBasis
        Of :data:`COMPONENTS` principal components.
    feature_sd : (2 * n_components,)
        Of component weights (mm) and their velocities (mm/s).
    reference : Moments
        Of the standardised features.
    """

    rate_hz: float
    columns: IntArray
    posture_sd_mm: float
    face_sd_mm: float
    face_speed_p95_mm_s: float
    face_acceleration_p95_mm_s2: float
    articulator_sd_mm: FloatArray
    acceleration_p95_mm_s2: float
    stretch_p95_mm_s2: float
    closed_mm: float
    basis: PostureBasis
    feature_sd: FloatArray
    reference: Moments

    def features(self, positions_mm: FloatArray, rate_hz: float) -> FloatArray:
        """Return standardised posture and velocity of frames at a uniform rate, (n_frames, n_features)."""
        return _features(self.basis, positions_mm, rate_hz) / self.feature_sd


def _features(basis: PostureBasis, positions_mm: FloatArray, rate_hz: float) -> FloatArray:
    weights = basis.project(positions_mm)
    speed = np.gradient(weights, axis=0) * rate_hz if len(weights) > 1 else np.zeros_like(weights)
    return np.concatenate([weights, speed], axis=1)


def _spread(frames_mm: FloatArray) -> float:
    return float(np.sqrt(((frames_mm - frames_mm.mean(axis=0)) ** 2).sum(axis=2).mean()))


def _speed_p95(captures: Sequence[Capture], speaking: Sequence[BoolArray]) -> float:
    speeds = []
    for capture, here in zip(captures, speaking, strict=True):
        velocity = np.gradient(np.asarray(capture.positions_mm), axis=0) * capture.rate_hz
        speeds.append(np.sqrt((velocity**2).sum(axis=2).mean(axis=1))[here])
    return float(np.percentile(np.concatenate(speeds), 95))


def _percentile95(values: FloatArray) -> float:
    return float(np.percentile(values, 95)) if len(values) else float("nan")


def natural_of(training: TrainingSet) -> Natural:
    """Measure natural speech on recordings in their own posture."""
    captures = [r.capture for r in training.recordings]
    speaking = [training.speaking(r) for r in training.recordings]
    frames = training.speech_frames_mm(remove_bias=False)
    columns = region_columns(captures[0].regions, SPEECH_REGIONS)
    spans = [
        speech_span_s(r.utterance, training.phones.silence, SPEECH_MARGIN_S) for r in training.recordings
    ]
    lips = natural_distribution(captures, training.rate_hz, columns, spans)
    face = natural_distribution(captures, training.rate_hz, None, spans)
    basis = training.basis(False, COMPONENTS)
    features = np.concatenate(
        [_features(basis, c.positions_mm[s], c.rate_hz) for c, s in zip(captures, speaking, strict=True)]
    )
    sd = features.std(axis=0).clip(min=1e-9)
    utterances = [r.utterance for r in training.recordings]
    return Natural(
        rate_hz=training.rate_hz,
        columns=columns,
        posture_sd_mm=_spread(frames[:, columns]),
        face_sd_mm=_spread(frames),
        face_speed_p95_mm_s=_speed_p95(captures, speaking),
        face_acceleration_p95_mm_s2=face.frames_p95_mm_s2,
        articulator_sd_mm=articulators(frames, training.markers).std(axis=0),
        acceleration_p95_mm_s2=lips.frames_p95_mm_s2,
        stretch_p95_mm_s2=_percentile95(lips.peaks_mm_s2),
        closed_mm=closure_threshold_mm(captures, utterances, training.phones),
        basis=basis,
        feature_sd=sd,
        reference=Moments.of(features / sd),
    )
