"""Head motion: what is rigid goes, what slips is doubted, what is missing is bridged, nothing is mirrored."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from corpus_tools.cleaning import estimate_head_motion, reference_shape, remove_head_motion
from corpus_tools.core import Capture, FrameFlag, MotionError

NAMES = (*(f"head{i}" for i in range(7)), "chin0", "lip_in2")
HEAD = list(range(7))
SHAPE = np.array(
    [[-60, 40, 10], [60, 42, 8], [-40, 80, 20], [42, 78, 25], [0, 90, 40], [-70, 0, -20], [68, -3, -25.0]]
)
REFERENCE = np.concatenate([SHAPE - SHAPE.mean(0), [[0.0, -110.0, 20.0], [0.0, -80.0, 35.0]]])
SEEDS = st.integers(0, 100_000)


def pose(seed, n=20, scale_sd=0.0):
    """Return random rotations, translations and scales of a head."""
    random = np.random.default_rng(seed)
    turns = Rotation.from_rotvec(random.normal(scale=0.4, size=(n, 3))).as_matrix()
    return turns, random.normal(scale=80.0, size=(n, 3)), np.exp(random.normal(scale=scale_sd, size=n))


def placed(shape, turns, shifts, scales):
    """Return a shape, or one shape a frame, as a camera would see it in every pose."""
    return (np.asarray(shape) @ turns) / scales[:, None, None] + shifts[:, None]


def talking(seed, n=20):
    """Return frames of the face in its own space: the head still, chin and lip moving."""
    face = np.repeat(REFERENCE[None], n, axis=0)
    face[:, 7:] += np.random.default_rng(seed + 1).normal(scale=4.0, size=(n, 2, 3))
    return face


@given(SEEDS)
def test_the_motion_of_a_rigid_head_vanishes(seed):
    face, motion = talking(seed), pose(seed)
    found = estimate_head_motion(placed(face, *motion), REFERENCE, HEAD, allow_scale=False)
    assert np.abs(found.stabilise(placed(face, *motion)) - face).max() < 1e-9
    assert found.residual_mm.max() < 1e-9
    assert (found.scale == 1).all()
    assert np.abs(found.rotation - motion[0]).max() < 1e-12
    assert np.abs(found.translation_mm - motion[1]).max() < 1e-9


@given(SEEDS)
def test_with_scale_the_distance_to_the_camera_vanishes_too(seed):
    face, motion = talking(seed), pose(seed, scale_sd=0.05)
    found = estimate_head_motion(placed(face, *motion), REFERENCE, HEAD, allow_scale=True)
    assert np.abs(found.stabilise(placed(face, *motion)) - face).max() < 1e-9
    assert found.scale == pytest.approx(motion[2], rel=1e-10)


def test_without_scale_the_size_stays():
    face, motion = talking(1), pose(1, scale_sd=0.05)
    found = estimate_head_motion(placed(face, *motion), REFERENCE, HEAD, allow_scale=False)
    stable = found.stabilise(placed(face, *motion))
    width = np.linalg.norm(stable[:, 0] - stable[:, 1], axis=1)
    assert width * motion[2] == pytest.approx(np.linalg.norm(SHAPE[0] - SHAPE[1]))


@given(SEEDS, st.booleans())
def test_another_camera_changes_nothing(seed, allow_scale):
    """The stabilised face is the same wherever the captured space has its origin and axes."""
    random = np.random.default_rng(seed)
    seen = placed(talking(seed), *pose(seed)) + random.normal(scale=0.5, size=(20, 9, 3))
    turn = Rotation.from_rotvec(random.normal(size=3)).as_matrix()
    moved = seen @ turn + random.normal(scale=300, size=3)
    one = estimate_head_motion(seen, REFERENCE, HEAD, allow_scale).stabilise(seen)
    other = estimate_head_motion(moved, REFERENCE, HEAD, allow_scale).stabilise(moved)
    assert np.abs(one - other).max() < 1e-8


@given(SEEDS, st.booleans(), st.sampled_from(["noise", "flat", "mirrored"]))
def test_a_fit_is_never_a_reflection(seed, allow_scale, kind):
    random = np.random.default_rng(seed)
    reference = REFERENCE.copy()
    if kind == "noise":
        seen = random.normal(scale=30, size=(30, 9, 3))
    else:
        reference[:, 2] = 0.0 if kind == "flat" else reference[:, 2]
        seen = placed(reference * [1, 1, -1], *pose(seed, 30)) + random.normal(scale=0.3, size=(30, 9, 3))
    found = estimate_head_motion(seen, reference, HEAD, allow_scale)
    assert np.linalg.det(found.rotation) == pytest.approx(1.0)
    assert (found.scale > 0).all()


@given(SEEDS, st.sampled_from(HEAD))
def test_one_marker_that_slips_loses_its_say(seed, marker):
    face, motion = talking(seed), pose(seed)
    slipped = face.copy()
    slipped[10:, marker] += [4.0, -3.0, 5.0]
    seen = placed(slipped, *motion)
    robust = estimate_head_motion(seen, REFERENCE, HEAD, allow_scale=False)
    plain = estimate_head_motion(seen, REFERENCE, HEAD, allow_scale=False, cutoff_mm=1e6)
    error = np.abs(robust.stabilise(seen) - face)[:, 7:].max(axis=(1, 2))
    assert error[:10].max() < 1e-9
    assert error[10:].max() < 0.15
    assert np.abs(plain.stabilise(seen) - face)[10:, 7:].max() > 8 * error[10:].max()


@given(SEEDS, st.booleans())
def test_missing_head_markers_have_no_weight(seed, allow_scale):
    face, motion = talking(seed), pose(seed)
    seen = placed(face, *motion)
    random = np.random.default_rng(seed)
    for frame in range(20):
        seen[frame, random.permutation(7)[: random.integers(0, 4)]] = np.nan
    found = estimate_head_motion(seen, REFERENCE, HEAD, allow_scale)
    assert found.fitted.all()
    assert np.abs(found.stabilise(seen)[:, 7:] - face[:, 7:]).max() < 1e-8


def steadily_turning(n=11):
    turns = Rotation.from_rotvec(np.linspace(0, 0.5, n)[:, None] * [0.0, 1.0, 0.2]).as_matrix()
    return turns, np.linspace(0, 30, n)[:, None] * [1.0, 2.0, 3.0], np.linspace(1.0, 1.1, n)


@pytest.mark.parametrize("left", [0, 2])
def test_frames_with_too_few_head_markers_lie_between_their_neighbours(left):
    motion = steadily_turning()
    face = talking(3, 11)
    seen = placed(face, *motion)
    seen[4:8, left:7] = np.nan
    found = estimate_head_motion(seen, REFERENCE, HEAD, allow_scale=True)
    assert list(np.flatnonzero(~found.fitted)) == [4, 5, 6, 7]
    assert np.abs(found.rotation - motion[0]).max() < 1e-9
    assert np.abs(found.translation_mm - motion[1]).max() < 1e-9
    assert np.isnan(found.residual_mm[4:8]).all()
    assert np.isfinite(found.residual_mm[:4]).all()


def test_head_markers_on_one_line_are_too_few():
    motion = steadily_turning()
    reference = REFERENCE.copy()
    reference[:3] = [[-50, 10, 0], [0, 10, 0], [50, 10, 0]]
    seen = placed(np.repeat(reference[None], 11, 0), *motion)
    seen[5, 3:7] = np.nan
    found = estimate_head_motion(seen, reference, HEAD, allow_scale=False)
    assert list(np.flatnonzero(~found.fitted)) == [5]


@pytest.mark.parametrize("lost", [slice(0, 3), slice(8, 11), slice(1, 11)])
def test_frames_at_the_ends_take_the_nearest_pose(lost):
    seen = placed(REFERENCE, *steadily_turning())
    seen[lost, :7] = np.nan
    found = estimate_head_motion(seen, REFERENCE, HEAD, allow_scale=False)
    kept = np.flatnonzero(found.fitted)
    for frame in np.flatnonzero(~found.fitted):
        nearest = kept[np.argmin(np.abs(kept - frame))]
        assert found.rotation[frame] == pytest.approx(found.rotation[nearest])
        assert found.translation_mm[frame] == pytest.approx(found.translation_mm[nearest])


def test_a_head_that_is_never_seen_is_refused():
    seen = placed(REFERENCE, *pose(1))
    seen[:, :5] = np.nan
    with pytest.raises(MotionError, match="at least 3 head markers"):
        estimate_head_motion(seen, REFERENCE, HEAD, allow_scale=False)
    with pytest.raises(MotionError, match="at least 3 head markers"):
        estimate_head_motion(placed(REFERENCE, *pose(1)), REFERENCE, [0, 1], allow_scale=False)


def test_a_capture_keeps_its_flags_and_says_what_was_done():
    face = talking(5, 11)
    seen = placed(face, *steadily_turning())
    seen[4:6, :7] = np.nan
    capture = Capture(seen, 120.0, NAMES)
    stable, motion = remove_head_motion(capture, REFERENCE, HEAD, allow_scale=True)
    doubtful = int(FrameFlag.DOUBTFUL)
    assert (stable.flags[4:6] & doubtful == doubtful).all()
    assert (np.delete(stable.flags, [4, 5], axis=0) == int(FrameFlag.MEASURED)).all()
    assert (stable.flags[4:6, 7:] & int(FrameFlag.MEASURED)).all()
    assert np.isnan(stable.positions_mm[4:6, :7]).all()
    assert np.abs(stable.positions_mm[:, 7:] - face[:, 7:]).max() < 1e-8
    said = dict(stable.history[-1].settings)
    assert (stable.history[-1].name, said["fit"]) == ("remove_head_motion", "similarity")
    assert len(motion.scale) == 11
    assert (capture.flags & doubtful == 0).all()


@given(SEEDS, st.booleans())
def test_the_reference_of_a_corpus_is_its_mean_face(seed, allow_scale):
    """Whatever the poses, the head of the reference is congruent to the head that was captured."""
    captures = [
        Capture(placed(talking(seed + i, 40), *pose(seed + i, 40)), 120.0, NAMES) for i in range(0, 12, 4)
    ]
    found = reference_shape(captures, HEAD, allow_scale)
    assert np.abs(found[HEAD].mean(0)).max() < 1e-9
    distances = np.linalg.norm(found[:7, None] - found[None, :7], axis=2)
    wanted = np.linalg.norm(SHAPE[:, None] - SHAPE[None], axis=2)
    ratio = (distances / np.where(wanted > 0, wanted, np.inf))[wanted > 0]
    assert ratio.std() < 2e-3
    assert ratio.mean() == pytest.approx(1.0, abs=2e-3)


def test_the_reference_bears_markers_that_are_never_seen():
    seen = placed(talking(9, 30), *pose(9, 30))
    seen[:, 8] = np.nan
    found = reference_shape([Capture(seen, 120.0, NAMES)], HEAD, allow_scale=False)
    assert np.isnan(found[8]).all()
    assert np.isfinite(found[:8]).all()


def test_a_long_recording_does_not_outvote_the_others():
    """Two recordings of 40 frames with the chin low and one of 2000 with the chin high: the chin is low."""
    low, high = REFERENCE.copy(), REFERENCE.copy()
    low[7, 1] -= 10.0
    still = (np.eye(3)[None], np.zeros((1, 3)), np.ones(1))
    captures = [
        Capture(np.repeat(placed(shape, *still), n, 0), 120.0, NAMES)
        for shape, n in ((low, 40), (high, 2000), (low, 40))
    ]
    assert reference_shape(captures, HEAD, False)[7, 1] == pytest.approx(low[7, 1])


def test_a_corpus_without_a_whole_head_is_refused():
    seen = placed(REFERENCE, *pose(1))
    seen[:10, 0], seen[10:, 1] = np.nan, np.nan
    with pytest.raises(MotionError, match="all head markers together"):
        reference_shape([Capture(seen, 120.0, NAMES)], HEAD, allow_scale=False)
