"""The choice of sentences: greedy, complete, repeatable, better than chance."""

import numpy as np
import pytest

from corpus_tools.core import InputError
from corpus_tools.demo import (
    Grammar,
    all_sentences,
    covering_sentences,
    diphones,
    greedy_cover,
    pool_of,
    time_grammar,
)

POOL = all_sentences()


def covered(sentences):
    return {d for s in sentences for d in diphones(s)}


def test_diphones_include_the_silences_at_both_ends():
    assert diphones(time_grammar().pronounce("ten")) == [("SIL", "T"), ("T", "EH"), ("EH", "N"), ("N", "SIL")]


def test_each_sentence_brings_as_many_new_diphones_as_any_could():
    cover = greedy_cover(POOL, 12)
    have = set()
    for sentence, added in zip(cover.sentences, cover.added, strict=True):
        assert set(added) == covered([sentence]) - have
        assert len(added) == max(len(covered([s]) - have) for s in POOL)
        have |= set(added)
    assert cover.covered[-1] == len(have)
    assert cover.total == len(covered(POOL))


@pytest.mark.parametrize("seed", range(3))
def test_the_55_cover_every_diphone_with_about_30_and_fill_at_random(seed):
    chosen = covering_sentences(55, np.random.default_rng(seed))
    assert len({s.text for s in chosen}) == 55
    every = covered(POOL)
    needed = next(n for n in range(1, 56) if covered(chosen[:n]) == every)
    assert 25 <= needed <= 37
    rest = {s.text for s in chosen[needed:]}
    other = {s.text for s in covering_sentences(55, np.random.default_rng(seed + 10))[needed:]}
    assert len(rest & other) < 10


def test_a_choice_is_repeatable_and_a_smaller_one_is_its_beginning():
    chosen = [s.text for s in covering_sentences(55, np.random.default_rng(0))]
    assert chosen == [s.text for s in covering_sentences(55, np.random.default_rng(0))]
    for n in (1, 4, 14, 40):
        assert [s.text for s in covering_sentences(n, np.random.default_rng(0))] == chosen[:n]


def test_cover_is_better_than_chance():
    random = [
        len(covered(POOL[i] for i in np.random.default_rng(k).permutation(len(POOL))[:10])) for k in range(20)
    ]
    assert len(covered(covering_sentences(10, np.random.default_rng(0)))) > max(random)


def test_the_examples_of_the_paper_are_left_to_be_synthesised():
    examples = {
        "the time is now exactly one in the afternoon",
        "the time is now quarter to ten in the morning",
    }
    chosen = [s.text for s in covering_sentences(2880, np.random.default_rng(0))]
    assert set(chosen[-2:]) == examples
    assert len(set(chosen)) == 2880


@pytest.mark.parametrize("n", [0, -1, 2881])
def test_numbers_of_sentences_that_there_are_not_are_refused(n):
    with pytest.raises(InputError, match="2880"):
        covering_sentences(n, np.random.default_rng(0))


def test_words_that_a_lexicon_lacks_are_said_as_the_voice_says_them():
    grammar = Grammar("small", (("hello", "ten"), ("bob", "")), {"hello": ("HH", "OW")})
    pool = pool_of(grammar, np.random.default_rng(0))
    said = {w: p for s in pool for w, p in zip(s.words, s.phones, strict=True)}
    assert said == {"hello": ("HH", "OW"), "ten": ("T", "EH", "N"), "bob": ("B", "AA", "B")}
    assert {s.text for s in pool} == set(grammar.texts())
