"""All recordings of a corpus brought into one head-stabilised space, smoothed; and its neutral pose."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from corpus_tools.cleaning.head_motion import HeadMotion, reference_shape, remove_head_motion
from corpus_tools.cleaning.kalman import kalman_smooth
from corpus_tools.core import Capture, FloatArray, MotionError, frozen

__all__ = ["CleanedCorpus", "clean_captures", "neutral_pose"]


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
    """

    captures: tuple[Capture, ...]
    reference_mm: FloatArray
    head_motion: tuple[HeadMotion, ...]
    scale_sd: float


def clean_captures(
    captures: Sequence[Capture],
    columns: Sequence[int],
    *,
    allow_scale: bool,
    cutoff_hz: float = 10.0,
    head_cutoff_mm: float = 1.0,
    iterations: int = 6,
    names: Sequence[str] = (),
    progress: Callable[[float, str], None] | None = None,
) -> CleanedCorpus:
    """Remove head motion and noise from all recordings of one speaker (paper A section 4).

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
    names : sequence of str, optional
        Of the recordings, for messages.
    progress : callable, optional
        ``progress(fraction, what)``; may raise to cancel.

    Raises
    ------
    MotionError
        A recording never shows 3 head markers together; the message names it.
    """
    report = progress or (lambda fraction, what: None)
    report(0.0, "finding the head")
    reference = reference_shape(captures, columns, allow_scale, head_cutoff_mm)
    cleaned, motions = [], []
    for index, capture in enumerate(captures):
        report(0.2 + 0.8 * index / len(captures), "cleaning")
        try:
            stable, motion = remove_head_motion(
                capture, reference, columns, allow_scale, head_cutoff_mm, iterations
            )
        except MotionError as error:
            name = names[index] if names else f"recording {index + 1}"
            raise MotionError(f"'{name}': {error}") from None
        cleaned.append(kalman_smooth(stable, cutoff_hz)[0])
        motions.append(motion)
    scales = np.concatenate([m.scale[m.fitted] for m in motions])
    return CleanedCorpus(tuple(cleaned), frozen(reference), tuple(motions), float(scales.std()))


def neutral_pose(captures: Sequence[Capture], quiet: Sequence[npt.NDArray[np.bool_]]) -> FloatArray:
    """Return the neutral pose (n_markers, 3) mm: the median of the quiet frames of all recordings.

    Parameters
    ----------
    captures : sequence of Capture
    quiet : sequence of (n_frames,) bool
        Frames of silence with closed lips. The median is taken over the whole corpus: the leading silence of
        one recording is not a stable neutral (paper A section 6 asks for "a neutral facial pose"; how it is
        found is our choice).

    Raises
    ------
    MotionError
        No frame is quiet.
    """
    frames = [np.asarray(c.positions_mm)[q] for c, q in zip(captures, quiet, strict=True)]
    every = np.concatenate(frames) if frames else np.zeros((0, 1, 3))
    if not len(every):
        raise MotionError("No frame of the corpus is silent with closed lips, so it shows no neutral pose.")
    return frozen(np.median(every, axis=0))
