from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import Fragment, FrameFlag, InputError, UnitRef
from corpus_tools.synthesis import (
    WEIGHTINGS,
    align_fragments,
    blend_pieces,
    blend_weights,
    overlap_lengths,
    render_selection,
    weighting,
)
from corpus_tools.synthesis.pieces import MARGIN_S
from tests.strategies.fragments import (
    NAMES,
    SILENCE,
    band_limited,
    make_fragment,
    make_selection,
    make_target,
    seeds,
    spliced,
)

modes = pytest.mark.parametrize("mode", ["inverse", "paper"])
rules = st.sampled_from(["shared-phone", "paper"])
blends = st.fixed_dictionaries(
    {
        "mode": st.sampled_from(["crossfade", "inertial"]),
        "weighting": st.sampled_from(list(WEIGHTINGS)),
        "shape": st.floats(-1, 1),
        "rule": rules,
    }
)


@given(seeds, st.integers(1, 6), st.sampled_from(list(WEIGHTINGS)), st.floats(-1, 1))
def test_the_weights_are_a_partition_and_at_most_two_fragments_sound_at_once(seed, n, name, shape):
    rng = np.random.default_rng(seed)
    phones = make_target(["A"] * (n + 2), rng.uniform(0.03, 0.3, n + 2)).phones.intervals
    joins = list(range(1, n + 1))
    times = np.arange(0, phones[-1].end_s, 1 / 120)
    overlaps = overlap_lengths(phones, joins, overlap_s=rng.uniform(0, 0.3))
    centres = np.array([phones[j].centre_s for j in joins])
    weights = blend_weights(times, centres, overlaps, weighting(name, shape))
    np.testing.assert_allclose(weights.sum(axis=0), 1, atol=1e-12)
    assert weights.min() >= -1e-12
    assert ((weights > 1e-12).sum(axis=0) <= 2).all()


@given(seeds)
def test_no_overlap_leaves_its_phone(seed):
    rng = np.random.default_rng(seed)
    phones = make_target(["A"] * 9, rng.uniform(0.02, 0.4, 9)).phones.intervals
    joins = [1, 2, 5, 7]
    for rule in ("shared-phone", "paper"):
        lengths = overlap_lengths(phones, joins, rule, 0.12)
        assert (lengths <= 0.12).all()
        assert (lengths > 0).all()
        assert all(length <= phones[j].duration_s for j, length in zip(joins, lengths, strict=True))


@modes
@given(seeds, blends)
def test_two_equal_fragments_blend_into_themselves(mode, seed, blend):
    """The same recording on both sides of a join: the join cannot be seen, whatever the target's timing."""
    rng = np.random.default_rng(seed)
    phones = [SILENCE, "A", "B", "C", "D", SILENCE]
    whole = make_fragment(phones, rng.uniform(0.05, 0.25, 6), band_limited(rng), first=0, context_s=2.0)
    target = make_target(phones, rng.uniform(0.05, 0.25, 6))
    cut = int(rng.integers(1, 5))
    parts = [
        Fragment(
            UnitRef("a", low, high),
            whole.phones[low : high + 1],
            whole.edges_s[low : high + 2],
            whole.times_s,
            whole.motion_mm,
            whole.flags,
        )
        for low, high in ((0, cut), (cut, 5))
    ]
    one = render_selection(make_selection([whole]), target, [whole], names=NAMES)
    two = render_selection(make_selection(parts), target, parts, names=NAMES, resampling="inverse", **blend)
    shared = target.phones.intervals[cut]
    near = np.abs(two.times_s - shared.centre_s) <= 0.5 * two.joins[0].overlap_s
    np.testing.assert_allclose(two.values_mm[near], one.values_mm[near], atol=1e-9)
    np.testing.assert_allclose(two.values_mm, one.values_mm, atol=1e-9)
    assert two.joins[0].gap_mm < 1e-9


@modes
@given(seeds, blends)
def test_a_face_that_does_not_move_does_not_move(mode, seed, blend):
    rng = np.random.default_rng(seed)
    pose = rng.normal(0, 40, (len(NAMES), 3))
    still = spliced(rng, motion=lambda k: lambda t: np.broadcast_to(pose, (len(t), *pose.shape)).copy())
    trajectory = render_selection(*still, names=NAMES, resampling=mode, **blend)
    np.testing.assert_allclose(
        trajectory.values_mm, np.broadcast_to(pose, trajectory.values_mm.shape), atol=1e-6
    )


@modes
@given(seeds, blends)
def test_an_affine_map_of_the_markers_may_be_made_before_or_after(mode, seed, blend):
    """Turned, scaled, sheared and shifted faces speak alike: everything is linear, and weights sum to 1."""
    rng = np.random.default_rng(seed)
    matrix, shift = rng.normal(0, 1, (3, 3)), rng.normal(0, 30, 3)
    selection, target, fragments = spliced(rng)
    mapped = [
        Fragment(f.unit, f.phones, f.edges_s, f.times_s, f.motion_mm @ matrix + shift, f.flags)
        for f in fragments
    ]
    before = render_selection(selection, target, mapped, names=NAMES, resampling=mode, **blend)
    after = render_selection(selection, target, fragments, names=NAMES, resampling=mode, **blend)
    np.testing.assert_allclose(before.values_mm, after.values_mm @ matrix + shift, atol=1e-5)


@given(seeds, blends)
def test_later_recordings_sound_like_earlier_ones(seed, blend):
    """The clock of the recording does not matter."""
    selection, target, fragments = spliced(np.random.default_rng(seed))
    later = [
        Fragment(f.unit, f.phones, f.edges_s + 40, f.times_s + 40, f.motion_mm, f.flags) for f in fragments
    ]
    a = render_selection(selection, target, fragments, names=NAMES, **blend)
    b = render_selection(selection, target, later, names=NAMES, **blend)
    np.testing.assert_allclose(a.values_mm, b.values_mm, atol=1e-6)


@given(seeds)
def test_one_call_is_the_two_calls(seed):
    parts = spliced(np.random.default_rng(seed))
    aligned = align_fragments(*parts, names=NAMES, rate_hz=60.0, warp="pchip", resampling="paper", c=0.25)
    two = blend_pieces(aligned, weighting="septic", shape=0.4, rule="paper", overlap_s=0.05, fraction=0.7)
    one = render_selection(
        *parts,
        names=NAMES,
        rate_hz=60.0,
        warp="pchip",
        resampling="paper",
        c=0.25,
        weighting="septic",
        shape=0.4,
        rule="paper",
        overlap_s=0.05,
        fraction=0.7,
    )
    np.testing.assert_array_equal(one.values_mm, two.values_mm)
    assert [replace(j, natural_percentile=0, peak_ratio=0) for j in one.joins] == [
        replace(j, natural_percentile=0, peak_ratio=0) for j in two.joins
    ]
    assert one.history == two.history
    assert [s.name for s in one.history] == ["align", "blend"]


@given(seeds)
def test_the_motion_begins_and_ends_at_rest(seed):
    parts = spliced(np.random.default_rng(seed))
    trajectory = render_selection(*parts, names=NAMES, rate_hz=2000.0)
    speed = np.linalg.norm(np.diff(trajectory.values_mm, axis=0), axis=2).max(axis=1)
    assert speed[0] < 0.1 * speed.max()
    assert speed[-1] < 0.1 * speed.max()


def test_a_longer_overlap_than_the_pieces_hold_is_shortened_and_reported():
    phones = ["A", "B", "C"]
    rng = np.random.default_rng(0)

    motion = band_limited(rng)

    def away(t):
        return 100 + motion(t)

    left = make_fragment(phones[:2], [0.3, 2.0], away, context_s=1.5)
    right = make_fragment(phones[1:], [2.0, 0.3], away, context_s=1.5)
    target = make_target(phones, [0.3, 2.0, 0.3])
    trajectory = render_selection(
        make_selection([left, right]), target, [left, right], names=NAMES, overlap_s=5
    )
    assert trajectory.joins[0].overlap_s == pytest.approx(2 * MARGIN_S)
    assert np.abs(trajectory.values_mm - 100).max() < 5  # never towards 0, where no fragment is


def test_no_overlap_is_a_cut_at_the_centre_of_the_shared_phone():
    selection, target, fragments = spliced(np.random.default_rng(4), n_units=2)
    aligned = align_fragments(selection, target, fragments, names=NAMES)
    cut = blend_pieces(aligned, overlap_s=0.0)
    left, right = aligned.pieces
    first = int(np.searchsorted(cut.times_s, cut.joins[0].time_s))
    np.testing.assert_array_equal(cut.values_mm[first - 1], left.motion_mm[first - 1 - left.start])
    np.testing.assert_array_equal(cut.values_mm[first], right.motion_mm[first - right.start])


def test_frames_without_captured_motion_are_doubtful_and_held():
    rng = np.random.default_rng(2)
    short = make_fragment(["A", "B", "C"], [0.2, 0.2, 0.2], band_limited(rng), context_s=0.0)
    target = make_target(["A", "B", "C"], [0.2, 0.2, 0.2])
    trajectory = render_selection(make_selection([short]), target, [short], names=NAMES)
    doubtful = (trajectory.flags[:, 0] & FrameFlag.DOUBTFUL) > 0
    slack = 0.5 / 25 + 1e-6
    source = trajectory.times_s + short.edges_s[0]
    outside = (source < short.times_s[0] - slack) | (source > short.times_s[-1] + slack)
    np.testing.assert_array_equal(doubtful, outside)
    assert doubtful.any()
    held = trajectory.values_mm[source > short.times_s[-1]]
    np.testing.assert_allclose(held, np.broadcast_to(short.motion_mm[-1], held.shape), atol=1e-9)


def test_flags_of_the_captured_frames_are_carried_over():
    selection, target, fragments = spliced(np.random.default_rng(6), n_units=2)
    flags = fragments[0].flags.copy()
    flags[:, 1] = FrameFlag.FILLED
    first = fragments[0]
    filled = Fragment(first.unit, first.phones, first.edges_s, first.times_s, first.motion_mm, flags)
    trajectory = render_selection(selection, target, [filled, fragments[1]], names=NAMES)
    (join,) = trajectory.joins
    before = trajectory.times_s < join.time_s - 0.5 * join.overlap_s
    after = trajectory.times_s > join.time_s + 0.5 * join.overlap_s
    assert (trajectory.flags[before, 1] & FrameFlag.FILLED).all()
    assert not (trajectory.flags[after, 1] & FrameFlag.FILLED).any()
    assert not (trajectory.flags[:, 0] & FrameFlag.FILLED).any()


def test_what_cannot_be_is_refused():
    aligned = align_fragments(*spliced(np.random.default_rng(1)), names=NAMES)
    with pytest.raises(InputError, match="no overlap rule 'phone'"):
        blend_pieces(aligned, rule="phone")
    with pytest.raises(InputError, match=r"longest overlap is -0\.1 s"):
        blend_pieces(aligned, overlap_s=-0.1)
    with pytest.raises(InputError, match="no weighting function"):
        blend_pieces(aligned, weighting="line")
