"""All recordings of a corpus brought into one head-stabilised space, smoothed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from corpus_tools.cleaning.face_model import face_model
from corpus_tools.cleaning.filling import AUTO, check_gap_method, fill_gaps
from corpus_tools.cleaning.head_motion import (
    HeadMotion,
    fitted_frames,
    reference_shape,
    remove_head_motion,
)
from corpus_tools.cleaning.head_support import supporting_columns
from corpus_tools.cleaning.innovations import estimated_smooth
from corpus_tools.cleaning.kalman import kalman_smooth
from corpus_tools.cleaning.outliers import Outliers, find_outliers, usual_spread_mm, without_outliers
from corpus_tools.cleaning.rehearsal import REHEARSED, rehearse
from corpus_tools.cleaning.slips import Slip, find_slips, with_slips_marked
from corpus_tools.core import BoolArray, Capture, FloatArray, MotionError, frozen

Report = Callable[[float, str], None]
Noise = Literal["cutoff", "channels", "components"]

LEAST_FRAMES, LEAST_MARKERS = 240, 12
"""Of a corpus in which outliers are looked for (our choice: fewer do not tell how a face moves)."""

__all__ = ["CleanedCorpus", "clean_captures"]


@dataclass(frozen=True, slots=True, eq=False)
class CleanedCorpus:
    """Cleaned captures and what was taken out of them.

    Attributes
    ----------
    captures : tuple of Capture
        Head-stabilised, smoothed, without NaN, flags kept.
    reference_mm : (n_markers, 3) mm
    head_motion : tuple of HeadMotion
    scale_sd : float
        Spread of the head scale over all fitted frames; 0 for rigid fits.
    sd_mm : tuple of (n_frames, n_markers) mm
        One standard deviation of a coordinate of every sample after smoothing; of filled ones, of filling.
    outliers : tuple of Outliers or None
        None where nothing was looked for.
    slips : tuple of tuple of Slip
    """

    captures: tuple[Capture, ...]
    reference_mm: FloatArray
    head_motion: tuple[HeadMotion, ...]
    scale_sd: float
    sd_mm: tuple[FloatArray, ...]
    outliers: tuple[Outliers | None, ...]
    slips: tuple[tuple[Slip, ...], ...]


def _has_gaps(captures: Sequence[Capture]) -> bool:
    """Return whether markers are hidden anywhere while others are seen."""
    seen: list[BoolArray] = [np.asarray(np.isfinite(c.positions_mm).all(axis=2)) for c in captures]
    return any(bool((s.any(axis=1) & ~s.all(axis=1)).any()) for s in seen)


def _checked(
    captures: Sequence[Capture],
    columns: Sequence[int],
    known: Sequence[int],
    n_components: int,
    report: Report,
) -> tuple[list[Capture], list[Outliers | None], list[tuple[Slip, ...]]]:
    """Return captures without outliers and with slips marked, and what was found.

    Nothing is looked for where the face is too small, or shown too briefly, to tell where its markers belong.
    """
    nothing: list[tuple[Slip, ...]] = [() for _ in captures]
    familiar = [captures[i] for i in known]
    shown = sum(int(np.isfinite(c.positions_mm).any(axis=(1, 2)).sum()) for c in familiar)
    model = None
    if shown >= LEAST_FRAMES and len(captures[0].names) >= LEAST_MARKERS:
        model = face_model(familiar, n_components)
    if model is None:
        return list(captures), [None] * len(captures), nothing
    spread = usual_spread_mm(familiar, model)
    clean, outliers, slips = [], [], []
    for index, capture in enumerate(captures):
        report(index / len(captures), "looking for spikes, swaps and slips")
        outliers.append(find_outliers(capture, model, spread))
        slips.append(find_slips(capture, model, columns))
        clean.append(with_slips_marked(without_outliers(capture, outliers[-1]), slips[-1]))
    return clean, list(outliers), slips


def _head(
    captures: Sequence[Capture],
    columns: Sequence[int],
    allow_scale: bool,
    cutoff_mm: float,
    head_support: bool,
) -> tuple[list[int], FloatArray]:
    """Return the markers that find the head, and its shape; the head markers alone where none can help."""
    own = list(columns)
    reference = reference_shape(captures, own, allow_scale, cutoff_mm)
    if not head_support:
        return own, reference
    every = [*own, *supporting_columns(captures, reference, own, allow_scale, cutoff_mm)]
    whole = any(np.isfinite(np.asarray(c.positions_mm)[:, every]).all(axis=(1, 2)).any() for c in captures)
    if len(every) == len(own) or not whole:
        return own, reference
    return every, reference_shape(captures, every, allow_scale, cutoff_mm)


def _smoothed(
    filled: Capture, fill_sd_mm: FloatArray, cutoff_hz: float, noise: Noise
) -> tuple[Capture, FloatArray]:
    if noise == "cutoff":
        smooth, sd_mm = kalman_smooth(filled, cutoff_hz)
    else:
        smooth, sd_mm = estimated_smooth(filled, cutoff_hz, by_components=noise == "components")
    of_samples = np.sqrt((sd_mm**2).mean(axis=2))
    return smooth, np.where(fill_sd_mm > 0, fill_sd_mm, of_samples)


def clean_captures(
    captures: Sequence[Capture],
    columns: Sequence[int],
    *,
    allow_scale: bool,
    cutoff_hz: float = 10.0,
    head_cutoff_mm: float = 1.0,
    iterations: int = 6,
    head_support: bool = True,
    gap_method: str = AUTO,
    gap_longest_s: float = 1.0,
    gap_doubt_mm: float = 1.0,
    gap_components: int = 24,
    outliers: bool = True,
    noise: Noise = "cutoff",
    names: Sequence[str] = (),
    learn_from: Sequence[int] | None = None,
    progress: Report | None = None,
) -> CleanedCorpus:
    """Remove head motion, fill gaps and smooth all recordings of one speaker (paper A section 4).

    In this order (our choice): head removal needs no whole frame, a filled marker would only weaken it, and
    in the head-stabilised space the markers of a face tell most about each other.

    Parameters
    ----------
    captures : sequence of Capture
        The same markers in all.
    columns : sequence of int
        Head markers.
    allow_scale : bool
        Whether head removal may scale.
    cutoff_hz : float
        Of the Kalman smoother, Hz.
    head_cutoff_mm, iterations
        As of :func:`~corpus_tools.cleaning.head_motion.estimate_head_motion`.
    head_support : bool
        Let markers of the upper face that hardly move against the head take part in finding it.
    gap_method, gap_longest_s, gap_doubt_mm
        As of :func:`~corpus_tools.cleaning.filling.fill_gaps`.
    gap_components : int
        Of the model of the face that fills gaps.
    outliers : bool
        Whether spikes and exchanged markers are taken out (and filled, flagged) and slips are marked.
    noise : "cutoff", "channels" or "components"
        The smoother keeps `cutoff_hz` in all channels; or finds noise and cutoff from the innovations of each
        channel, or of each principal component (:mod:`~corpus_tools.cleaning.innovations`).
    names : sequence of str, optional
        Of the recordings, for messages.
    learn_from : sequence of int, optional
        Captures that may say what the head looks like and how the face moves; all when None. With held-out
        captures left out here, the cleaning of the others does not depend on them.
    progress : callable, optional
        ``progress(fraction, what)``; may raise to cancel.

    Raises
    ------
    MotionError
        A recording never shows 3 head markers together; the message names it.
    InputError
        There is no such way to fill gaps.
    """
    check_gap_method(gap_method)
    report = progress or (lambda fraction, what: None)
    report(0.0, "finding the head")
    known = range(len(captures)) if learn_from is None else learn_from
    fitting, reference = _head(
        [captures[i] for i in known], columns, allow_scale, head_cutoff_mm, head_support
    )
    stable, motions = [], []
    for index, capture in enumerate(captures):
        report(0.2 + 0.4 * index / len(captures), "removing head motion")
        try:
            fitted_frames(capture.positions_mm, columns)  # markers of the face help, and do not stand in
            still, motion = remove_head_motion(
                capture, reference, fitting, allow_scale, head_cutoff_mm, iterations
            )
        except MotionError as error:
            name = names[index] if names else f"recording {index + 1}"
            raise MotionError(f"'{name}': {error}") from None
        stable.append(still)
        motions.append(motion)
    found: list[Outliers | None] = [None] * len(stable)
    slips: list[tuple[Slip, ...]] = [()] * len(stable)
    if outliers:
        stable, found, slips = _checked(
            stable, columns, known, gap_components, lambda f, w: report(0.6 + 0.1 * f, w)
        )
    familiar = [stable[i] for i in known]
    wanted = gap_method in (AUTO, "pca-gp") and _has_gaps(stable)
    model = face_model(familiar, gap_components) if wanted else None
    tried = REHEARSED if gap_method == AUTO else [gap_method]
    rehearsals = rehearse(
        familiar,
        model,
        [m for m in tried if m != "kalman"],
        progress=lambda fraction, what: report(0.7 + 0.1 * fraction, what),
    )
    cleaned, bands = [], []
    for index, still in enumerate(stable):
        report(0.8 + 0.2 * index / len(captures), "cleaning")
        filled = fill_gaps(
            still,
            gap_method,
            model=model,
            rehearsals=rehearsals,
            longest_s=gap_longest_s,
            doubt_mm=gap_doubt_mm,
        )
        smooth, band = _smoothed(*filled, cutoff_hz, noise)
        cleaned.append(smooth)
        bands.append(frozen(band))
    scales = np.concatenate([m.scale[m.fitted] for m in motions])
    return CleanedCorpus(
        tuple(cleaned),
        frozen(reference),
        tuple(motions),
        float(scales.std()),
        tuple(bands),
        tuple(found),
        tuple(slips),
    )
