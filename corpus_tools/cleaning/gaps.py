"""Where markers are missing, as ranges of frames."""

from __future__ import annotations

import numpy as np

from corpus_tools.core import BoolArray, Capture

__all__ = ["frame_ranges", "gaps", "marker_gaps"]


def frame_ranges(missing: BoolArray) -> list[tuple[int, int]]:
    """Return the runs of True in (n_frames,) as ranges (first, last), both included."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], missing.astype(np.int8), [0]])))
    return [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def gaps(capture: Capture) -> list[tuple[int, int]]:
    """Return the ranges (first, last), both included, of frames in which any marker is missing."""
    return frame_ranges(np.asarray(~np.isfinite(capture.positions_mm).all(axis=(1, 2))))


def marker_gaps(capture: Capture) -> dict[str, list[tuple[int, int]]]:
    """Return the ranges of missing frames of every marker that has any."""
    missing = np.asarray(~np.isfinite(capture.positions_mm).all(axis=2))
    return {n: frame_ranges(missing[:, i]) for i, n in enumerate(capture.names) if missing[:, i].any()}
