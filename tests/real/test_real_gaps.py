"""Stretches taken out of real captures and filled again: at most half the error of a cubic."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from corpus_tools.cleaning import face_model, fill_gaps, reference_shape, remove_head_motion
from corpus_tools.core import Capture
from corpus_tools.io import read_markers


def stable(files, prefix, allow_scale, together):
    captures = [c for c in map(read_markers, files) if np.isfinite(c.positions_mm).all()]
    columns = [i for i, n in enumerate(captures[0].names) if n.lower().startswith(prefix)]
    reference = reference_shape(captures, columns, allow_scale) if together else None
    made = []
    for c in captures:
        shape = reference if together else reference_shape([c], columns, allow_scale)
        made.append(remove_head_motion(c, shape, columns, allow_scale)[0])
    return made


@pytest.fixture(scope="module")
def takes(corpora):
    grid = sorted((corpora / "grid_s1" / "markers73").glob("*.npz"))[::6]
    animated = sorted((corpora / "animface_mocap").glob("*.npz"))
    return {
        "grid_s1": stable(grid, "head", True, True),
        "animface_mocap": stable(animated, "forehead", False, False),
    }


def take_out(captures, size, rng):
    """Return a capture without one marker for a while, where that was, and the whole capture."""
    whole = captures[rng.integers(len(captures))]
    n = whole.n_frames
    size = min(size, n // 3)
    first, marker = int(rng.integers(8, n - size - 8)), int(rng.integers(len(whole.names)))
    positions = np.array(whole.positions_mm)
    positions[first : first + size, marker] = np.nan
    return Capture(positions, whole.rate_hz, whole.names), np.arange(first, first + size), marker, whole


@pytest.mark.parametrize("name", ["grid_s1", "animface_mocap"])
def test_a_marker_that_was_taken_out_comes_back(takes, name):
    """6 to 48 frames together; in slow optical capture gaps of 12 frames alone reach .64 of the cubic."""
    rng = np.random.default_rng(12)
    ratios, every = {}, []
    for size in (6, 12, 24, 48):
        errors = []
        for _ in range(16):
            hole, gap, marker, whole = take_out(takes[name], size, rng)
            known = [hole, *(c for c in takes[name] if c is not whole)] if name == "grid_s1" else [hole]
            filled, _ = fill_gaps(hole, model=face_model(known))
            keep = np.setdiff1d(np.arange(whole.n_frames), gap)
            truth = whole.positions_mm[gap, marker]
            guesses = (
                filled.positions_mm[gap, marker],
                CubicSpline(keep, whole.positions_mm[keep, marker])(gap),
            )
            errors.append([((g - truth) ** 2).sum(axis=1).mean() for g in guesses])
        ratios[size] = np.sqrt(np.divide(*np.mean(errors, axis=0)))
        every.append(np.mean(errors, axis=0))
    assert np.sqrt(np.divide(*np.mean(every, axis=0))) <= 0.5
    assert max(ratios.values()) < 0.8, ratios
