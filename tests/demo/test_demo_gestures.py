"""Task dynamics: closures that close, vowels that open, tokens that differ, the equation of motion itself."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import Interval, Tier
from corpus_tools.demo import (
    DIMENSIONS,
    all_sentences,
    articulate,
    covering_sentences,
    critically_damped,
    marker_names,
    simulate_sentence,
    time_phones,
)
from corpus_tools.demo.sentences import load_data
from corpus_tools.speech import lip_aperture_mm, lip_width_mm, phone_set

PHONES = phone_set("arpabet")
NAMES = marker_names()[:66]
OPEN_VOWELS = {"AA", "AE", "AW", "AY"}


@pytest.fixture(scope="module")
def spoken():
    sentences = covering_sentences(8, np.random.default_rng(0))
    return [simulate_sentence(s, np.random.default_rng([9, i])) for i, s in enumerate(sentences)]


def windows(made, wanted, margin_s):
    """Yield phone, and which frames lie in and around it, for every phone of a set."""
    times = np.arange(len(made.truth_mm)) / made.capture.rate_hz
    for phone in made.phones:
        if phone.text in wanted:
            yield phone, (times >= phone.start_s - margin_s) & (times <= phone.end_s + margin_s)


def test_every_phone_of_the_set_has_gestures_and_a_sound():
    table = load_data("gestures")
    assert set(table["phones"]) == set(PHONES.phones)
    assert set(table["sound"]) == set(PHONES.phones) - {"SIL"}
    known = {*DIMENSIONS, "duration_ms", "firm", "glide"}
    assert all(set(entry) <= known for entry in table["phones"].values())


def test_bilabials_are_closed_in_the_truth_for_at_least_50_ms(spoken):
    found = [
        (p, lip_aperture_mm(m.truth_mm[w], NAMES))
        for m in spoken
        for p, w in windows(m, PHONES.bilabials, 0.02)
    ]
    assert len(found) > 15
    for phone, aperture in found:
        assert aperture.min() < 0.01, phone
        assert (aperture < 0.3).sum() / 120.0 >= 0.05, phone


def test_labiodentals_draw_the_lower_lip_back_to_the_teeth_and_stay_almost_closed(spoken):
    lower = NAMES.index("lip_in6")
    rest = spoken[0].truth_mm[0, lower, 2]
    found = [m.truth_mm[w] for m in spoken for _, w in windows(m, PHONES.labiodentals, 0.02)]
    assert len(found) > 8
    for part in found:
        assert lip_aperture_mm(part, NAMES).min() < 2.0
        assert (part[:, lower, 2] - rest).min() < -3.0


def test_rounded_phones_are_narrow_and_spread_ones_wide(spoken):
    def width(wanted):
        return [lip_width_mm(m.truth_mm[w], NAMES).mean() for m in spoken for _, w in windows(m, wanted, 0.0)]

    narrow, wide = width({"W", "UW", "OW"}), width({"IY", "EY"})
    assert max(narrow) < min(wide)
    assert np.mean(wide) - np.mean(narrow) > 6.0


def test_vowels_are_open_in_the_truth(spoken):
    found = [
        (p, lip_aperture_mm(m.truth_mm[w], NAMES)) for m in spoken for p, w in windows(m, OPEN_VOWELS, 0.0)
    ]
    assert len(found) > 20
    for phone, aperture in found:
        assert aperture.max() > 4.0, phone


def test_the_mouth_rests_closed_before_and_after(spoken):
    for made in spoken:
        aperture = lip_aperture_mm(made.truth_mm, NAMES)
        assert np.abs(aperture[:20]).max() < 0.1
        assert np.abs(aperture[-10:]).max() < 0.3


def test_two_tokens_of_a_sentence_differ_in_time_and_in_motion():
    sentence = all_sentences()[7]
    one, two = (simulate_sentence(sentence, np.random.default_rng(k)) for k in (0, 1))
    assert [p.text for p in one.phones] == [p.text for p in two.phones]
    lengths = np.array([[p.duration_s for p in made.phones][1:-1] for made in (one, two)])
    assert np.ptp(np.log(lengths.sum(axis=1))) > 0.01
    tokens = [articulate(one.phones, 120.0, np.random.default_rng(k)) for k in (0, 1)]
    assert 0.02 < np.abs(tokens[0] - tokens[1]).max() < 0.4


@given(st.floats(1.0, 12.0), st.integers(20, 200))
def test_the_integrator_solves_the_critically_damped_equation_exactly(frequency_hz, n):
    omega, dt_s = 2 * np.pi * frequency_hz, 1 / 960
    t = np.arange(n) * dt_s
    expected = 1.0 - (1.0 + omega * t) * np.exp(-omega * t)
    np.testing.assert_allclose(critically_damped(np.ones(n), omega, dt_s), expected, atol=1e-9)


def test_articulators_go_to_their_target_without_overshoot():
    """One long open vowel: the jaw rises to the asked value, never beyond it, and comes to rest there."""
    phones = Tier("phones", (Interval(0.0, 0.5, "SIL"), Interval(0.5, 2.0, "AA"), Interval(2.0, 2.5, "SIL")))
    jaw = articulate(phones, 120.0, np.random.default_rng(0))[:, DIMENSIONS.index("jaw")]
    plateau = jaw[200:230]
    assert 0.7 < plateau.mean() <= 1.0
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
    assert end_s - 1 / rate_hz < (len(frames) - 1) / rate_hz <= end_s + 1e-6
    assert frames.min() >= 0.0
    assert frames.max() <= 1.0
