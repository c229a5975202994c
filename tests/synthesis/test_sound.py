"""Sound and motion of the same units: nothing stretched, joined where the units join."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from corpus_tools.core import (
    Audio,
    Capture,
    ChosenUnit,
    Costs,
    InputError,
    Interval,
    Recording,
    Selection,
    Tier,
    UnitRef,
    Utterance,
)
from corpus_tools.fragments import build_inventory
from corpus_tools.synthesis import linked_utterance
from corpus_tools.synthesis.sound import EDGE_S, SHIFT_S
from corpus_tools.synthesis.sound_joins import join_sounds

RATE = 8000
LABELS = ("SIL", "M", "AA", "N", "IY", "SIL")


def spoken(name, seed, rate=RATE, sound=True):
    """Return a simulated recording with sound of a pitch and a spectrum that wander."""
    rng = np.random.default_rng(seed)
    edges = np.cumsum([0.0, 0.3, *rng.uniform(0.06, 0.25, 4), 0.3])
    intervals = [Interval(float(a), float(b), t) for a, b, t in zip(edges, edges[1:], LABELS, strict=False)]
    times = np.arange(round(edges[-1] * rate)) / rate
    hz = 110 + 15 * np.sin(2 * np.pi * 0.7 * times + seed)
    phase = 2 * np.pi * np.cumsum(hz) / rate
    samples = sum(rng.uniform(0.1, 0.3) * np.sin(k * phase + rng.uniform(0, 6)) for k in range(1, 6))
    audio = Audio(np.asarray(samples, np.float32), rate) if sound else None
    words = Tier("words", (Interval(intervals[1].start_s, intervals[4].end_s, "many"),))
    utterance = Utterance(name, "many", Tier("phones", tuple(intervals)), words, audio=audio)
    frames = np.zeros((round(edges[-1] * 50), 1, 3))
    return Recording(utterance, Capture(frames, 50.0, ("lip_in0",)))


def chosen(*units):
    """Return a selection of (recording, first, last), each on the target phones of the same numbers."""
    units_ = tuple(ChosenUnit(a, b, UnitRef(n, a, b), Costs((), ())) for n, a, b in units)
    return Selection("t", "test", units_)


@settings(max_examples=15)
@given(st.integers(0, 99), st.integers(1, 4))
def test_a_recording_cut_in_two_sounds_as_it_was(seed, at):
    recording = spoken("a", seed)
    target = recording.utterance
    linked = linked_utterance(target, chosen(("a", 0, at), ("a", at, 5)), build_inventory([recording]))
    ends = [[p.end_s for p in u.phones] for u in (linked, target)]
    assert ends[0] == pytest.approx(ends[1])
    edge = round(2 * EDGE_S * RATE)
    n = len(target.audio.samples)
    np.testing.assert_allclose(
        linked.audio.samples[edge : n - edge], target.audio.samples[edge : n - edge], atol=1e-5
    )


@settings(max_examples=15)
@given(st.integers(0, 99), st.integers(1, 4))
def test_phones_last_as_long_as_in_their_units_and_words_go_with_them(seed, at):
    a, b, target = spoken("a", seed), spoken("b", seed + 1), spoken("t", seed + 2).utterance
    linked = linked_utterance(target, chosen(("a", 0, at), ("b", at, 5)), build_inventory([a, b]))
    lengths = [p.duration_s for p in linked.phones]
    own = [[p.duration_s for p in r.utterance.phones] for r in (a, b)]
    assert lengths[1:at] == pytest.approx(own[0][1:at])
    assert lengths[at + 1 : 5] == pytest.approx(own[1][at + 1 : 5])
    assert lengths[at] == pytest.approx(0.5 * (own[0][at] + own[1][at]))
    assert lengths[0] == pytest.approx(target.phones.intervals[0].duration_s)
    (word,) = linked.words
    assert (word.start_s, word.end_s) == pytest.approx(
        (linked.phones.intervals[1].start_s, linked.phones.intervals[4].end_s)
    )
    assert abs(linked.audio.duration_s - linked.duration_s) < 2 / RATE
    assert (linked.engine, linked.labels) == ("units", target.labels)
    # the wave goes on over the join: no step larger than those of the recordings
    steps = [np.abs(np.diff(u.audio.samples)).max() for u in (a.utterance, b.utterance, linked)]
    assert steps[2] <= 1.5 * max(steps[:2])


def test_waves_fall_in_step_within_a_few_milliseconds():
    """Two voices of one pitch, out of phase: after the shift they add up and do not cancel."""
    a = spoken("a", 1)
    moved = np.roll(a.utterance.audio.samples, 36)  # half a period of 110 Hz
    b = Recording(replace(a.utterance, name="b", audio=Audio(moved, RATE)), a.capture)
    linked = linked_utterance(a.utterance, chosen(("a", 0, 2), ("b", 2, 5)), build_inventory([a, b]))
    middle = a.utterance.phones.intervals[2].centre_s
    rows = slice(round((middle - 0.01) * RATE), round((middle + 0.01) * RATE))
    loud = [float((u.audio.samples[rows] ** 2).mean()) for u in (a.utterance, linked)]
    assert loud[1] > 0.85 * loud[0]
    late = np.correlate(linked.audio.samples[-2400:-800], a.utterance.audio.samples[-2000:-1200], "valid")
    assert abs(int(late.argmax()) - 400) <= SHIFT_S * RATE + 36


def test_what_has_no_sound_or_another_rate_is_named():
    target = spoken("t", 0).utterance
    two = chosen(("a", 0, 2), ("b", 2, 5))
    with pytest.raises(InputError, match="'b' has no sound"):
        linked_utterance(target, two, build_inventory([spoken("a", 1), spoken("b", 2, sound=False)]))
    with pytest.raises(InputError, match="8000 Hz, 16000 Hz"):
        linked_utterance(target, two, build_inventory([spoken("a", 1), spoken("b", 2, rate=16000)]))


def test_sounds_at_joins_are_scaled_as_postures_are():
    inventory = build_inventory([spoken("a", 1), spoken("b", 2), spoken("c", 3, sound=False)])
    sounds = join_sounds(inventory)
    assert sounds is join_sounds(inventory)
    assert np.sqrt((sounds[:12] ** 2).sum(axis=1).mean()) == pytest.approx(1.0)
    assert not sounds[12:].any()
    assert not join_sounds(build_inventory([spoken("c", 3, sound=False)])).any()
