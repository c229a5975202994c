"""Whether a prediction moves as this speaker does: range, spectrum, distribution, acceleration."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from corpus_tools.core import FloatArray, IntArray
from corpus_tools.evaluate.comparison import Comparison
from corpus_tools.evaluate.metrics.registry import metric, quotient
from corpus_tools.evaluate.natural import Moments, Natural
from corpus_tools.synthesis import rms_acceleration

__all__ = ["frechet_distance"]

_LIP_CHIN = "lips and chin, captured frames of speech"
_FINE = "lips and chin, frames of the prediction in speech"
_TRACKS = "aperture, width, jaw; captured frames of speech"
_FFT = 256


@metric("dynamic_range", better="one", mask=_LIP_CHIN)
def _range(comparison: Comparison) -> FloatArray:
    """Spread of the prediction over that of the recording: sqrt(sum of variances made / recorded)."""
    columns = comparison.natural.columns
    made, truth = comparison.made_mm[:, columns], comparison.truth_mm[:, columns]
    return np.array([np.sqrt(made.var(axis=0).sum() / max(truth.var(axis=0).sum(), 1e-12))])


@metric("dynamic_range_aperture", better="one", mask="lip aperture, captured frames of speech")
def _range_aperture(comparison: Comparison) -> FloatArray:
    """Spread of the lip aperture: standard deviation made over recorded."""
    made, truth = comparison.made_articulators[:, 0], comparison.truth_articulators[:, 0]
    return np.array([made.std() / truth.std() if truth.std() > 1e-9 else np.nan])


def _power(comparison: Comparison, values: FloatArray, low_hz: float, high_hz: float) -> float:
    """Return the power of aperture, width and jaw, in natural sd, between two frequencies."""
    tracks = (values / comparison.natural.articulator_sd_mm)[:, [0, 1, 3]]
    tracks = np.nan_to_num(tracks - tracks.mean(axis=0)) * np.hanning(len(tracks))[:, None]
    n = max(_FFT, len(tracks))
    hz = np.fft.rfftfreq(n, 1.0 / comparison.capture.rate_hz)
    power = np.abs(np.fft.rfft(tracks, n, axis=0)) ** 2
    return float(power[(hz >= low_hz) & (hz < high_hz)].sum())


def _modulation(comparison: Comparison, low_hz: float, high_hz: float) -> FloatArray:
    both = (comparison.made_articulators, comparison.truth_articulators)
    return np.array([_power(comparison, x, low_hz, high_hz) for x in both])


@metric("modulation_4_8hz", better="one", mask=_TRACKS, combine=quotient)
def _syllables(comparison: Comparison) -> FloatArray:
    """Power of aperture, width and jaw at 4-8 Hz, made over recorded (natural: 1; Hann window, pooled)."""
    return _modulation(comparison, 4.0, 8.0)


@metric(
    "modulation_8_12hz",
    better="one",
    mask="aperture, width, jaw; captured frames of speech",
    combine=quotient,
)
def _fast(comparison: Comparison) -> FloatArray:
    """Power of aperture, width and jaw at 8-12 Hz, made over recorded (natural: 1; Hann window, pooled)."""
    return _modulation(comparison, 8.0, 12.0)


def _acceleration(comparison: Comparison) -> FloatArray:
    values = comparison.made_fine_mm[:, comparison.natural.columns]
    return rms_acceleration(values, comparison.natural.rate_hz) / comparison.natural.acceleration_p95_mm_s2


@metric("acceleration_p95", better="one", mask=_FINE)
def _usual_acceleration(comparison: Comparison) -> FloatArray:
    """95th percentile of the rms acceleration in a sentence, over the natural one of frames."""
    return np.array([np.percentile(_acceleration(comparison), 95)])


@metric("acceleration_max", better="low", mask=_FINE)
def _largest_acceleration(comparison: Comparison) -> FloatArray:
    """Largest rms acceleration in a sentence, over the natural 95th percentile of frames."""
    return np.array([_acceleration(comparison).max()])


def _mean_and_covariance(moments: FloatArray, n_features: int) -> tuple[FloatArray, FloatArray]:
    """Return means (n, k) and covariances (n, k, k) of rows of moments."""
    n = np.maximum(moments[:, :1], 1.0)
    mean = moments[:, 1 : 1 + n_features] / n
    square = moments[:, 1 + n_features :].reshape(-1, n_features, n_features) / n[..., None]
    return mean, square - mean[:, :, None] * mean[:, None, :]


def _root(matrix: FloatArray) -> FloatArray:
    values, vectors = np.linalg.eigh(matrix)
    return np.asarray((vectors * np.sqrt(values.clip(min=0))) @ vectors.T)


def frechet_distance(moments: FloatArray, reference: Moments) -> FloatArray:
    """Return the Frechet distance of normal distributions, (n,).

    ::

        |m1 - m2|^2 + tr(S1 + S2 - 2 (S2^(1/2) S1 S2^(1/2))^(1/2))

    Parameters
    ----------
    moments : (n, 1 + k + k * k)
        Rows of :meth:`~corpus_tools.evaluate.natural.Moments.flat`.
    reference : Moments
        Of k features.
    """
    k = len(reference.total)
    mean, covariance = _mean_and_covariance(moments, k)
    reference_mean, reference_covariance = _mean_and_covariance(reference.flat()[None], k)
    root = _root(reference_covariance[0])
    shared = np.sqrt(np.linalg.eigvalsh(root @ covariance @ root).clip(min=0)).sum(axis=1)
    traces = np.trace(covariance, axis1=1, axis2=2) + np.trace(reference_covariance[0])
    away = ((mean - reference_mean) ** 2).sum(axis=1)
    return np.asarray(np.maximum(away + traces - 2.0 * shared, 0.0))


def _pooled_frechet(
    shares: FloatArray, counts: FloatArray, groups: IntArray, naturals: Sequence[Natural]
) -> FloatArray:
    """Return the distance of each group's sentences to the natural speech of the others, mean over groups."""
    known = np.isfinite(shares).all(axis=1)
    total, weight = np.zeros(len(counts)), np.zeros(len(counts))
    for group, natural in enumerate(naturals):
        here = known & (groups == group)
        if not here.any():
            continue
        drawn = counts[:, here]
        n = drawn.sum(axis=1)
        distance = frechet_distance(drawn @ shares[here], natural.reference)
        total += np.where(n > 0, n * distance, 0.0)
        weight += n
    return np.asarray(np.divide(total, weight, out=np.full(len(total), np.nan), where=weight > 0))


@metric(
    "frechet",
    better="low",
    mask="8 components of all face markers, captured frames of speech",
    combine=_pooled_frechet,
    per=0,
    interval="jackknife",
)
def _distribution(comparison: Comparison) -> FloatArray:
    """Frechet distance of posture and velocity (8 PCs each, standardised) to natural speech not tested.

    The share of a sentence is n, sum x and sum x x' of its frames; distances are taken per fold against the
    recordings outside it. Drawing sentences twice makes it larger, so that its interval is that of the
    jackknife; few sentences make it larger too: compare with the row of natural speech.
    """
    features = comparison.natural.features(comparison.made_mm, comparison.capture.rate_hz)
    return Moments.of(features).flat()
