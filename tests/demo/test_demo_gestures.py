"""Simulated speech: phones in time, closures that close, vowels that open, and tokens that differ."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from corpus_tools.core import Interval, Tier
from corpus_tools.demo import (
    DIMENSIONS,
    all_sentences,
    articulate,
    covering_sentences,
    simulate_sentence,
    time_phones,
)
from corpus_tools.demo.actor import marker_names
from corpus_tools.speech import lip_aperture_mm, phone_set

PHONES = phone_set("arpabet")
OPEN_VOWELS = {"AA", "AE", "AO", "AW", "AY"}


@pytest.fixture(scope="module")
def spoken():
    sentences = covering_sentences(8, np.random.default_rng(0))
    return [simulate_sentence(s, np.random.default_rng([9, i])) for i, s in enumerate(sentences)]


def windows(made, wanted, margin_s):
    """Return phone and aperture (mm) in and around every phone of a set."""
    aperture = lip_aperture_mm(made.truth_mm, marker_names()[:66])
    times = np.arange(len(aperture)) / made.capture.rate_hz
    for phone in made.phones:
        if phone.text in wanted:
            inside = (times >= phone.start_s - margin_s) & (times <= phone.end_s + margin_s)
            yield phone, aperture[inside]


def test_bilabials_are_closed_in_the_truth_for_at_least_30_ms(spoken):
    found = [w for made in spoken for w in windows(made, PHONES.bilabials, 0.02)]
    assert len(found) > 15
    for phone, aperture in found:
        assert abs(aperture.min()) < 0.05, phone
        assert (aperture < 0.3).sum() / 120.0 >= 0.03, phone


def test_vowels_are_open_in_the_truth(spoken):
    found = [w for made in spoken for w in windows(made, PHONES.vowels, 0.0)]
    assert len(found) > 60
    for phone, aperture in found:
        assert aperture.max() > (5.0 if phone.text in OPEN_VOWELS else 2.0), phone


def test_the_mouth_rests_closed_before_and_after(spoken):
    for made in spoken:
        aperture = lip_aperture_mm(made.truth_mm, marker_names()[:66])
        assert np.abs(aperture[:20]).max() < 0.1
        assert np.abs(aperture[-10:]).max() < 0.3


@settings(max_examples=15)
@given(st.integers(0, len(all_sentences()) - 1), st.integers(0, 2**32 - 1))
def test_timed_phones_are_those_of_the_words_in_order_without_holes(index, seed):
    sentence = all_sentences()[index]
    phones, words = time_phones(sentence, np.random.default_rng(seed))
    assert [p.text for p in phones] == ["SIL", *itertools.chain(*sentence.phones), "SIL"]
    assert phones.intervals[0].start_s == 0.0
    for before, after in itertools.pairwise(phones):
        assert before.end_s == after.start_s
    assert tuple(w.text for w in words) == sentence.words
    assert words.intervals[0].start_s == phones.intervals[0].end_s
    assert words.intervals[-1].end_s == phones.intervals[-1].start_s
    assert all(0.03 < p.duration_s < 0.35 for p in phones.intervals[1:-1])


def test_two_tokens_of_a_sentence_differ_in_time_and_in_motion():
    sentence = all_sentences()[7]
    one, two = (simulate_sentence(sentence, np.random.default_rng(k)) for k in (0, 1))
    assert [p.text for p in one.phones] == [p.text for p in two.phones]
    lengths = np.array([[p.duration_s for p in made.phones] for made in (one, two)])
    assert np.abs(np.diff(np.log(lengths), axis=0)).mean() > 0.05


def test_articulators_are_critically_damped_towards_their_target():
    """One long open vowel: the jaw rises to the asked value, never beyond it, and is slower than the lips."""
    phones = Tier("phones", (Interval(0.0, 0.5, "SIL"), Interval(0.5, 2.0, "AA"), Interval(2.0, 2.5, "SIL")))
    jaw = articulate(phones, 120.0, np.random.default_rng(0))[:, DIMENSIONS.index("jaw")]
    plateau = jaw[200:230]
    assert 0.7 < plateau.mean() < 1.0
    assert np.ptp(plateau) < 0.01
    assert jaw.max() < plateau.mean() + 0.01, "no overshoot"
    assert jaw[: int(0.4 * 120)].max() < 0.01
    rising = jaw[int(0.45 * 120) : 180]
    assert (np.diff(rising) > -1e-3).all()


@pytest.mark.parametrize("rate_hz", [60.0, 120.0])
def test_motion_covers_the_sound_at_any_rate(rate_hz):
    phones, _ = time_phones(all_sentences()[0], np.random.default_rng(0))
    frames = articulate(phones, rate_hz, np.random.default_rng(0))
    end_s = phones.intervals[-1].end_s
    assert end_s - 1 / rate_hz < (len(frames) - 1) / rate_hz <= end_s
    assert frames.min() >= 0.0
    assert frames.max() <= 1.0
