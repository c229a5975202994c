"""What lips and jaw do, read off the markers: aperture, width, jaw; when the lips close."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from scipy.interpolate import CubicSpline

from corpus_tools.core import Capture, FloatArray, Utterance
from corpus_tools.speech.phone_sets import PhoneSet

__all__ = [
    "APERTURE_PAIRS",
    "CLOSURE_WINDOW_S",
    "aperture_functional",
    "bilabial_minima_mm",
    "bite_functional",
    "closure_offset",
    "closure_threshold_mm",
    "jaw_mm",
    "lip_aperture_mm",
    "lip_pair_functionals",
    "lip_protrusion_mm",
    "lip_width_mm",
    "phone_minima_mm",
]

APERTURE_PAIRS = (("lip_in1", "lip_in7"), ("lip_in2", "lip_in6"), ("lip_in3", "lip_in5"))
"""Upper and lower inner-lip markers that face each other."""

_OUTER_PAIRS = (("lip_out2", "lip_out10"), ("lip_out3", "lip_out9"), ("lip_out4", "lip_out8"))
STILL_MM = 0.01
"""Lips whose mean aperture changes by less around bilabials do not move (our choice: below noise)."""
CLOSURE_WINDOW_S = 0.04
"""Margin around a bilabial in which its closure is looked for, s (the error of automatic labels)."""


def _pairs(names: Sequence[str]) -> list[tuple[int, int]]:
    where = {n: i for i, n in enumerate(names)}
    for pairs in (APERTURE_PAIRS, _OUTER_PAIRS):
        found = [(where[a], where[b]) for a, b in pairs if a in where and b in where]
        if found:
            return found
    return []


def aperture_functional(names: Sequence[str]) -> FloatArray:
    """Return the weights of the signed lip aperture: aperture = sum(weights * positions).

    Mean over the pairs of (upper - lower) along y, the up axis of the head-stabilised space; the outer lip
    stands in for a layout without inner-lip markers.

    Parameters
    ----------
    names : sequence of str
        Marker names, n_markers.

    Returns
    -------
    (n_markers, 3) float64
        All zero when the layout has no lips.
    """
    weights = np.zeros((len(names), 3))
    pairs = _pairs(names)
    for upper, lower in pairs:
        weights[upper, 1] += 1.0 / len(pairs)
        weights[lower, 1] -= 1.0 / len(pairs)
    return weights


def bite_functional(names: Sequence[str]) -> FloatArray:
    """Return the weights of how far the lower lip stands below the upper teeth, up to a constant.

    Mean over the lower markers of the pairs of -y: the upper teeth stand still in head-stabilised space, so
    that the lip is on them where this is least.

    Parameters
    ----------
    names : sequence of str
        Marker names, n_markers.

    Returns
    -------
    (n_markers, 3) float64
        All zero when the layout has no lips.
    """
    return np.minimum(aperture_functional(names), 0.0)


def lip_pair_functionals(names: Sequence[str]) -> FloatArray:
    """Return the weights of each facing pair of lip markers, (n_pairs, n_markers, 3): upper - lower along y.

    Their mean is :func:`aperture_functional`; no pairs when the layout has no lips.
    """
    pairs = _pairs(names)
    weights = np.zeros((len(pairs), len(names), 3))
    for index, (upper, lower) in enumerate(pairs):
        weights[index, upper, 1], weights[index, lower, 1] = 1.0, -1.0
    return weights


def lip_aperture_mm(positions_mm: FloatArray, names: Sequence[str]) -> FloatArray:
    """Return the signed lip aperture, mm: (n_frames,) from (n_frames, n_markers, 3).

    Negative where the contours cross; along y, so head motion must have been removed. NaN in frames in which
    any marker is missing, be it one of the lips or not; 0 when the layout has no lips.
    """
    return np.asarray(np.einsum("fmk,mk->f", positions_mm, aperture_functional(names)))


def _distance(positions_mm: FloatArray, names: Sequence[str], a: str, b: str) -> FloatArray:
    i, j = list(names).index(a), list(names).index(b)
    return np.asarray(np.linalg.norm(positions_mm[:, i] - positions_mm[:, j], axis=1))


def lip_width_mm(positions_mm: FloatArray, names: Sequence[str]) -> FloatArray:
    """Return the distance of the mouth corners (lip_out0, lip_out6), mm, shape (n_frames,)."""
    return _distance(positions_mm, names, "lip_out0", "lip_out6")


def lip_protrusion_mm(positions_mm: FloatArray, names: Sequence[str]) -> FloatArray:
    """Return how far forward the middle of both lips stands, mm, shape (n_frames,).

    Mean z, the axis out of the face, of the facing markers of the outer lip (of the inner lip where a layout
    has no outer one); its zero is that of the head-stabilised space.
    """
    where = {n: i for i, n in enumerate(names)}
    for pairs in (_OUTER_PAIRS, APERTURE_PAIRS):
        columns = [where[n] for pair in pairs for n in pair if n in where]
        if columns:
            return np.asarray(positions_mm[:, columns, 2].mean(axis=1))
    return np.zeros(len(positions_mm))


def jaw_mm(positions_mm: FloatArray, names: Sequence[str]) -> FloatArray:
    """Return the distance from the base of the nose to the chin (nose5, chin3), mm, shape (n_frames,)."""
    return _distance(positions_mm, names, "nose5", "chin3")


def phone_minima_mm(
    capture: Capture, utterance: Utterance, labels: Collection[str], functional: FloatArray
) -> FloatArray:
    """Return the least value of a functional within :data:`CLOSURE_WINDOW_S` of each of some phones, mm."""
    signal = np.einsum("fmk,mk->f", capture.positions_mm, functional)
    times = capture.times_s
    found = []
    for phone in utterance.phones:
        if phone.text in labels:
            inside = (times >= phone.start_s - CLOSURE_WINDOW_S) & (times <= phone.end_s + CLOSURE_WINDOW_S)
            if inside.any() and np.isfinite(signal[inside]).any():
                found.append(np.nanmin(signal[inside]))
    return np.array(found)


def bilabial_minima_mm(capture: Capture, utterance: Utterance, phones: PhoneSet) -> FloatArray:
    """Return the least aperture within :data:`CLOSURE_WINDOW_S` of each bilabial, mm."""
    return phone_minima_mm(capture, utterance, phones.bilabials, aperture_functional(capture.names))


def closure_threshold_mm(
    captures: Sequence[Capture], utterances: Sequence[Utterance], phones: PhoneSet
) -> float:
    """Return the aperture below which this speaker's lips are closed, mm.

    95th percentile of the corpus's own bilabial minima (our choice; .88 mm on GRID speaker s1). NaN when the
    corpus has no bilabial.
    """
    minima = [bilabial_minima_mm(c, u, phones) for c, u in zip(captures, utterances, strict=True)]
    every = np.concatenate([*minima, np.zeros(0)])
    return float(np.percentile(every, 95)) if len(every) else float("nan")


def closure_offset(
    captures: Sequence[Capture],
    utterances: Sequence[Utterance],
    phones: PhoneSet,
    reach_s: float = 0.1,
    step_s: float = 0.005,
) -> float | None:
    """Return by how much later the motion would have to lie for the lips to close in the bilabials, s.

    The mean aperture at the centres of all bilabials is taken for shifts of the motion from -`reach_s` to
    +`reach_s`; the shift of the least mean is returned, refined by a parabola. None when there are fewer than
    5 bilabials, when the lips do not move, or when they close nowhere within reach: no minimum lies inside.
    Positive: the motion comes too early; add the value to ``audio_offset_s``.
    """
    shifts = np.arange(-reach_s, reach_s + step_s / 2, step_s)
    rows = []
    for capture, utterance in zip(captures, utterances, strict=True):
        aperture = lip_aperture_mm(capture.positions_mm, capture.names)
        if capture.n_frames < 4 or not np.isfinite(aperture).all():
            continue
        curve = CubicSpline(capture.times_s, aperture)
        for phone in utterance.phones:
            times = phone.centre_s - shifts
            if (
                phone.text in phones.bilabials
                and times[-1] > capture.times_s[0]
                and times[0] < capture.times_s[-1]
            ):
                rows.append(curve(times))
    if len(rows) < 5:
        return None
    mean = np.mean(rows, axis=0)
    k = int(np.argmin(mean))
    if np.ptp(mean) < STILL_MM or not 0 < k < len(mean) - 1:
        return None
    left, middle, right = mean[k - 1 : k + 2]
    bend = left - 2 * middle + right
    return float(shifts[k] + (0.5 * step_s * (left - right) / bend if bend > 0 else 0.0))
