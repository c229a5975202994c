"""The sentences of the time domain: the grammar of paper A, its lexicon, and a cover of its diphones."""

import itertools

import numpy as np
import pytest

from corpus_tools.demo import all_sentences, covering_sentences, diphones, pronounce
from corpus_tools.demo.sentences import load_data
from corpus_tools.speech import phone_set


def test_the_grammar_holds_every_combination_once():
    sentences = all_sentences()
    grammar = load_data("time_grammar")["grammar"]
    assert (
        len(sentences)
        == len({s.text for s in sentences})
        == np.prod([len(grammar[k]) for k in grammar["prompt"]])
    )
    texts = {s.text for s in sentences}
    assert "the time is now exactly one in the afternoon" in texts
    assert "the time is now almost quarter to ten in the morning" in texts


def test_every_word_is_pronounced_with_phones_that_can_be_simulated_and_synthesised():
    lexicon, gestures = load_data("time_grammar")["lexicon"], load_data("gestures")
    phones = phone_set("arpabet")
    used = set(itertools.chain(*(p.split() for p in lexicon.values())))
    words = set(itertools.chain(*(s.words for s in all_sentences())))
    assert words <= set(lexicon)
    for phone in used:
        assert phones.normalise(phone) == phone
        assert phone in gestures["phones"]
        assert phone in gestures["sound"]


def test_diphones_include_the_silences_at_both_ends():
    assert diphones(pronounce("ten")) == {("SIL", "T"), ("T", "EH"), ("EH", "N"), ("N", "SIL")}


def test_cover_is_repeatable_without_repetition_and_better_than_chance():
    chosen = covering_sentences(10, np.random.default_rng(0))
    assert [s.text for s in chosen] == [s.text for s in covering_sentences(10, np.random.default_rng(0))]
    assert len({s.text for s in chosen}) == 10
    pool = all_sentences()
    random = [
        len(set().union(*(diphones(pool[i]) for i in np.random.default_rng(k).permutation(len(pool))[:10])))
        for k in range(20)
    ]
    assert len(set().union(*map(diphones, chosen))) > max(random)


def test_more_sentences_cover_more():
    found = [
        len(set().union(*map(diphones, covering_sentences(n, np.random.default_rng(0))))) for n in (2, 6, 14)
    ]
    assert found == sorted(found)
    assert found[0] < found[2]


def test_a_word_that_is_not_in_the_lexicon_is_an_error():
    with pytest.raises(KeyError):
        pronounce("the time is nowish")
