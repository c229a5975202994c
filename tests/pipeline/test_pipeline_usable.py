"""Motion that stands still to the last digit is no capture: it is named, and no units are cut from it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import Capture
from corpus_tools.pipeline import check_corpus, read_corpus
from corpus_tools.pipeline.usable import frozen_problem

RATE_HZ = 50.0


def moving(n_frames):
    return np.random.default_rng(0).normal(0, 10, (n_frames, 4, 3))


@given(first=st.integers(0, 100), n_equal=st.integers(1, 100), low=st.integers(0, 120))
def test_a_stretch_is_named_when_more_than_a_second_of_it_lies_in_speech(first, n_equal, low):
    positions = moving(250)
    positions[first : first + n_equal + 1] = positions[first]
    found = frozen_problem(Capture(positions, RATE_HZ, tuple("abcd")), low / RATE_HZ, 10.0)
    n_inside = first + n_equal - max(first, low)
    assert (found is not None) == (n_inside > RATE_HZ)
    if found:
        assert f"{max(first, low) / RATE_HZ:.3f} to {(first + n_equal) / RATE_HZ:.3f} s" in found


@pytest.mark.parametrize("n_frames", [2, 20])
def test_a_recording_of_one_pose_is_named_however_short(n_frames):
    positions = np.repeat(moving(1), n_frames, axis=0)
    assert "stands still" in frozen_problem(Capture(positions, RATE_HZ, tuple("abcd")), 0.1, 0.2)


def test_one_marker_that_moves_a_gap_and_a_single_frame_are_not_still():
    one = np.repeat(moving(1), 200, axis=0)
    one[:, 2, 1] += np.arange(200) * 1e-9
    assert frozen_problem(Capture(one, RATE_HZ, tuple("abcd")), 0.0, 10.0) is None
    gap = moving(200)
    gap[20:180] = np.nan
    assert frozen_problem(Capture(gap, RATE_HZ, tuple("abcd")), 0.0, 10.0) is None
    assert frozen_problem(Capture(moving(1), RATE_HZ, tuple("abcd")), 0.0, 10.0) is None
    hidden = np.repeat(moving(1), 200, axis=0)
    hidden[50:, 3] = np.nan  # the others stand still all the same
    assert "0.000 to 3.980 s" in frozen_problem(Capture(hidden, RATE_HZ, tuple("abcd")), 0.0, 10.0)


def test_check_names_it_and_no_units_are_cut_from_it(spoiled, alter):
    def freeze(capture):
        positions = np.repeat(np.nan_to_num(capture.positions_mm[:1], nan=1.0), capture.n_frames, axis=0)
        return Capture(positions, capture.rate_hz, capture.names)

    for name in ("time02", "time03"):
        alter(name, freeze)
    (spoiled / "textgrid" / "time03.TextGrid").unlink()
    said = {row["id"]: " ".join(row["problems"]) for row in check_corpus(spoiled)["recordings"]}
    assert [name for name, text in said.items() if "stands still" in text] == ["time02", "time03"]
    raw = read_corpus(spoiled)
    assert raw.names == ("time01", "time04")
    assert "stands still" in raw.skipped["time02"]
