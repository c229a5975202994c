"""Paper A section 5.1: "diphone, syllable, word, and sentence fragments are extracted"."""

import itertools

from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import Interval, Labels, Recording, Tier
from corpus_tools.fragments import build_inventory, find_spans, unit_views
from corpus_tools.speech import phone_set, recorded_utterance
from corpus_tools.synthesis import prepare_selection, select_greedy, select_viterbi
from tests.strategies.inventories import SmallPhoneSet, corpora, recording


@given(corpora())
def test_every_sentence_and_every_diphone_of_the_recordings_is_a_unit(recordings):
    views = unit_views(build_inventory(recordings))
    assert len(views.sentences) == len(recordings)
    pairs = [p for r in recordings for p in itertools.pairwise(r.utterance.labels)]
    assert sum(views.diphones.values()) == len(pairs)
    assert set(views.diphones) == set(pairs)


def test_words_are_units_from_the_first_phone_to_the_last():
    words = Tier("words", (Interval(0.1, 0.4, "pat"), Interval(0.4, 0.6, "to")))
    inventory = build_inventory([recording("a", ["SIL", "P", "A", "T", "T", "O", "SIL"], words=words)])
    views = unit_views(inventory)
    assert {w: [u.key for u in units] for w, units in views.words.items()} == {
        "pat": ["a:1-3"],
        "to": ["a:4-5"],
    }
    assert len(find_spans(inventory, ["P", "A", "T"])) == 1


def test_syllables_are_units_within_their_word():
    phones = ["SIL", "AH", "W", "EY", "EH", "K", "S", "T", "R", "AH", "SIL"]
    rows = tuple(Interval(0.1 * k, 0.1 * (k + 1), p) for k, p in enumerate(phones))
    words = Tier("words", (Interval(0.1, 0.4, "away"), Interval(0.4, 1.0, "extra")))
    labels = Labels((Tier("phones", rows), words), 0.0, 1.1)
    spoken = recorded_utterance("a", labels, None, phone_set("arpabet"))
    inventory = build_inventory([Recording(spoken, recording("a", ["SIL", "P", "SIL"]).capture)])
    views = unit_views(inventory)
    assert {s: [u.key for u in units] for s, units in views.syllables.items()} == {
        "W-EY": ["a:2-3"],
        "EH-K": ["a:4-5"],
        "S-T-R-AH": ["a:6-9"],
    }
    assert len(find_spans(inventory, ["S", "T", "R", "AH"])) == 1


@given(corpora(least=2), st.integers(0, 1000))
def test_larger_fragments_leave_fewer_joins_than_diphones_alone(recordings, seed):
    """ "larger fragments produce more natural animation": nothing captured is cut that need not be."""
    model = prepare_selection(build_inventory(recordings), SmallPhoneSet(), n_components=3)
    target = recordings[seed % len(recordings)].utterance
    joins = {len(search(model, target).chosen) - 1 for search in (select_greedy, select_viterbi)}
    assert max(joins) <= len(target.phones) - 2  # what diphones alone would have
    assert len(select_greedy(model, target).chosen) == 1  # the whole sentence was recorded
