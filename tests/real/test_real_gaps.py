"""Stretches taken out of real captures and filled again: half the error of a cubic, and true bands."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from corpus_tools.cleaning import face_model, fill_gaps, reference_shape, rehearse, remove_head_motion
from corpus_tools.core import Capture
from corpus_tools.io import read_markers

SIZES = (6, 12, 24, 48)
IN_VIDEO = ((6, 12, 6), (24,), (48,), (12, 6, 6))
"""Of the gaps of one recording of 75 frames."""

IN_TAKES = SIZES * 3 + (6, 12) * 3
"""Of those of a take of 15 s and more."""

MARGIN, NORMAL_90 = 8, 1.645


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
    grid = sorted((corpora / "grid_s1" / "markers73").glob("*.npz"))[::4]
    animated = sorted((corpora / "animface_mocap").glob("*.npz"))
    return {
        "grid_s1": stable(grid, "head", True, True),
        "animface_mocap": stable(animated, "forehead", False, False),
    }


def take_out(whole, sizes, rng):
    """Return a capture without one marker for a while, once per size, and where: (first, last, marker).

    Gaps do not meet in time.
    """
    positions, holes, end = np.array(whole.positions_mm), [], 0
    slack = (whole.n_frames - sum(sizes) - 2 * MARGIN * len(sizes)) // len(sizes)
    for size in sizes:
        first = end + MARGIN + int(rng.integers(slack + 1))
        end += size + 2 * MARGIN + slack
        marker = int(rng.integers(len(whole.names)))
        positions[first : first + size, marker] = np.nan
        holes.append((first, first + size - 1, marker))
    return Capture(positions, whole.rate_hz, whole.names), holes


def refilled(wholes, holed, rehearsals=None):
    """Return (size, errors of the filled, of a cubic, both (n, 3) mm, and the band (n,)) of every gap."""
    captures = [hole for hole, _ in holed]
    model = face_model(captures)
    rehearsals = rehearsals or rehearse(captures, model)
    found = []
    for whole, (hole, holes) in zip(wholes, holed, strict=True):
        filled, sd_mm = fill_gaps(hole, model=model, rehearsals=rehearsals)
        for first, last, marker in holes:
            gap = np.arange(first, last + 1)
            keep = np.setdiff1d(np.arange(whole.n_frames), gap)
            truth = whole.positions_mm[gap, marker]
            cubic = CubicSpline(keep, whole.positions_mm[keep, marker])(gap)
            error = filled.positions_mm[gap, marker] - truth
            found.append((len(gap), error, cubic - truth, sd_mm[gap, marker]))
    return found


@pytest.fixture(scope="module")
def filled(takes):
    """The gaps of all captures; those of 24 and 48 frames are 36 in optical capture and 12 in video."""
    rng = np.random.default_rng(12)
    grid, animated = takes["grid_s1"], takes["animface_mocap"]
    one_each = [take_out(c, IN_VIDEO[i % 4], rng) for i, c in enumerate(grid)]
    many = []
    for take in animated:
        holed = [take_out(take, IN_TAKES, rng) for _ in range(3)]
        first = holed[0][0]
        rehearsals = rehearse([first], face_model([first]))
        for one in holed:
            many += refilled([take], [one], rehearsals)
    return {"grid_s1": refilled(grid, one_each), "animface_mocap": many}


@pytest.mark.parametrize("name", ["grid_s1", "animface_mocap"])
def test_a_marker_that_was_taken_out_comes_back(filled, name):
    """At most half the error of a cubic, at every size, with the filler that is chosen per gap."""
    for size in SIZES:
        of_size = [f for f in filled[name] if f[0] == size]
        ours, cubic = (np.sqrt(np.mean([(f[k] ** 2).sum(axis=1).mean() for f in of_size])) for k in (1, 2))
        assert len(of_size) >= 12
        assert ours <= 0.5 * cubic, f"{size} frames: {ours:.3f} mm, a cubic {cubic:.3f} mm"


def covered(found):
    far = [np.abs(error) / sd[:, None] <= NORMAL_90 for _, error, _, sd in found]
    return float(np.mean(np.concatenate(far)))


@pytest.mark.parametrize("name", ["grid_s1", "animface_mocap"])
def test_the_band_of_90_percent_holds_90_percent(filled, name):
    assert 0.85 <= covered(filled[name]) <= 0.95


def test_the_band_holds_what_it_says_at_every_size(filled):
    every = filled["grid_s1"] + filled["animface_mocap"]
    shares = {size: covered([f for f in every if f[0] == size]) for size in SIZES}
    assert 0.85 <= min(shares.values()) <= max(shares.values()) <= 0.95, shares
