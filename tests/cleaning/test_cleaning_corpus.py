"""A corpus cleaned as a whole: one space for all recordings, gaps named, a neutral pose found."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from corpus_tools.cleaning import clean_captures, gaps, marker_gaps, neutral_pose
from corpus_tools.cleaning.gaps import frame_ranges
from corpus_tools.core import Capture, FrameFlag, MotionError

NAMES = (*(f"head{i}" for i in range(5)), "chin0", "lip_in2", "lip_in6")
HEAD = list(range(5))
FACE = np.random.default_rng(0).normal(scale=40.0, size=(8, 3))


def recording(seed, n=90, noise_mm=0.05, scale=1.0):
    """Return the true face motion and a simulated capture of it: turned, shaken, seen from elsewhere."""
    random = np.random.default_rng(seed)
    times = np.arange(n) / 120.0
    face = np.repeat(FACE[None], n, axis=0)
    face[:, 5:] += 3.0 * np.sin(2 * np.pi * (2 * times[:, None, None] + random.random((1, 3, 3))))
    sway = 0.1 * np.sin(2 * np.pi * times[:, None] + random.random(3)) + random.normal(scale=0.1, size=3)
    turns = Rotation.from_rotvec(sway).as_matrix()
    shift = random.normal(scale=50, size=3) + 20 * sway
    seen = face @ turns / scale + shift[:, None] + random.normal(scale=noise_mm, size=face.shape)
    return face, Capture(seen, 120.0, NAMES)


def rms(x):
    return float(np.sqrt((x**2).mean()))


def congruent(found, wanted):
    """Return `found` (frames, markers, 3) brought onto `wanted` by one rotation and shift for all frames."""
    a, b = found.reshape(-1, 3), wanted.reshape(-1, 3)
    turn, _ = Rotation.align_vectors(b - b.mean(0), a - a.mean(0))
    return (turn.apply(a - a.mean(0)) + b.mean(0)).reshape(found.shape)


def test_all_recordings_come_into_one_space():
    truth, captures = zip(*(recording(i) for i in range(6)), strict=True)
    cleaned = clean_captures(captures, HEAD, allow_scale=False)
    found = np.concatenate([c.positions_mm for c in cleaned.captures])
    wanted = np.concatenate(truth)
    assert rms(congruent(found, wanted) - wanted) < 0.05
    assert cleaned.scale_sd == 0
    assert [m.fitted.all() for m in cleaned.head_motion] == [True] * 6
    assert [s.name for s in cleaned.captures[0].history] == ["remove_head_motion", "kalman_smooth"]


def test_the_spread_of_the_head_scale_is_reported():
    scales = [0.96, 0.98, 1.0, 1.02, 1.04]
    captures = [recording(i, scale=s)[1] for i, s in enumerate(scales)]
    cleaned = clean_captures(captures, HEAD, allow_scale=True)
    assert cleaned.scale_sd == pytest.approx(np.std(scales), rel=0.02)
    sizes = [np.linalg.norm(c.positions_mm[:, 0] - c.positions_mm[:, 1], axis=1) for c in cleaned.captures]
    assert np.std([s.mean() for s in sizes]) < 0.01 * np.mean(sizes)
    rigid = clean_captures(captures, HEAD, allow_scale=False)
    sizes = [np.linalg.norm(c.positions_mm[:, 0] - c.positions_mm[:, 1], axis=1) for c in rigid.captures]
    assert np.std([s.mean() for s in sizes]) > 0.02 * np.mean(sizes)


def test_gaps_are_bridged_and_the_input_stays():
    truth, capture = recording(1)
    positions = np.array(capture.positions_mm)
    positions[30:35, 6] = np.nan
    positions[50:53] = np.nan
    holed = Capture(positions, 120.0, NAMES)
    (clean,) = clean_captures([holed], HEAD, allow_scale=False).captures
    assert np.isfinite(clean.positions_mm).all()
    filled, doubtful = int(FrameFlag.FILLED), int(FrameFlag.DOUBTFUL)
    assert (clean.flags[30:35, 6] == filled).all()
    assert (clean.flags[50:53] == filled | doubtful).all()  # nothing tells where the head was
    assert rms(congruent(clean.positions_mm, truth)[50:53] - truth[50:53]) < 0.3
    assert np.array_equal(holed.positions_mm, positions, equal_nan=True)


def test_progress_rises_and_may_cancel():
    captures = [recording(i, 20)[1] for i in range(4)]
    told = []
    clean_captures(captures, HEAD, allow_scale=False, progress=lambda f, w: told.append(f))
    assert told == sorted(told)
    assert 0 <= told[0] <= told[-1] <= 1

    def stop(fraction, what):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        clean_captures(captures, HEAD, allow_scale=False, progress=stop)


def test_a_recording_without_a_head_is_named():
    captures = [recording(i, 20)[1] for i in range(3)]
    blind = np.array(captures[2].positions_mm)
    blind[:, :3] = np.nan
    captures[2] = Capture(blind, 120.0, NAMES)
    with pytest.raises(MotionError, match=r"^'third': Head motion needs at least 3 head markers"):
        clean_captures(captures, HEAD, allow_scale=False, names=["first", "second", "third"])
    with pytest.raises(MotionError, match=r"^'recording 3': "):
        clean_captures(captures, HEAD, allow_scale=False)


@given(st.lists(st.booleans(), max_size=60))
def test_ranges_cover_what_is_missing_and_do_not_touch(missing):
    found = frame_ranges(np.array(missing, bool))
    covered = np.zeros(len(missing), bool)
    for first, last in found:
        assert first <= last
        covered[first : last + 1] = True
    assert covered.tolist() == missing
    assert all(b[0] > a[1] + 1 for a, b in itertools.pairwise(found))


def test_gaps_are_frames_in_which_any_marker_is_missing():
    positions = np.zeros((10, 8, 3))
    positions[2:4, 1, 0] = np.nan
    positions[3:6, 7] = np.nan
    positions[9, 0] = np.nan
    capture = Capture(positions, 120.0, NAMES)
    assert gaps(capture) == [(2, 5), (9, 9)]
    assert marker_gaps(capture) == {"head0": [(9, 9)], "head1": [(2, 3)], "lip_in6": [(3, 5)]}
    assert gaps(Capture(np.zeros((4, 8, 3)), 120.0, NAMES)) == []


def test_the_neutral_pose_is_the_median_of_the_quiet_frames_of_all_recordings():
    captures, quiet = [], []
    for level, n in ((0.0, 10), (1.0, 10), (5.0, 3)):
        positions = np.full((20, 8, 3), 99.0)
        positions[:n] = level
        captures.append(Capture(positions, 120.0, NAMES))
        quiet.append(np.arange(20) < n)
    assert (neutral_pose(captures, quiet) == 1.0).all()


def test_without_a_quiet_frame_there_is_no_neutral_pose():
    capture = recording(1, 20)[1]
    with pytest.raises(MotionError, match="no neutral pose"):
        neutral_pose([capture], [np.zeros(20, bool)])
    with pytest.raises(MotionError, match="no neutral pose"):
        neutral_pose([], [])
