"""Place and stress of phones as codes, and how different two of them are."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import Interval, Labels, Tier
from corpus_tools.speech import phone_set, recorded_utterance, speak_text
from corpus_tools.speech.places import N_PLACES, phone_places, place_gaps, stress_codes, stress_gaps

PHONES = phone_set("arpabet")
GAPS = place_gaps()


def tier(name, rows):
    return Tier(name, tuple(Interval(a / 10, b / 10, text) for a, b, text in rows))


def spoken(labels, words=None, language="en"):
    tiers = [tier("phones", [(k, k + 1, p) for k, p in enumerate(labels)])]
    if words is not None:
        tiers.append(tier("words", words))
    return recorded_utterance("a", Labels(tuple(tiers), 0, len(labels) / 10), None, PHONES, language=language)


def places(utterance):
    return phone_places(utterance, PHONES.vowels, PHONES.silence)


def apart(utterance, a, b):
    found = places(utterance)
    return GAPS[found[a], found[b]]


STRAIT = spoken(["sil", "S", "T", "EY", "T", "T", "EY", "K", "S", "sil"], [(1, 5, "state"), (5, 9, "takes")])


def test_onset_nucleus_and_coda_are_told_apart():
    mid = spoken(["sil", "AA", "T", "AA", "T", "B", "AA", "sil"], [(1, 7, "w")])  # AA . T AA T . B AA
    assert apart(mid, 2, 4) == pytest.approx(1 / 3)  # the same phone, once before and once after its vowel
    assert apart(mid, 3, 3) == 0


def test_the_edges_of_a_word_count_half_each():
    inside, first, last, alone = (10 + 2 * k for k in (1, 2, 3, 4))
    assert GAPS[inside, first] == GAPS[inside, last] == GAPS[alone, first] == pytest.approx(1 / 6)
    assert GAPS[inside, alone] == GAPS[first, last] == pytest.approx(1 / 3)


def test_the_last_syllable_before_a_silence_is_final():
    words = [(1, 4, "take"), (4, 7, "take"), (8, 11, "take")]
    twice = spoken(["sil", *["T", "EY", "K", "T", "EY", "K", "sil", "T", "EY", "K"], "sil"], words)
    assert [apart(twice, a, a + 3) for a in (1, 2, 3)] == pytest.approx([1 / 3] * 3)
    assert [apart(twice, a, a + 4) for a in (4, 5, 6)] == [0, 0, 0]


def test_without_syllables_and_words_the_last_phone_alone_is_final():
    bare = spoken(["sil", "T", "EY", "K", "sil"], language="tlh")
    assert bare.syllables is None
    assert places(bare).tolist() == [0, 0, 0, 1, 0]


@given(st.lists(st.integers(0, N_PLACES - 1), min_size=3, max_size=3))
def test_what_is_unknown_is_like_all_and_the_same_costs_nothing(codes):
    a, b, _ = codes
    assert GAPS[a, a] == 0
    assert GAPS[a, b] == GAPS[b, a] <= 1
    final = a % 2
    assert GAPS[a, final] == 0  # nothing known but whether silence follows


def test_silence_has_no_place():
    assert places(STRAIT)[[0, -1]].tolist() == [0, 0]


def test_digits_of_labels_tell_the_stress():
    made = spoken(["sil", "AH0", "W", "EY1", "B", "AE2", "K", "OY", "sil"])
    assert made.stress == (-1, 0, -1, 1, -1, 2, -1, -1, -1)
    assert stress_codes(made).tolist() == [0, 1, 0, 2, 0, 3, 0, 0, 0]
    assert spoken(["sil", "AH", "W", "EY", "sil"]).stress is None


def test_the_voice_tells_the_stress():
    pytest.importorskip("espeakng_loader")
    made = speak_text("an extra constraint", PHONES)
    told = [(p.text, s) for p, s in zip(made.phones, made.stress, strict=True) if p.text in PHONES.vowels]
    assert [s for _, s in told] == [0, 1, 0, 0, 1]
    assert {s for p, s in zip(made.phones, made.stress, strict=True) if p.text not in PHONES.vowels} == {-1}


def test_stress_differs_by_strength_and_unknown_not_at_all():
    gaps = stress_gaps()
    assert np.array_equal(gaps, gaps.T)
    assert not gaps[0].any()
    assert [gaps[a, b] for a, b in itertools.combinations((1, 2, 3), 2)] == [1.0, 0.5, 0.5]
