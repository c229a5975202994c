"""Diphones that the corpus does not have are named, with what stood in."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.config import Config
from corpus_tools.core import ChosenUnit, Costs, Interval, Selection, Tier, UnitRef, Utterance
from corpus_tools.pipeline import select_units
from corpus_tools.speech import phone_set, speak_text
from corpus_tools.synthesis import stand_ins

ARPABET = phone_set("arpabet")
LABELS = ("SIL", "B", "UW", "N", "SIL")


def utterance(labels=LABELS):
    rows = tuple(Interval(0.1 * k, 0.1 * (k + 1), p) for k, p in enumerate(labels))
    return Utterance("x", "", Tier("phones", rows))


def chosen(first, last, *backoff):
    return ChosenUnit(first, last, UnitRef("r", 3, 3 + last - first), Costs(), backoff)


def test_a_stand_in_names_what_was_wanted_and_what_was_used():
    selection = Selection("x", "viterbi", (chosen(0, 2, (1, "B", "P")), chosen(2, 4)))
    found = stand_ins(selection, utterance(), ARPABET)
    assert [f.sentence for f in found] == [
        "No usable unit has SIL-B: SIL-P stood in",
        "No usable unit has B-UW: P-UW stood in",
    ]
    assert [round(f.time_s, 6) for f in found] == [0.1, 0.2]
    assert {f.source for f in found} == {"r:3-5"}


@pytest.mark.parametrize(
    ("used", "told"),
    [
        (((1, "B", "N"),), "; its lips differ: B closes the lips"),
        (((1, "B", "F"),), "; its lips differ: B closes the lips"),
        (((3, "N", "V"),), "; its lips differ: V puts the lip on the teeth"),
        (((2, "UW", "IY"),), "; its lips differ: UW rounds the lips"),
        (((2, "UW", "OW"),), "; OW does not look like UW"),
        (((2, "UW", "W"),), ""),
        (((3, "N", "T"),), ""),
    ],
)
def test_lips_and_visemes_that_differ_are_told(used, told):
    found = stand_ins(Selection("x", "viterbi", (chosen(0, 4, *used),)), utterance(), ARPABET)
    assert len(found) == 2
    for item in found:
        assert (
            item.sentence
            == f"No usable unit has {'-'.join(item.diphone)}: {'-'.join(item.used)} stood in{told}"
        )


@given(st.sets(st.integers(0, 4)))
def test_every_diphone_that_touches_a_substitute_and_no_other_is_named(places):
    swaps = tuple((k, LABELS[k], "ZH") for k in sorted(places))
    found = stand_ins(Selection("x", "viterbi", (chosen(0, 4, *swaps),)), utterance(), ARPABET)
    wanted = [k for k in range(4) if {k, k + 1} & places]
    assert [f.diphone for f in found] == [(LABELS[k], LABELS[k + 1]) for k in wanted]


def test_on_a_corpus_the_named_diphones_are_those_that_its_index_lacks(opened_corpus):
    spoken = speak_text("boys enjoy joyful noise", opened_corpus.phones)
    have = {pair for r in opened_corpus.recordings for pair in itertools.pairwise(r.utterance.labels)}
    for method in ("greedy", "viterbi"):
        config = Config.model_validate({"selection": {"method": method}})
        found = stand_ins(select_units(opened_corpus, spoken, config), spoken, opened_corpus.phones)
        assert found
        wanted = set(itertools.pairwise(spoken.labels)) - have
        assert {f.diphone for f in found} == wanted
        assert {f.used for f in found} <= have
