"""Paper A section 5.1.3, "Blending Motions", and figure 3, "Example weighting functions"."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.synthesis import (
    WEIGHTINGS,
    align_fragments,
    blend_pieces,
    blend_weights,
    overlap_lengths,
    rms_acceleration,
    weighting,
)
from tests.strategies.fragments import NAMES, band_limited, make_target, own_clock, seeds, spliced

weights = st.lists(st.floats(0, 5), min_size=4, max_size=20).filter(any)
durations = st.lists(st.floats(0.02, 0.4), min_size=4, max_size=30)
DECAY = ("exponential", "sigmoid", "septic", "bump", "smootherstep", "raised-cosine", "smoothstep", "user")
DECAY += ("linear",)


def test_figure_3_the_weighting_functions_are_different_curves():
    u = np.linspace(0, 1, 101)
    for a, b in itertools.combinations(WEIGHTINGS, 2):
        assert np.abs(weighting(a)(u) - weighting(b)(u)).max() > 0.005, (a, b)


def test_the_speed_of_decay_says_how_fast_the_second_fragment_is_faded_in():
    u = np.linspace(0, 1, 10_001)
    steepest = [np.abs(np.diff(weighting(name)(u))).max() for name in DECAY]
    assert set(DECAY) == set(WEIGHTINGS)
    assert steepest == sorted(steepest, reverse=True)
    exponential, linear = weighting("exponential")(u), weighting("linear")(u)
    assert (exponential[1:-1] < linear[1:-1]).all()


@given(seeds, st.sampled_from([*WEIGHTINGS]), weights)
def test_equation_2_blends_two_fragments_by_g_of_u(seed, name, curve_weights):
    """theta_blend = g(u) theta_0 + (1 - g(u)) theta_1 with u from 0 to 1 over the overlap, for any g."""
    aligned = align_fragments(*spliced(np.random.default_rng(seed), n_units=2), names=NAMES)
    trajectory = blend_pieces(aligned, weighting=name, curve_weights=curve_weights)
    (join,), (left, right) = trajectory.joins, aligned.pieces
    u = (trajectory.times_s - join.time_s) / join.overlap_s + 0.5
    inside = np.flatnonzero((u >= 0) & (u <= 1))
    g = weighting(name, curve_weights=curve_weights)(u[inside])[:, None, None]
    theta_0, theta_1 = left.motion_mm[inside - left.start], right.motion_mm[inside - right.start]
    np.testing.assert_allclose(trajectory.values_mm[inside], g * theta_0 + (1 - g) * theta_1, atol=1e-9)


@given(durations, st.floats(0.05, 1), st.floats(0, 0.5))
def test_the_overlap_is_always_a_fraction_of_the_smallest_phone_interval(seconds, fraction, longest):
    phones = make_target(["A"] * len(seconds), seconds).phones.intervals
    joins = range(1, len(seconds) - 1)
    lengths = overlap_lengths(phones, joins, "paper", longest, fraction)
    smallest = min(p.duration_s for p in phones)
    assert (lengths <= fraction * smallest + 1e-12).all()
    assert (lengths >= min(longest, fraction * smallest) - 1e-12).all()


@given(durations)
def test_at_30_frames_a_second_a_couple_of_frames_overlap_and_at_120_four_times_as_many(seconds):
    """As long as the utterance has one phone of 120 ms or less, which speech always has."""
    seconds = [*seconds, 0.12]
    phones = make_target(["A"] * len(seconds), seconds).phones.intervals
    joins = list(range(1, len(seconds) - 1))
    lengths = overlap_lengths(phones, joins, "paper")
    for j, length in zip(joins, lengths, strict=True):
        t0, t1 = phones[j].centre_s - length / 2, phones[j].centre_s + length / 2
        slow, fast = (np.floor(t1 * r) - np.ceil(t0 * r) + 1 for r in (30, 120))
        assert slow <= 2
        assert fast >= 4 * (slow - 1)


@given(seeds)
def test_only_the_overlapping_regions_are_blended(seed):
    selection, target, fragments = spliced(np.random.default_rng(seed))
    aligned = align_fragments(selection, target, fragments, names=NAMES)
    trajectory = blend_pieces(aligned, rule="paper")
    times = trajectory.times_s
    free = np.ones(len(times), bool)
    for join in trajectory.joins:
        free &= np.abs(times - join.time_s) > 0.5 * join.overlap_s
    owner = np.searchsorted(aligned.join_times_s, times)
    for k, piece in enumerate(aligned.pieces):
        alone = np.flatnonzero(free & (owner == k))
        np.testing.assert_array_equal(trajectory.values_mm[alone], piece.motion_mm[alone - piece.start])


@given(seeds)
def test_a_small_degree_of_context_is_enough(seed):
    """Fragments with motion half an overlap (60 ms and a frame) beyond the shared phones need no more."""
    selection, target, fragments = spliced(np.random.default_rng(seed), motion=lambda k: own_clock)
    trajectory = blend_pieces(align_fragments(selection, target, fragments, names=NAMES))
    inside = (trajectory.times_s > 0.15) & (trajectory.times_s < target.duration_s - 0.15)
    assert ((trajectory.flags[inside] & 4) == 0).all()


PEAKS = [  # overlap in ms -> times the natural peak acceleration: linear, cosine, smootherstep, exponential
    (17, 10.8, 6.2, 7.4, 39.5),
    (33, 5.2, 1.8, 2.1, 19.0),
    (66, 2.5, 1.0, 1.0, 9.5),
]


def peak_acceleration(overlap_s, name, rate_hz=480.0):
    """Median over simulated joins of the peak acceleration, as a ratio to that of the natural motion."""
    times = np.arange(0, 1, 1 / rate_hz)
    near = np.abs(times - 0.5) < 0.15
    ratios = []
    for seed in range(10):
        rng = np.random.default_rng(seed)
        natural = 2.8 * np.sqrt(2) / 2 * band_limited(rng, high_hz=6.0)(times)
        offset = rng.normal(0, 0.5, natural.shape[1:])
        weights = blend_weights(times, np.array([0.5]), np.array([overlap_s]), weighting(name))
        blended = natural + weights[1][:, None, None] * offset
        ratios.append(
            rms_acceleration(blended, rate_hz)[near].max() / rms_acceleration(natural, rate_hz)[near].max()
        )
    return np.median(ratios)


@pytest.mark.parametrize(("ms", "linear", "cosine", "smootherstep", "exponential"), PEAKS)
def test_peak_acceleration_of_the_weightings(ms, linear, cosine, smootherstep, exponential):
    """Simulated joins: kinks of g cost most; the smoothest g is not always the calmest. Our measurement."""
    names = ("linear", "raised-cosine", "smootherstep", "exponential")
    seen = {name: peak_acceleration(ms / 1000, name) for name in names}
    expected = dict(zip(names, (linear, cosine, smootherstep, exponential), strict=True))
    assert seen == {name: pytest.approx(ratio, rel=0.25) for name, ratio in expected.items()}
    assert seen["exponential"] > seen["linear"] > seen["smootherstep"] >= 0.98 * seen["raised-cosine"]


@pytest.mark.parametrize("name", ["linear", "raised-cosine", "smootherstep", "exponential"])
def test_a_longer_overlap_calms_every_weighting(name):
    short, middle, long = (peak_acceleration(ms / 1000, name) for ms in (17, 33, 66))
    assert short > middle > long
    assert short > 2 * long
