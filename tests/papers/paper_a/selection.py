"""Paper A section 5.1.1, "Fragment Selection Algorithm": as printed, what it lacks, and the mended one."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import NoUnitError, UnitRef
from corpus_tools.fragments import build_inventory, find_spans
from corpus_tools.synthesis import greedy_as_printed, prepare_selection, select_greedy, select_viterbi
from tests.strategies.inventories import SmallPhoneSet, corpora, covered_target, recording, utterance

MANY_STEPS = 10_000


def finder(inventory, phones, single_phones: bool = True):
    """FIND-UNIT: a span of two phones or more is looked up; a single phone is there or not, as asked."""

    def find_unit(i: int, j: int) -> bool:
        if j > i:
            return len(find_spans(inventory, phones[i - 1 : j])) > 0
        return single_phones and j == i

    return find_unit


def printed_units(inventory, phones):
    """Run the printed algorithm; None when it is still at it after many steps."""
    steps = list(itertools.islice(greedy_as_printed(finder(inventory, phones), len(phones)), MANY_STEPS))
    return None if len(steps) == MANY_STEPS else [(i - 1, j - 1) for i, j, found in steps if found]


def model_of(recordings):
    return prepare_selection(build_inventory(recordings), SmallPhoneSet(), n_components=3)


@given(corpora(), st.integers(0, 1000))
def test_the_printed_algorithm_ends_and_equals_the_mended_one_when_every_diphone_is_there(recordings, seed):
    target = covered_target(recordings, np.random.default_rng(seed))
    model = model_of(recordings)
    units = printed_units(model.inventory, target.labels)
    assert units == [(c.first, c.last) for c in select_greedy(model, target).chosen]


def test_the_printed_algorithm_never_ends_when_a_diphone_is_missing():
    model = model_of([recording("a", ["SIL", "P", "A", "SIL"])])
    phones = ("SIL", "P", "A", "T", "SIL")
    assert printed_units(model.inventory, phones) is None
    steps = list(itertools.islice(greedy_as_printed(finder(model.inventory, phones), 5), 300))
    assert steps[-3:] == [(3, 5, False), (3, 4, False), (3, 3, True)]


def test_nor_does_it_where_single_phones_are_no_units():
    model = model_of([recording("a", ["SIL", "P", "A", "SIL"])])
    phones = ("SIL", "P", "A", "T", "SIL")
    calls = greedy_as_printed(finder(model.inventory, phones, single_phones=False), 5)
    *_, (i, j, found) = itertools.islice(calls, 300)
    assert i == 3
    assert j < 0
    assert not found


@pytest.mark.parametrize("search", [select_greedy, select_viterbi])
def test_the_mended_algorithm_names_the_missing_diphone_or_has_its_class_stand_in(search):
    model = model_of([recording("a", ["SIL", "P", "A", "SIL"]), recording("b", ["SIL", "A", "D", "SIL"])])
    target = utterance("t", ["SIL", "P", "A", "T", "SIL"])
    with pytest.raises(NoUnitError) as error:
        search(model, target, allow_backoff=False)
    assert error.value.diphones == (("A", "T"), ("T", "SIL"))
    chosen = search(model, target).chosen
    assert [c.unit for c in chosen] == [UnitRef("a", 0, 2), UnitRef("b", 1, 3)]
    assert [c.backoff for c in chosen] == [(), ((3, "T", "D"),)]


def test_longer_fragments_come_first():
    """ "Primarily this algorithm chooses fragments of longer duration"."""
    short = [recording(f"s{i}", ["SIL", *pair, "SIL"]) for i, pair in enumerate(["PA", "AT", "TO"])]
    model = model_of([*short, recording("long", ["SIL", "D", "P", "A", "T", "A", "SIL"])])
    chosen = select_greedy(model, utterance("t", ["SIL", "P", "A", "T", "O", "SIL"])).chosen
    assert [(c.first, c.last) for c in chosen] == [(0, 2), (2, 3), (3, 5)]
    chosen = select_greedy(model, utterance("t", ["P", "A", "T", "O", "SIL"])).chosen
    assert [c.unit for c in chosen] == [UnitRef("long", 2, 4), UnitRef("s2", 1, 3)]


def test_equal_fragments_are_told_apart_by_their_timing():
    slow = recording("slow", ["SIL", "P", "A", "SIL"], [0.1, 0.2, 0.3, 0.1])
    quick = recording("quick", ["SIL", "P", "A", "SIL"], [0.1, 0.05, 0.1, 0.1])
    model = model_of([slow, quick])
    for durations, wanted in ([0.1, 0.18, 0.28, 0.1], "slow"), ([0.1, 0.06, 0.08, 0.1], "quick"):
        (chosen,) = select_greedy(model, utterance("t", ["SIL", "P", "A", "SIL"], durations)).chosen
        assert chosen.unit.recording == wanted


def test_equal_fragments_are_told_apart_by_their_context():
    model = model_of(
        [recording("a", ["SIL", "O", "P", "A", "SIL"]), recording("b", ["SIL", "T", "P", "A", "SIL"])]
    )
    target = utterance("t", ["SIL", "D", "P", "A", "SIL"])
    chosen = next(c for c in select_greedy(model, target).chosen if c.first <= 2 < c.last)
    assert chosen.unit.recording == "b"


@given(corpora(), st.integers(0, 1000))
def test_neighbouring_fragments_share_a_phone(recordings, seed):
    """i <- j: the next unit starts where the last one ended."""
    target = covered_target(recordings, np.random.default_rng(seed))
    chosen = select_greedy(model_of(recordings), target).chosen
    assert all(a.last == b.first for a, b in itertools.pairwise(chosen))
