"""Motion starts and ends in the neutral pose, smoothly, and speech is left alone."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import Interval, Trajectory
from corpus_tools.synthesis import rest_at_ends

NEUTRAL = np.random.default_rng(0).normal(0, 30, (5, 3))
NAMES = ("a", "b", "c", "d", "e")


def phones(lead_s, speech_s, tail_s):
    edges = np.cumsum([0.0, lead_s, speech_s / 2, speech_s / 2, tail_s])
    texts = ("SIL", "M", "AY", "SIL")
    return tuple(
        Interval(float(a), float(b), t) for a, b, t in zip(edges[:-1], edges[1:], texts, strict=True)
    )


def moving(rows, rate_hz, seed):
    """Return a smooth motion far from the neutral pose at both ends."""
    rng = np.random.default_rng(seed)
    times = np.arange(int(np.floor(rows[-1].end_s * rate_hz + 1e-6)) + 1) / rate_hz
    waves = sum(
        rng.normal(0, 3, (5, 3))[None] * np.sin(2 * np.pi * f * times + rng.uniform(0, 6))[:, None, None]
        for f in (0.7, 2.0, 4.0)
    )
    return Trajectory(times, NEUTRAL + rng.normal(0, 5, (5, 3)) + waves, NAMES)


silences = st.floats(0.02, 1.5)


@given(silences, st.floats(0.2, 2.0), silences, st.floats(0.05, 1.0), st.integers(0, 99))
def test_the_ends_are_neutral_and_speech_is_untouched(lead_s, speech_s, tail_s, ease_s, seed):
    rows = phones(lead_s, speech_s, tail_s)
    before = moving(rows, 120.0, seed)
    after = rest_at_ends(before, rows, neutral_mm=NEUTRAL, silence="SIL", ease_s=ease_s)
    times, was, now = before.times_s, np.asarray(before.values_mm), np.asarray(after.values_mm)
    np.testing.assert_allclose(now[0], NEUTRAL, atol=1e-6)
    np.testing.assert_allclose(now[-1], NEUTRAL, atol=1e-6)
    speech = (times >= rows[1].start_s) & (times <= rows[-2].end_s)
    assert (now[speech] == was[speech]).all()
    early, late = times <= rows[1].start_s - ease_s, times >= rows[-2].end_s + ease_s
    assert (now[early | late] == NEUTRAL).all(), "what a source does in silence before that is not shown"
    assert np.abs(now - NEUTRAL).max() <= np.abs(was - NEUTRAL).max() + 1e-9, "never beyond the motion"
    assert after.names == before.names
    assert after.history[-1].name == "rest_at_ends"


@given(st.floats(0.1, 1.0), st.floats(0.1, 1.0), st.integers(0, 99))
def test_position_and_velocity_never_jump(lead_s, tail_s, seed):
    """On clocks 4 times as fine every jump of velocity becomes 4 times as small: the motion is C1."""
    rows = phones(lead_s, 0.5, tail_s)
    largest, first_speed = [], []
    for rate_hz in (500.0, 2000.0):
        after = rest_at_ends(moving(rows, rate_hz, seed), rows, neutral_mm=NEUTRAL, silence="SIL")
        velocity = np.diff(np.asarray(after.values_mm), axis=0) * rate_hz
        largest.append(np.abs(np.diff(velocity, axis=0)).max())
        first_speed.append(max(np.abs(velocity[0]).max(), np.abs(velocity[-1]).max()))
    assert largest[1] < 0.4 * largest[0]
    assert first_speed[1] < 0.5 * first_speed[0] + 1e-6, "at rest: the speed at both ends is 0"


def test_an_end_that_is_not_silent_and_no_ease_change_nothing():
    rows = phones(0.3, 0.6, 0.3)
    before = moving(rows, 120.0, 1)
    same = rest_at_ends(before, rows, neutral_mm=NEUTRAL, silence="SIL", ease_s=0.0)
    assert (np.asarray(same.values_mm) == before.values_mm).all()
    spoken = rows[1:-1]
    same = rest_at_ends(before, spoken, neutral_mm=NEUTRAL, silence="SIL")
    assert (np.asarray(same.values_mm) == before.values_mm).all()
    half = rest_at_ends(before, rows[1:], neutral_mm=NEUTRAL, silence="SIL")
    assert (half.values_mm[0] == before.values_mm[0]).all()
    np.testing.assert_allclose(half.values_mm[-1], NEUTRAL, atol=1e-6)


@pytest.mark.parametrize("rate_hz", [10.0, 25.0])
def test_a_silence_shorter_than_a_frame_is_cut_rather_than_speech(rate_hz):
    rows = phones(0.01, 1.0, 0.01)
    before = moving(rows, rate_hz, 2)
    after = rest_at_ends(before, rows, neutral_mm=NEUTRAL, silence="SIL")
    np.testing.assert_allclose(after.values_mm[0], NEUTRAL, atol=1e-6)
    changed = np.flatnonzero((np.asarray(after.values_mm) != before.values_mm).any(axis=(1, 2)))
    assert all(before.times_s[k] < 0.01 or before.times_s[k] > 1.01 for k in changed)
