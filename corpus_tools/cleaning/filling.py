"""Filling of gaps, each filled sample with its uncertainty and its flag (paper A section 4)."""

from __future__ import annotations

from collections import Counter

import numpy as np

from corpus_tools.cleaning.face_model import FaceModel
from corpus_tools.cleaning.fillers import GAP_FILLERS, others_tell
from corpus_tools.cleaning.gaps import frame_ranges
from corpus_tools.cleaning.rehearsal import Rehearsals
from corpus_tools.core import BoolArray, Capture, FloatArray, FrameFlag, InputError, step
from corpus_tools.core.errors import suggestion

__all__ = ["AUTO", "check_gap_method", "fill_gaps"]

AUTO = "auto"


def check_gap_method(name: str) -> None:
    """Refuse a name that is neither "auto" nor that of a filler.

    Raises
    ------
    InputError
        It lists what there is.
    """
    known = [AUTO, *GAP_FILLERS]
    if name not in known:
        hint = suggestion(name, known) or "."
        raise InputError(f"There is no gap filling called '{name}'{hint} Known: {', '.join(known)}.")


def _gap_groups(seen: BoolArray) -> dict[tuple[int, int], list[int]]:
    """Return the gaps (first, last) and the markers that have each."""
    found: dict[tuple[int, int], list[int]] = {}
    for column in np.flatnonzero(~seen.all(axis=0) & seen.any(axis=0)):
        for gap in frame_ranges(~seen[:, column]):
            found.setdefault(gap, []).append(int(column))
    return found


def fill_gaps(
    capture: Capture,
    method: str = AUTO,
    *,
    model: FaceModel | None = None,
    rehearsals: Rehearsals | None = None,
    longest_s: float = 1.0,
    doubt_mm: float = 1.0,
) -> tuple[Capture, FloatArray]:
    """Fill what is missing; what was measured is not touched.

    Parameters
    ----------
    capture : Capture
        In the head-stabilised space, not smoothed yet.
    method : str
        A name of :data:`GAP_FILLERS`, or "auto": for each gap the filler that did best in rehearsals of its
        length, with as many other markers seen as there.
    model : FaceModel, optional
        How the markers of this face move together, for "pca-gp".
    rehearsals : Rehearsals, optional
        From :func:`~corpus_tools.cleaning.rehearsal.rehearse`; they also scale the bands. Without them "auto"
        is "pca-gp", and bands are those of the fillers' own models.
    longest_s : float
        A longer gap is filled too, but marked doubtful.
    doubt_mm : float
        Uncertainty (one standard deviation) from which on a filled sample is marked doubtful, mm.

    Returns
    -------
    Capture
        Filled samples are flagged. What a method cannot say stays NaN: a marker that is never seen, and a gap
        of the whole face at either end; the smoother holds the nearest pose there and marks it doubtful.
    sd_mm : (n_frames, n_markers) mm
        One standard deviation of each filled sample (of a coordinate); 0 where nothing was filled.

    Raises
    ------
    InputError
        There is no such method.
    """
    check_gap_method(method)  # whether there are gaps or not
    rehearsed, used = rehearsals or Rehearsals(), Counter[str]()
    positions = np.array(capture.positions_mm)
    seen: BoolArray = np.asarray(np.isfinite(positions).all(axis=2))
    sd_mm = np.zeros(seen.shape)
    if seen.all():
        return capture, sd_mm
    assert capture.flags is not None
    flags, filled = np.array(capture.flags), np.zeros(seen.shape, bool)
    measured = np.where(seen[..., None], positions, np.nan)
    for gap, columns in _gap_groups(seen).items():
        markers, n = np.array(columns), gap[1] - gap[0] + 1
        others = others_tell(seen, gap)
        chosen = rehearsed.best(n, others) if method == AUTO else method
        values, sd = GAP_FILLERS[chosen](measured, capture.rate_hz, gap, markers, model)
        sd = sd * rehearsed.widen(n, others, chosen)
        used[chosen] += len(columns)
        block = np.ix_(np.arange(gap[0], gap[1] + 1), markers)
        said = np.isfinite(values).all(axis=2)
        positions[block] = values
        sd_mm[block] = np.where(said, sd, 0.0)
        long = n / capture.rate_hz > longest_s
        doubt = np.where(long | (sd > doubt_mm), FrameFlag.DOUBTFUL, 0).astype(np.uint8)
        kept = flags[block] & np.uint8(FrameFlag.DOUBTFUL | FrameFlag.OUTLIER)
        marked = kept | np.uint8(FrameFlag.FILLED) | doubt
        flags[block] = np.where(said, marked, flags[block])
        filled[block] = said
    done = step(
        "fill_gaps",
        method=method,
        samples=int(filled.sum()),
        largest_sd_mm=round(float(sd_mm.max()), 4),
        gaps=", ".join(f"{name} {count}" for name, count in sorted(used.items())),
    )
    return capture.with_step(done, positions_mm=positions, flags=flags), sd_mm
