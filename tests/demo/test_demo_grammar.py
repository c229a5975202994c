"""Grammars: every sentence by its number, samples, how words are said, and files that are none."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import InputError, LabelError
from corpus_tools.demo import Grammar, all_sentences, load_grammar, time_grammar
from corpus_tools.demo.sentences import load_data
from corpus_tools.speech import phone_set

SMALL = """
[grammar]
prompt = ["greeting", "name"]
greeting = ["hello", "good  day", ""]
name = ["ann", "bob"]
[lexicon]
hello = "HH AH L OW"
good = "G UH D"
day = "D EY"
ann = "AE N"
bob = "B AA B"
[before]
"hello ann" = "HH AH L OW W"
"""


@pytest.fixture
def small(tmp_path):
    (tmp_path / "small.toml").write_text(SMALL)
    return load_grammar(tmp_path / "small.toml")


def test_every_sentence_has_a_number_and_every_number_one_sentence(small):
    assert list(small.texts()) == [small.text(i) for i in range(small.size)]
    assert list(small.texts())[-1] == "bob"
    grammar = time_grammar()
    assert [grammar.text(i) for i in range(grammar.size)] == [s.text for s in all_sentences()]
    with pytest.raises(InputError, match="2880"):
        grammar.text(2880)


@given(st.integers(1, 2880), st.integers(0, 2**32 - 1))
def test_a_sample_is_different_sentences_of_the_grammar_and_the_same_again(n, seed):
    grammar = time_grammar()
    one, two = (grammar.sample(n, np.random.default_rng(seed)) for _ in range(2))
    assert one == two
    assert len(set(one)) == n
    assert set(one) <= {s.text for s in all_sentences()}


def test_a_large_grammar_is_sampled_without_listing_it():
    digits = tuple("zero one two three four five six seven eight nine".split())  # noqa: SIM905
    grammar = Grammar("numbers", (digits,) * 11)
    assert grammar.size == 10**11
    chosen = grammar.sample(50, np.random.default_rng(0))
    assert len(set(chosen)) == 50
    with pytest.raises(InputError, match="take fewer"):
        Grammar("two", (("a", "b"),)).sample(3, np.random.default_rng(0))


def test_a_word_is_said_as_its_neighbours_ask(small):
    def said(text):
        return [" ".join(p) for p in small.pronounce(text).phones]

    assert said("hello ann") == ["HH AH L OW W", "AE N"]
    assert said("hello bob") == ["HH AH L OW", "B AA B"]
    assert said("good day bob") == ["G UH D", "D EY", "B AA B"]
    with pytest.raises(InputError, match="did you mean 'hello'"):
        small.pronounce("hallo ann")


def test_every_word_of_the_time_domain_is_said_with_phones_that_can_be_simulated():
    gestures = load_data("gestures")["phones"]
    phones = phone_set("arpabet")
    used = {p for s in all_sentences() for word in s.phones for p in word}
    assert used <= set(gestures)
    assert all(phones.normalise(p) == p for p in used)
    words = set(itertools.chain(*(s.words for s in all_sentences())))
    assert words == set(time_grammar().lexicon), "no word is missing, none is left over"


BROKEN = {
    "not TOML": "[grammar\n",
    "no .grammar.": "[other]\nprompt = ['a']\n",
    "'b' is no list": "[grammar]\nprompt = ['b']\n",
    "'a' is no list": "[grammar]\nprompt = ['a']\na = []\n",
    "twice": "[grammar]\nprompt = ['a']\na = ['x', ' x']\n",
    "may be left out": "[grammar]\nprompt = ['a']\na = ['', 'x']\n",
    "more than 1e.12": "[grammar]\nprompt = [" + "'a'," * 41 + "]\na = ['x', 'y']\n",
    "word = 'PH ON ES'": "[grammar]\nprompt = ['a']\na = ['x']\n[lexicon]\nx = 3\n",
    "word next": "[grammar]\nprompt = ['a']\na = ['x']\n[before]\nx = 'T'\n",
}


@pytest.mark.parametrize("message", BROKEN)
def test_a_file_that_is_no_grammar_is_refused_with_its_name_and_what_was_expected(tmp_path, message):
    path = tmp_path / "mine.toml"
    path.write_text(BROKEN[message])
    with pytest.raises(InputError, match=message) as caught:
        load_grammar(path)
    assert "mine.toml" in str(caught.value)
    assert "was expected" in str(caught.value)


def test_a_phone_outside_the_set_and_a_file_that_is_not_there_are_refused(tmp_path):
    (tmp_path / "g.toml").write_text("[grammar]\nprompt = ['a']\na = ['x']\n[lexicon]\nx = 'QQ'\n")
    with pytest.raises(LabelError, match="QQ"):
        load_grammar(tmp_path / "g.toml")
    with pytest.raises(InputError, match="cannot be read"):
        load_grammar(tmp_path / "gone.toml")
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="cannot be read"):
        load_grammar(tmp_path / "bytes.toml")
