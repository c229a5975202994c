"""Phone times from the events of a synthesiser: no holes, no zero lengths, closures before bursts."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.speech import phone_map
from corpus_tools.speech.engines.timing import SHORTEST_S, closure_start, spoken_phones, spread

RATE_HZ = 22050
MAP = phone_map("espeak", "arpabet")


@given(st.lists(st.floats(0, 2), min_size=1, max_size=30), st.floats(0.001, 1.0))
def test_spread_leaves_no_interval_too_short_and_moves_nothing_that_is_long_enough(starts, rest_s):
    starts = np.sort(starts)
    end_s = float(starts[-1]) + rest_s
    moved = spread(starts, end_s)
    least = min(SHORTEST_S, (end_s - starts[0]) / len(starts))
    assert (np.diff([*moved, end_s]) >= least - 1e-9).all()
    if (np.diff([*starts, end_s]) >= SHORTEST_S).all():
        np.testing.assert_allclose(moved, starts, atol=1e-12)


@given(st.integers(0, 50), st.integers(1, 50), st.integers(0, 60))
def test_a_closure_begins_where_the_sound_before_it_ends(sounding, silent, floor):
    samples = np.concatenate([np.ones(sounding), np.zeros(silent), np.ones(9)]).astype(np.int16)
    burst = sounding + silent
    floor = min(floor, burst)
    assert closure_start(samples, burst, floor) == max(sounding, floor)


names = st.sampled_from([*sorted({s for key in MAP.symbols for s in key}), "_:", "_"])


@given(st.lists(st.tuples(st.integers(0, 9000), names, st.integers(0, 1)), min_size=1, max_size=20))
def test_any_events_give_phones_that_ascend(rows):
    samples = np.random.default_rng(0).integers(-9, 9, 60000).astype(np.int16)
    sample, word, events = 0, 0, []
    for step, symbol, new in rows:
        sample, word = min(sample + step // len(rows), len(samples)), word + new
        events.append((sample, symbol, word))
    found = spoken_phones(samples, RATE_HZ, events, MAP)
    wanted = [
        p
        for k in sorted({w for *_, w in events})
        for m in MAP.translate([s for _, s, w in events if w == k])
        for p in m.phones
    ]
    assert [p.phone for p in found] == wanted
    edges = [p.start_s for p in found] + [len(samples) / RATE_HZ]
    if found:
        assert (np.diff(edges) >= SHORTEST_S - 1e-9).all()


def test_a_sound_that_is_two_phones_is_split_two_to_one():
    samples = np.ones(RATE_HZ, np.int16)
    found = spoken_phones(samples, RATE_HZ, [(0, "'o@", 0), (RATE_HZ * 3 // 10, "_:", 0)], MAP)
    assert [p.phone for p in found] == ["AO", "R", "SIL"]
    np.testing.assert_allclose([p.start_s for p in found], [0.0, 0.2, 0.3], atol=1e-4)


def test_a_stop_behind_a_pause_gets_a_closure_and_a_vowel_does_not():
    samples = np.ones(RATE_HZ, np.int16)
    samples[5000:10000] = 0
    for symbol, start in (("p", 10000 - round(0.05 * RATE_HZ)), ("a", 10000), ("m", 10000)):
        found = spoken_phones(samples, RATE_HZ, [(0, "a", 0), (5000, "_:", 0), (10000, symbol, 1)], MAP)
        assert abs(found[-1].start_s - start / RATE_HZ) < 1e-6
