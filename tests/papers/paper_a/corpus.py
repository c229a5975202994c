"""Paper A section 4, "Data Description": the time grammar, 55 sentences, 66 + 7 markers at 120 Hz."""

import itertools
import math

import pytest

from corpus_tools.demo import N_SENTENCES, marker_names, time_grammar
from corpus_tools.io import find_recordings, load_capture, read_description

PROLOG = ["the time is now"]
EXACTNESS = ["exactly", "just after", "a little after", "almost"]
MINUTES = ["five past", "ten past", "quarter past", "twenty past", "twenty-five past", "half past"]
MINUTES += ["twenty-five to", "twenty to", "quarter to", "ten to", "five to"]
HOURS = ["one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve"]
DAY = ["in the morning", "in the afternoon", "am", "pm"]
EXAMPLES = [
    "the time is now exactly one in the afternoon",
    "the time is now quarter to ten in the morning",
]
STRICT = {" ".join(parts) for parts in itertools.product(PROLOG, EXACTNESS, MINUTES, HOURS, DAY)}


def test_the_grammar_has_2880_sentences_exactness_and_minutes_being_optional():
    loose = {
        " ".join(filter(None, parts))
        for parts in itertools.product(PROLOG, ["", *EXACTNESS], ["", *MINUTES], HOURS, DAY)
    }
    assert len(loose) == 2880
    assert set(time_grammar().texts()) == loose
    assert time_grammar().size == 2880 == math.prod(map(len, time_grammar().slots))


@pytest.mark.parametrize("example", EXAMPLES)
def test_it_holds_the_examples_of_the_paper_which_the_strict_reading_excludes(example):
    assert len(STRICT) == 2112
    assert example not in STRICT
    assert example in set(time_grammar().texts())
    assert set(time_grammar().texts()) > STRICT


def test_the_demo_has_fifty_five_sentences():
    assert N_SENTENCES == 55


def test_it_is_captured_as_in_the_paper(simulated_corpus):
    description = read_description(simulated_corpus)
    capture = load_capture(description, find_recordings(description)[0])
    assert capture.rate_hz == 120.0
    assert capture.names == marker_names()
    assert sum(region != "head" for region in capture.regions) == 66
    assert sum(region == "head" for region in capture.regions) == 7
    assert capture.audio is not None
