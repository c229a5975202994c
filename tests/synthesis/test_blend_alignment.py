import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.synthesis import TimeWarp, fragment_warp
from corpus_tools.synthesis.alignment import HOLD_EASE_S, rest_clock
from tests.strategies.fragments import SILENCE, make_fragment, make_target, own_clock, seeds

kinds = pytest.mark.parametrize("kind", ["linear", "pchip"])


def draw_warp(seed, kind, silent=False):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 9))
    phones = [f"P{i}" for i in range(n)]
    if silent:
        phones[0] = phones[-1] = SILENCE
    fragment = make_fragment(phones, rng.uniform(0.03, 0.4, n), own_clock)
    target = make_target(phones, rng.uniform(0.03, 0.4, n))
    return fragment, target.phones.intervals, fragment_warp(fragment, target.phones.intervals, kind)


@kinds
@given(seeds)
def test_every_edge_and_centre_of_the_source_lands_on_the_targets(kind, seed):
    fragment, spoken, warp = draw_warp(seed, kind)
    target = [t for p in spoken for t in (p.start_s, p.centre_s)] + [spoken[-1].end_s]
    source = np.sort(np.concatenate([fragment.edges_s, fragment.centres_s]))
    np.testing.assert_allclose(warp.to_source(np.array(target)), source, atol=1e-12)
    np.testing.assert_allclose(warp.to_target(source), target, atol=1e-12)


@kinds
@given(seeds)
def test_the_clock_never_stops_and_runs_freely_outside(kind, seed):
    _, spoken, warp = draw_warp(seed, kind)
    times = np.linspace(-0.5, spoken[-1].end_s + 0.5, 997)
    asked = warp.to_source(times)
    assert (np.diff(asked) > 0).all()
    outside = (times < 0) | (times > spoken[-1].end_s)
    slopes = np.diff(asked)[outside[1:] & outside[:-1]] / np.diff(times)[0]
    np.testing.assert_allclose(slopes, 1, atol=1e-9)
    np.testing.assert_allclose(warp.to_target(asked), times, atol=1e-9)


@given(seeds)
def test_the_cubic_clock_has_no_jump_of_speed_at_a_label(seed):
    _, _, warp = draw_warp(seed, "pchip")
    inner = warp.target_s[1:-1]
    h = 1e-6
    before = (warp.to_source(inner) - warp.to_source(inner - h)) / h
    after = (warp.to_source(inner + h) - warp.to_source(inner)) / h
    np.testing.assert_allclose(before, after, rtol=1e-2, atol=1e-3)


@kinds
@given(seeds)
def test_outer_silence_is_not_stretched_and_speech_edges_are_kept(kind, seed):
    fragment, spoken, warp = draw_warp(seed, kind, silent=True)
    speech = np.array([spoken[0].end_s, spoken[-1].start_s])
    np.testing.assert_allclose(warp.to_source(speech), fragment.edges_s[[1, -2]], atol=1e-12)
    silence = np.linspace(spoken[-1].start_s, spoken[-1].end_s + 0.6, 500)
    asked = warp.to_source(silence)
    slopes = np.diff(asked) / np.diff(silence)
    assert slopes.max() <= 1 + 1e-9
    assert slopes.min() >= -1e-9
    free = silence[1:] - speech[1] < warp.hold_after_s - fragment.edges_s[-2] - HOLD_EASE_S
    np.testing.assert_allclose(slopes[free], 1, atol=1e-9)
    assert asked[-1] == pytest.approx(warp.hold_after_s)
    assert warp.hold_after_s <= max(fragment.times_s[-1], fragment.edges_s[-2]) + 1e-12


@given(seeds)
def test_the_clock_slows_down_to_a_hold_without_a_jump(seed):
    _, spoken, warp = draw_warp(seed, "linear", silent=True)
    for side in (
        np.linspace(-0.8, spoken[0].end_s - 1e-9, 20_001),
        spoken[-1].start_s + np.linspace(1e-9, 0.8, 20_001),
    ):
        slopes = np.diff(warp.to_source(side)) / np.diff(side)
        assert np.abs(np.diff(slopes)).max() < 0.02


def test_silence_in_the_middle_of_a_recording_is_held_at_its_centre():
    fragment = make_fragment([SILENCE, "A", "B"], [0.3, 0.1, 0.1], own_clock, first=4)
    target = make_target([SILENCE, "A", "B"], [1.0, 0.1, 0.1])
    warp = fragment_warp(fragment, target.phones.intervals)
    assert warp.to_source(np.array([0.0]))[0] == pytest.approx(fragment.centres_s[0])
    for context_s in (0.1, 0.4):  # captured from within the silence, or from before it
        own = make_fragment([SILENCE, "A", "B"], [0.3, 0.1, 0.1], own_clock, first=0, context_s=context_s)
        at_start = fragment_warp(own, target.phones.intervals).to_source(np.array([0.0]))[0]
        assert at_start == pytest.approx(max(own.edges_s[0], own.times_s[0]))


@kinds
@given(st.lists(st.sampled_from([1e-5, 1e-4, 0.002, 0.05, 0.3]), min_size=3, max_size=8), seeds)
def test_phones_of_no_length_do_no_harm(kind, durations, seed):
    rng = np.random.default_rng(seed)
    phones = [f"P{i}" for i in range(len(durations))]
    fragment = make_fragment(phones, durations, own_clock)
    target = make_target(phones, rng.permutation(durations))
    warp = fragment_warp(fragment, target.phones.intervals, kind)
    asked = warp.to_source(np.linspace(0, target.duration_s, 300))
    assert np.isfinite(asked).all()
    assert (np.diff(asked) > 0).all()
    assert min(np.diff(warp.source_s).min(initial=1), np.diff(warp.target_s).min(initial=1)) >= 1e-3


def test_the_identity_is_the_identity():
    knots = np.array([0.1, 0.4, 0.5])
    times = np.linspace(-1, 2, 50)
    for kind in ("linear", "pchip"):
        np.testing.assert_allclose(TimeWarp(knots, knots, kind).to_source(times), times, atol=1e-12)


@given(st.floats(0.01, 0.2), st.floats(0.01, 0.2))
def test_the_rest_clock_starts_and_stops_gently_and_is_true_between(lead, tail):
    times = np.linspace(0, 1, 100_001)
    clock = rest_clock(times, 1.0, lead, tail)
    assert clock[0] == 0
    assert clock[-1] == pytest.approx(1)
    slopes = np.diff(clock) / np.diff(times)
    assert slopes.min() >= -1e-9
    assert slopes[0] < 0.01
    assert slopes[-1] < 0.01
    assert np.abs(np.diff(slopes)).max() < 0.01
    between = (times >= lead) & (times <= 1 - tail)
    np.testing.assert_array_equal(clock[between], times[between])
