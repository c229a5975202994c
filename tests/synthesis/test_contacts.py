"""Every p b m and f v of an utterance, and whether the motion makes it."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import Interval, Tier, Trajectory, Utterance
from corpus_tools.speech import aperture_functional, bite_functional, phone_set
from corpus_tools.synthesis import lip_contacts
from corpus_tools.synthesis.closure import HOLD_S
from corpus_tools.synthesis.lips import LipContact, LipModel, make_contacts
from tests.strategies.fragments import seeds

NAMES = ("lip_in1", "lip_in7", "chin3", "brow0")
PHONES = phone_set("arpabet")
RATE_HZ = 120.0


def contact(functional, target_mm=0.0, threshold_mm=0.6):
    """Return a contact of a face that moves only its lower lip, chin half as much."""
    direction = np.zeros((4, 3))
    direction[1, 1], direction[2, 1] = -1.0, -0.5
    return LipContact(functional, direction, target_mm, threshold_mm)


ON_TEETH = contact(bite_functional(NAMES), target_mm=-1.0, threshold_mm=-0.5)
CLOSED = contact(aperture_functional(NAMES))
LIPS = LipModel(
    **{f.name: getattr(CLOSED, f.name) for f in dataclasses.fields(LipContact)}, on_teeth=ON_TEETH
)


def speak(labels, durations_s, seed):
    """Return an utterance, and a simulated motion in which the lower lip goes up and down by chance."""
    edges = np.concatenate([[0.0], np.cumsum(durations_s)])
    phones = [(float(a), float(b), p) for a, b, p in zip(edges[:-1], edges[1:], labels, strict=True)]
    spoken = Utterance("u", "", tier(phones))
    rng = np.random.default_rng(seed)
    times = np.arange(0, edges[-1], 1 / RATE_HZ)
    motion = np.zeros((len(times), 4, 3))
    hz, phase = rng.uniform(1, 6, 4), rng.uniform(0, 6, 4)
    motion[:, 1, 1] = -5.0 + 1.2 * np.sin(2 * np.pi * hz * times[:, None] + phase).sum(axis=1)
    return spoken, Trajectory(times, motion, NAMES)


def tier(rows):
    return Tier("phones", tuple(Interval(*row) for row in rows))


@st.composite
def sentences(draw):
    n = draw(st.integers(1, 10))
    labels = draw(st.lists(st.sampled_from(["P", "B", "M", "F", "V", "AA", "T"]), min_size=n, max_size=n))
    durations = draw(st.lists(st.floats(0.02, 0.25), min_size=n, max_size=n))
    return speak(["SIL", *labels, "SIL"], [0.3, *durations, 0.3], draw(seeds))


@given(sentences())
def test_each_is_listed_once_and_is_made_after_the_projection(spoken):
    utterance, motion = spoken
    before = lip_contacts(LIPS, motion, utterance, PHONES)
    after = lip_contacts(LIPS, make_contacts(LIPS, motion, utterance, PHONES, 3), utterance, PHONES)
    wanted = [p for p in utterance.phones if p.text in PHONES.bilabials | PHONES.labiodentals]
    assert [(c.phone, c.start_s) for c in after] == [(p.text, p.start_s) for p in wanted]
    assert all(c.kind == PHONES.lip_shape(c.phone) for c in after)
    assert all(c.made for c in after)
    assert all(c.held_s >= min(HOLD_S, c.end_s - c.start_s) - 2.01 / RATE_HZ for c in after)
    assert all(b.nearest_mm <= a.nearest_mm + 1e-9 for a, b in zip(before, after, strict=True))


@given(sentences())
def test_an_open_mouth_makes_none(spoken):
    utterance, motion = spoken
    apart = np.array(motion.values_mm)
    apart[:, 1, 1] -= 20.0
    found = lip_contacts(LIPS, dataclasses.replace(motion, values_mm=apart), utterance, PHONES)
    assert not any(c.made for c in found)
    assert all(c.held_s == 0 and c.nearest_mm > 10 for c in found)


def test_how_near_when_and_how_long_are_those_of_the_motion():
    utterance, motion = speak(["SIL", "B", "SIL"], [0.2, 0.1, 0.2], 0)
    values = np.zeros((len(motion.times_s), 4, 3))
    values[:, 1, 1] = -3.0
    shut = (motion.times_s > 0.24) & (motion.times_s < 0.28)
    values[shut, 1, 1] = -0.2
    (found,) = lip_contacts(LIPS, dataclasses.replace(motion, values_mm=values), utterance, PHONES)
    assert found.made
    assert found.nearest_mm == pytest.approx(0.2 - 0.6)
    assert 0.24 < found.time_s < 0.28
    assert found.held_s == pytest.approx(0.04, abs=1.01 / RATE_HZ)


def test_the_lip_on_the_teeth_can_be_left_alone():
    utterance, motion = speak(["SIL", "F", "SIL"], [0.2, 0.1, 0.2], 3)
    left = make_contacts(LIPS, motion, utterance, PHONES, 3, on_teeth=False)
    np.testing.assert_array_equal(left.values_mm, motion.values_mm)
    moved = make_contacts(LIPS, motion, utterance, PHONES, 3)
    assert np.abs(np.asarray(moved.values_mm) - motion.values_mm).max() > 1.0


def test_what_the_corpus_never_shows_is_not_listed():
    utterance, motion = speak(["SIL", "F", "B", "SIL"], [0.2, 0.1, 0.1, 0.2], 1)
    unknown = dataclasses.replace(ON_TEETH, target_mm=float("nan"), threshold_mm=float("nan"))
    found = lip_contacts(dataclasses.replace(LIPS, on_teeth=unknown), motion, utterance, PHONES)
    assert [c.phone for c in found] == ["B"]
