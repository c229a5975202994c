import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import CorpusError, Interval, LabelError, Recording, Tier, Utterance
from corpus_tools.fragments import build_inventory, find_spans
from tests.strategies.inventories import capture, corpora, recording, simulated_recordings


def spans_by_hand(recordings, phones, exclude=()):
    """Find a run of phones by looking at every place of every recording."""
    found = []
    for item in sorted(recordings, key=lambda r: r.name):
        labels = item.utterance.labels
        for first in range(len(labels) - len(phones) + 1):
            if item.name not in exclude and labels[first : first + len(phones)] == tuple(phones):
                found.append((item.name, first))
    return found


@given(corpora(), st.data())
def test_every_span_is_found_where_it_is_and_nowhere_else(recordings, data):
    inventory = build_inventory(recordings)
    item = data.draw(st.sampled_from(recordings))
    first = data.draw(st.integers(0, len(item.utterance.labels) - 2))
    last = data.draw(st.integers(first + 1, len(item.utterance.labels) - 1))
    exclude = data.draw(st.sets(st.sampled_from([r.name for r in recordings])))
    wanted = item.utterance.labels[first : last + 1]
    rows = find_spans(inventory, wanted, exclude)
    units = [inventory.unit(int(r), int(r) + len(wanted) - 1) for r in rows]
    assert [(u.recording, u.first) for u in units] == spans_by_hand(recordings, wanted, exclude)
    assert [inventory.rows(u)[0] for u in units] == rows.tolist()


@given(corpora(least=2))
def test_no_unit_reaches_from_one_recording_into_the_next(recordings):
    inventory = build_inventory(recordings)
    last_rows = inventory.offsets[1:] - 1
    assert (inventory.keys[last_rows] == -1).all()
    assert np.count_nonzero(inventory.keys == -1) == len(recordings)
    assert len(find_spans(inventory, ["SIL", "SIL"])) == 0


def test_the_order_of_files_does_not_matter():
    recordings = simulated_recordings(6, 3)
    one, other = build_inventory(recordings), build_inventory(recordings[::-1])
    assert [r.name for r in one.recordings] == [r.name for r in other.recordings]
    np.testing.assert_array_equal(one.keys, other.keys)
    np.testing.assert_array_equal(one.order, other.order)


def test_a_pause_without_label_is_no_transition():
    phones = Tier("phones", (Interval(0, 0.1, "A"), Interval(0.3, 0.4, "P"), Interval(0.4, 0.5, "A")))
    spoken = Utterance("gap", "", phones)
    inventory = build_inventory([Recording(spoken, capture(spoken, np.random.default_rng(0)))])
    assert len(find_spans(inventory, ["A", "P"])) == 0
    assert find_spans(inventory, ["P", "A"]).tolist() == [1]


def test_many_phones_are_sorted_as_well_as_few():
    few = build_inventory(simulated_recordings(5, 1))
    many = build_inventory(simulated_recordings(5, 1), [*few.phone_set, *(f"x{i}" for i in range(200))])
    np.testing.assert_array_equal(few.order, many.order)


def test_a_phone_outside_the_set_is_named_with_a_suggestion():
    with pytest.raises(LabelError, match="'P' is not in the phone set"):
        build_inventory([recording("a", ["SIL", "P", "SIL"])], ["SIL", "A"])


def test_nothing_and_the_same_name_twice_are_refused():
    with pytest.raises(CorpusError, match="no labelled recording"):
        build_inventory([])
    with pytest.raises(CorpusError, match="'a'"):
        build_inventory([recording("a", ["SIL", "P", "SIL"]), recording("a", ["SIL", "T", "SIL"])])


def test_one_phone_is_no_unit():
    with pytest.raises(LabelError, match="at least two"):
        find_spans(build_inventory(simulated_recordings(2)), ["P"])


def test_membership_of_recordings():
    inventory = build_inventory([recording("a", ["SIL", "P", "SIL"])])
    assert "a" in inventory
    assert "b" not in inventory
