"""The neutral pose of a speaker: what retargeting starts from (paper A section 6)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from corpus_tools.core import Capture, FloatArray, MotionError, frozen

__all__ = ["neutral_pose"]


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
