"""Syllables: one nucleus each, the longest legal onset, never across a word or a silence."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import Interval, Labels, Tier
from corpus_tools.speech import (
    labelled_utterance,
    phone_set,
    phone_set_names,
    recorded_utterance,
    speak_text,
    syllable_languages,
    syllable_rules,
    syllable_spans,
    syllable_tier,
)

PHONES = phone_set("arpabet")
RULES = {language: syllable_rules(language) for language in syllable_languages()}


def cut(phones, language):
    phones = phones.split()
    return [" ".join(phones[a : b + 1]) for a, b in syllable_spans(phones, RULES[language])]


@pytest.mark.parametrize(
    ("phones", "syllables"),
    [
        ("K AH N S T R EY N T", ["K AH N", "S T R EY N T"]),
        ("EH K S T R AH", ["EH K", "S T R AH"]),
        ("AH W EY", ["AH", "W EY"]),
        ("S IH NG IH NG", ["S IH NG", "IH NG"]),
        ("R IY AE K T", ["R IY", "AE K T"]),
        ("AE T L AH S", ["AE T", "L AH S"]),
        ("S T R EH NG K TH S", ["S T R EH NG K TH S"]),
        ("P S T", ["P S T"]),
        ("", []),
    ],
)
def test_english_words(phones, syllables):
    assert cut(phones, "en") == syllables


@pytest.mark.parametrize(
    ("phones", "syllables"),
    [
        ("t r a n s p o r t e", ["t r a n s", "p o r", "t e"]),
        ("l e e r", ["l e", "e r"]),
        ("a u l a", ["a u", "l a"]),
        ("p a í s", ["p a", "í s"]),
        ("ch i í t a", ["ch i í", "t a"]),
        ("ch i i t a", ["ch i", "i", "t a"]),
        ("b u é i", ["b u é i"]),
        ("th i u d á d", ["th i u", "d á d"]),
        ("a b l á r", ["a", "b l á r"]),
        ("a t l á s", ["a t", "l á s"]),
        ("p é rr o", ["p é", "rr o"]),
    ],
)
def test_spanish_words(phones, syllables):
    assert cut(phones, "es") == syllables


def test_a_dialect_is_cut_as_its_language_and_an_unknown_language_not_at_all():
    assert syllable_rules("en-GB") == syllable_rules("en_us") == RULES["en"]
    assert syllable_rules("tlh") is None


@pytest.mark.parametrize("language", sorted(RULES))
def test_the_file_of_a_language_is_whole(language):
    rules = RULES[language]
    assert rules.weak <= rules.nuclei
    assert not rules.nuclei & set(itertools.chain(*rules.onsets))
    assert {(p,) for onset in rules.onsets for p in onset} <= rules.onsets
    if rules.phones:
        assert rules.phones in phone_set_names()
        assert rules.nuclei == phone_set(rules.phones).vowels
        assert set(itertools.chain(*rules.onsets)) <= set(phone_set(rules.phones).phones)


def symbols(rules):
    consonants = sorted(set(itertools.chain(*rules.onsets)))
    return st.lists(st.sampled_from(sorted(rules.nuclei)) | st.sampled_from(consonants), max_size=14)


@pytest.mark.parametrize("language", sorted(RULES))
@given(data=st.data())
def test_syllables_part_a_word_each_with_one_nucleus_and_the_longest_legal_onset(language, data):
    rules = RULES[language]
    phones = data.draw(symbols(rules))
    spans = syllable_spans(phones, rules)
    assert [k for a, b in spans for k in range(a, b + 1)] == list(range(len(phones)))
    for number, (a, b) in enumerate(spans):
        vowels = [k for k in range(a, b + 1) if phones[k] in rules.nuclei]
        assert vowels or len(spans) == 1
        assert vowels == list(range(vowels[0], vowels[-1] + 1) if vowels else [])
        assert sum(phones[k] not in rules.weak for k in vowels) <= 1
        if number and phones[a] not in rules.nuclei:
            assert tuple(phones[a : vowels[0]]) in rules.onsets
        if number and phones[a - 1] not in rules.nuclei:
            assert tuple(phones[a - 1 : vowels[0]]) not in rules.onsets


def timed(phones, step_s=0.1):
    return Tier("phones", tuple(Interval(k * step_s, (k + 1) * step_s, p) for k, p in enumerate(phones)))


@st.composite
def sentences(draw):
    """Draw timed phones with silences, and words that part them or leave some out."""
    drawn = draw(st.lists(st.sampled_from(("SIL", "P", "S", "T", "R", "AH", "IY")), max_size=12))
    phones = ["SIL", *drawn, "SIL"]
    cuts = sorted(draw(st.sets(st.integers(1, len(phones) - 1))))
    words = [(a, b) for a, b in itertools.pairwise(cuts) if "SIL" not in phones[a:b]]
    return timed(phones), Tier("words", tuple(Interval(0.1 * a, 0.1 * b, "w") for a, b in words)), words


@given(sentences(), st.booleans())
def test_syllables_cover_all_that_is_spoken_and_stay_in_their_word(drawn, known):
    phones, words, spans = drawn
    made = syllable_tier(phones, words if known else None, RULES["en"], "SIL")
    spoken = [p for p in phones if p.text != "SIL"]
    assert " ".join(s.text for s in made).split() == [p.text for p in spoken]
    for syllable in made:
        held = [p for p in phones if syllable.start_s <= p.centre_s < syllable.end_s]
        vowels = sum(p.text in PHONES.vowels for p in held)
        alone = all(
            q is None or q.text == "SIL"
            for q in (phones.at(syllable.start_s - 0.05), phones.at(syllable.end_s + 0.05))
        )
        assert vowels == 1 or (vowels == 0 and alone)
        if known and vowels:
            assert _words_with_vowels_met(phones, syllable, spans) <= 1


def _words_with_vowels_met(phones, syllable, spans):
    """How many words that have a vowel somewhere the syllable takes phones from: others may join it."""
    inside = {k for k, p in enumerate(phones) if syllable.start_s <= p.centre_s < syllable.end_s}
    vowels = {k for k, p in enumerate(phones) if p.text in PHONES.vowels}
    return sum(bool(inside & set(range(a, b))) and bool(vowels & set(range(a, b))) for a, b in spans)


def test_words_keep_their_consonants():
    phones = timed(["SIL", "AE", "T", "AO", "L", "SIL"])
    words = Tier("words", (Interval(0.1, 0.3, "at"), Interval(0.3, 0.5, "all")))
    assert [s.text for s in syllable_tier(phones, words, RULES["en"], "SIL")] == ["AE T", "AO L"]
    assert [s.text for s in syllable_tier(phones, None, RULES["en"], "SIL")] == ["AE", "T AO L"]


def test_a_word_without_a_vowel_joins_the_one_before_or_else_the_one_after():
    phones = timed(["SIL", "IH", "T", "S", "SIL", "S", "M", "AA", "SIL", "M", "SIL"])
    spans = [(1, 3, "it"), (3, 4, "'s"), (5, 6, "'s"), (6, 8, "ma"), (9, 10, "mm")]
    words = Tier("words", tuple(Interval(a / 10, b / 10, w) for a, b, w in spans))
    made = syllable_tier(phones, words, RULES["en"], "SIL")
    assert [s.text for s in made] == ["IH T S", "S M AA", "M"]


LABELS = Labels((timed(["sil", "AH0", "W", "EY1", "sil"]),), 0.0, 0.5)


def test_recorded_and_labelled_utterances_have_syllables_where_the_language_has_rules():
    made = recorded_utterance("a", LABELS, None, PHONES)
    assert [s.text for s in made.syllables] == ["AH", "W EY"]
    assert [t for s in made.syllables for t in (s.start_s, s.end_s)] == pytest.approx([0.1, 0.2, 0.2, 0.4])
    assert labelled_utterance("a", LABELS, None, PHONES, language="en-gb").syllables == made.syllables
    assert recorded_utterance("a", LABELS, None, PHONES, language="es").syllables is None  # not its phones
    assert recorded_utterance("a", LABELS, None, PHONES, language="tlh").syllables is None


def test_what_the_voice_says_has_syllables():
    pytest.importorskip("espeakng_loader")
    spoken = speak_text("an extra constraint", PHONES)
    assert len(spoken.syllables) == 5
    edges = [t for w in spoken.words for t in (w.start_s, w.end_s)]
    inside = [t for s in spoken.syllables for t in edges if s.start_s + 1e-6 < t < s.end_s - 1e-6]
    assert inside == []
