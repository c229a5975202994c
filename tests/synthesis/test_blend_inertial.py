import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import FrameFlag, InputError
from corpus_tools.synthesis import align_fragments, blend_pieces, join_inertially
from corpus_tools.synthesis.inertial import quintic_decay
from tests.strategies.fragments import NAMES, make_fragment, make_selection, make_target, seeds, spliced

lengths = st.floats(0.02, 0.3)


def pieces(seed, n_units=3, rate_hz=120.0):
    return align_fragments(
        *spliced(np.random.default_rng(seed), n_units=n_units), names=NAMES, rate_hz=rate_hz
    )


def captured(aligned):
    """Return the motion of the fragment that speaks in each frame, cut at the joins."""
    cuts = [0, *(round(t * aligned.rate_hz) for t in aligned.join_times_s), len(aligned.times_s)]
    parts = [
        p.motion_mm[a - p.start : b - p.start]
        for p, a, b in zip(aligned.pieces, cuts[:-1], cuts[1:], strict=True)
    ]
    return np.concatenate(parts)


@given(st.floats(0.01, 1))
def test_offsets_of_all_three_orders_die_away_and_do_not_disturb_each_other(length):
    """Row k starts with its own derivative 1 and the others 0, and ends with all three 0."""
    h = 1e-4
    weights = quintic_decay(np.arange(4) * h * length, length)
    end = quintic_decay((1 - np.arange(4) * h) * length, length)
    units = length ** np.arange(3)[:, None]
    for values, expected in ((weights, np.eye(3)), (end, np.zeros((3, 3)))):
        x = values / units
        slope = (-11 * x[:, 0] + 18 * x[:, 1] - 9 * x[:, 2] + 2 * x[:, 3]) / (6 * h)
        bend = (2 * x[:, 0] - 5 * x[:, 1] + 4 * x[:, 2] - x[:, 3]) / h**2
        np.testing.assert_allclose(np.stack([x[:, 0], slope, bend], axis=1), expected, atol=2e-5)
    np.testing.assert_array_equal(quintic_decay(np.array([1.0, 1.7]) * length, length), 0)


@given(seeds, st.floats(0.08, 0.3))
def test_the_acceleration_goes_on_through_every_join(seed, length):
    """C2: accelerations on both sides of a join, each from its own side, meet; a mere C1 leaves the gap."""
    rate = 8000.0
    aligned = pieces(seed, rate_hz=rate)
    motion = join_inertially(aligned, length).values_mm
    for join in _joins(aligned):
        k = round(join.time_s * rate)
        before, after = motion[k - 1 :: -1][:5], motion[k:][:5]
        first, second = ((2 * s[0] - 5 * s[1] + 4 * s[2] - s[3]) * rate**2 for s in (before, after))
        jump = np.sqrt(((first - second) ** 2).sum(axis=1).mean())
        assert jump < 0.1 * join.gap_mm_s2 + 10


def _joins(aligned):
    return blend_pieces(aligned).joins


@given(seeds, lengths)
def test_both_fragments_meet_midway(seed, length):
    aligned = pieces(seed, n_units=2)
    cut = round(float(aligned.join_times_s[0]) * aligned.rate_hz)
    left, right = (p.motion_mm[cut - p.start] for p in aligned.pieces)
    motion = join_inertially(aligned, length)
    np.testing.assert_allclose(motion.values_mm[cut], 0.5 * (left + right), atol=1e-9)
    assert motion.deviation_mm[cut] == pytest.approx(0.5 * _joins(aligned)[0].gap_mm)


@given(seeds, lengths)
def test_away_from_the_joins_every_frame_is_as_captured(seed, length):
    aligned = pieces(seed)
    motion = join_inertially(aligned, length)
    distance = np.abs(aligned.times_s[:, None] - aligned.join_times_s).min(axis=1)
    free = distance > length + 1.5 / aligned.rate_hz
    np.testing.assert_array_equal(motion.values_mm[free], captured(aligned)[free])
    np.testing.assert_array_equal(motion.deviation_mm[free], 0)
    assert (motion.reach_s <= 2 * length + 1e-9).all()
    np.testing.assert_allclose(motion.values_mm[[0, -1]], captured(aligned)[[0, -1]], atol=1e-9)


@given(seeds)
def test_the_deviation_is_the_distance_from_the_captured_motion(seed):
    aligned = pieces(seed)
    trajectory = blend_pieces(aligned, mode="inertial")
    difference = trajectory.values_mm - captured(aligned)
    expected = np.sqrt((difference**2).sum(axis=2).mean(axis=1)).max()
    step = trajectory.history[-1].as_dict()
    assert step["deviation_mm"] == pytest.approx(expected, abs=1e-4)
    assert (step["mode"], step["inertial_s"]) == ("inertial", 0.12)
    assert "weighting" not in step


@given(seeds)
def test_the_gaps_are_those_of_the_cross_fade(seed):
    aligned = pieces(seed)
    both = [blend_pieces(aligned, mode=m).joins for m in ("crossfade", "inertial")]
    assert len(both[1]) == 2
    for one, two in zip(*both, strict=True):
        assert (one.gap_mm, one.gap_mm_s, one.gap_mm_s2) == (two.gap_mm, two.gap_mm_s, two.gap_mm_s2)
        assert two.overlap_s <= 0.24 + 1e-9


def test_a_step_between_still_fragments_dies_away_by_half_on_each_side():
    still = [lambda t, x=x: np.full((len(t), len(NAMES), 3), x) for x in (1.0, 4.0)]
    left = make_fragment(["A", "B"], [0.4, 0.4], still[0], context_s=0.6)
    right = make_fragment(["B", "C"], [0.4, 0.4], still[1], context_s=0.6)
    target = make_target(["A", "B", "C"], [0.4, 0.4, 0.4])
    aligned = align_fragments(
        make_selection([left, right]), target, [left, right], names=NAMES, rate_hz=1000.0
    )
    motion = join_inertially(aligned, 0.1)
    x = np.clip(np.abs(aligned.times_s - 0.6) / 0.1, 0, 1)
    rest = 1.5 * (1 - 10 * x**3 + 15 * x**4 - 6 * x**5)
    expected = np.where(aligned.times_s < 0.6 - 1e-9, 1 + rest, 4 - rest)
    np.testing.assert_allclose(motion.values_mm[:, 0, 0], expected, atol=1e-6)


def test_flags_are_those_of_the_fragment_that_speaks():
    aligned = pieces(6, n_units=2)
    for piece, flag in zip(aligned.pieces, (FrameFlag.FILLED, FrameFlag.MEASURED), strict=True):
        piece.flags[:] = flag
    flags = join_inertially(aligned).flags
    cut = round(float(aligned.join_times_s[0]) * aligned.rate_hz)
    assert (flags[:cut] == FrameFlag.FILLED).all()
    assert (flags[cut:] == FrameFlag.MEASURED).all()


def test_what_cannot_be_is_refused():
    aligned = pieces(1)
    for length in (0.0, -0.1, 0.31, np.nan):
        with pytest.raises(InputError, match=r"dies away in .* more than 0 and at most 0.3 s"):
            blend_pieces(aligned, mode="inertial", inertial_s=length)
    with pytest.raises(InputError, match=r"no blend mode 'inert'\. Known: crossfade, inertial"):
        blend_pieces(aligned, mode="inert")
