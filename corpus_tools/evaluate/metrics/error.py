"""How far a prediction lies from the recording. Low is good, and not enough: a mean is near to everything."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from corpus_tools.core import SPEECH_REGIONS, FloatArray, IntArray
from corpus_tools.evaluate.comparison import Comparison
from corpus_tools.evaluate.metrics.registry import METRICS, Metric, mean_of_sentences, metric
from corpus_tools.evaluate.natural import ARTICULATORS

__all__ = ["STILL_MM", "correlation", "dtw_distance", "rms_error"]

DTW_BAND_S = 0.24
"""How far time may be bent, s."""

STILL_MM = 1e-9
"""Standard deviation below which nothing moves, mm."""

_LIP_CHIN = "lips and chin, captured frames of speech"


def rms_error(error_mm: FloatArray, seen: FloatArray) -> float:
    """Return sqrt(mean |e|^2) over seen samples, mm; NaN when there are none.

    Parameters
    ----------
    error_mm : (n_frames, n_markers, 3) mm
    seen : (n_frames, n_markers) bool
    """
    n = float(seen.sum())
    return float(np.sqrt(((error_mm**2).sum(axis=2) * seen).sum() / n)) if n else float("nan")


def _error(comparison: Comparison, columns: IntArray) -> tuple[FloatArray, FloatArray]:
    error = comparison.made_mm[:, columns] - comparison.truth_mm[:, columns]
    return error, comparison.measured[:, columns].astype(np.float64)


def _region(comparison: Comparison, regions: Sequence[str] | None) -> FloatArray:
    """Return the RMSE of some regions, mm."""
    columns = comparison.columns(regions)
    if regions and not set(regions) & set(comparison.capture.regions):
        return np.array([np.nan])
    return np.array([rms_error(*_error(comparison, columns))])


for _name, _regions, _mask in (
    ("rmse", SPEECH_REGIONS, "lips and chin"),
    ("rmse_lips", ("lip_out", "lip_in"), "lips"),
    ("rmse_chin", ("chin",), "chin"),
    ("rmse_cheek", ("cheek",), "cheeks"),
    ("rmse_upper", ("brow", "eye", "nose"), "brows, eyes, nose"),
    ("rmse_face", None, "all face markers"),
):
    _share = partial(_region, regions=_regions)
    _share.__doc__ = f"RMSE over {_mask}: sqrt(mean over frames and markers of |made - recorded|²)."
    METRICS.add(
        _name,
        Metric(_name, "mm", "low", f"{_mask}, captured frames of speech", _share, mean_of_sentences),
    )


@metric("nrmse", better="low", mask=_LIP_CHIN)
def _relative(comparison: Comparison) -> FloatArray:
    """RMSE over the natural 3-D standard deviation of lips and chin in speech: the mean pose has about 1."""
    return _region(comparison, SPEECH_REGIONS) / comparison.natural.posture_sd_mm


@metric("rmse_centred", unit="mm", better="low", mask=_LIP_CHIN)
def _centred(comparison: Comparison) -> FloatArray:
    """RMSE after the mean error of each marker in the sentence is taken out: the posture does not count."""
    error, seen = _error(comparison, comparison.columns(SPEECH_REGIONS))
    count = np.maximum(seen.sum(axis=0), 1.0)[:, None]
    mean = (error * seen[..., None]).sum(axis=0) / count
    return np.array([rms_error(error - mean, seen)])


def correlation(a: FloatArray, b: FloatArray) -> float:
    """Return Pearson's r; NaN, as it is not defined, when one of both does not move."""
    if len(b) < 2 or min(a.std(), b.std()) < STILL_MM:
        return float("nan")
    return float(np.corrcoef(a, b)[0, 1])


def _correlated(comparison: Comparison, which: int) -> FloatArray:
    here = comparison.whole
    made, truth = comparison.made_articulators[here, which], comparison.truth_articulators[here, which]
    return np.array([correlation(made, truth)])


for _which, _name in enumerate(ARTICULATORS):
    _share = partial(_correlated, which=_which)
    _share.__doc__ = f"Pearson correlation of the {_name} with the recorded one within a sentence."
    METRICS.add(
        f"r_{_name}",
        Metric(f"r_{_name}", "", "high", f"{_name}, captured frames of speech", _share, mean_of_sentences),
    )


def dtw_distance(a: FloatArray, b: FloatArray, band: int) -> float:
    """Return the mean distance along the cheapest path that lays one sequence on the other.

    Steps are (1, 0), (0, 1) and (1, 1), the distance of two frames is the rms over features, and the total
    is divided by the number of steps of the path.

    Parameters
    ----------
    a, b : (n_frames, n_features)
    band : int
        Frames by which the path may leave the diagonal.
    """
    n = len(a)
    if n == 0:
        return float("nan")
    distance = np.sqrt(((a[:, None] - b[None]) ** 2).mean(axis=2)).tolist()
    infinite = (float("inf"), 0)
    before = [infinite] * (n + 1)
    before[0] = (0.0, 0)
    for i in range(1, n + 1):
        row = [infinite] * (n + 1)
        for j in range(max(1, i - band), min(n, i + band) + 1):
            least, steps = min(before[j - 1], before[j], row[j - 1], key=_first)
            row[j] = (least + distance[i - 1][j - 1], steps + 1)
        before = row
    total, steps = before[n]
    return total / steps


def _first(item: tuple[float, int]) -> float:
    return item[0]


@metric("dtw", better="low", mask="aperture, width, jaw; captured frames of speech")
def _warped(comparison: Comparison) -> FloatArray:
    """DTW distance of aperture, width and jaw, each in natural standard deviations, band 0.24 s."""
    used = [0, 1, 3]
    sd = comparison.natural.articulator_sd_mm[used]
    here = comparison.whole
    made, truth = (
        x[here][:, used] / sd for x in (comparison.made_articulators, comparison.truth_articulators)
    )
    keep = np.isfinite(truth).all(axis=0)
    band = max(1, round(DTW_BAND_S * comparison.capture.rate_hz))
    return np.array([dtw_distance(made[:, keep], truth[:, keep], band)])
