import itertools
import json

import numpy as np
import pytest
from hypothesis import given

from corpus_tools.core import InputError, Interval, Tier
from corpus_tools.fragments import build_inventory, coverage, unit_views
from tests.strategies.inventories import corpora, recording, targets, utterance


@given(corpora())
def test_leave_one_out_counts_only_the_others(recordings):
    report = coverage(build_inventory(recordings), [r.utterance for r in recordings])
    for item, found in zip(recordings, report.utterances, strict=True):
        elsewhere = {
            pair for r in recordings if r.name != item.name for pair in itertools.pairwise(r.utterance.labels)
        }
        own = list(itertools.pairwise(item.utterance.labels))
        assert found.share == pytest.approx(np.mean([pair in elsewhere for pair in own]))
        assert set(found.missing) == set(own) - elsewhere
        assert len(set(found.missing)) == len(found.missing)


@given(corpora())
def test_with_itself_in_the_corpus_a_sentence_is_covered(recordings):
    inventory = build_inventory(recordings)
    report = coverage(inventory, [r.utterance for r in recordings], leave_one_out=False)
    assert report.as_dict()["n_full"] == len(recordings)
    assert report.counts.sum() == sum(len(r.utterance.labels) - 1 for r in recordings)


@given(corpora(), targets())
def test_missing_diphones_are_named_in_order(recordings, target):
    there = {pair for r in recordings for pair in itertools.pairwise(r.utterance.labels)}
    wanted = dict.fromkeys(p for p in itertools.pairwise(target.labels) if p not in there)
    (covered,) = coverage(build_inventory(recordings), [target], leave_one_out=False).utterances
    assert covered.missing == tuple(wanted)


def test_the_report_is_json_and_says_what_to_record_first():
    inventory = build_inventory([recording("a", ["SIL", "P", "A", "SIL"])])
    wanted = [utterance("x", ["SIL", "T", "A", "SIL"]), utterance("y", ["SIL", "T", "P", "SIL"])]
    data = json.loads(json.dumps(coverage(inventory, wanted).as_dict()))
    assert next(iter(data["missing"].items())) == ("SIL-T", 2)
    assert data["n_diphone_types"] == 3
    assert data["mean"] == pytest.approx((1 / 3 + 0) / 2)
    assert data["utterances"][0] == {"id": "x", "coverage": pytest.approx(1 / 3), "missing": ["SIL-T", "T-A"]}


def test_no_utterance_and_too_short_a_one_are_refused():
    inventory = build_inventory([recording("a", ["SIL", "P", "SIL"])])
    with pytest.raises(InputError, match="no utterance"):
        coverage(inventory, [])
    with pytest.raises(InputError, match="'x'"):
        coverage(inventory, [utterance("x", ["SIL"])])


def test_views_of_the_paper_count_sentences_words_and_diphones():
    words = Tier("words", (Interval(0.1, 0.4, "pat"), Interval(0.4, 0.5, "a"), Interval(0.5, 0.7, " ")))
    spoken = recording("a", ["SIL", "P", "A", "T", "A", "SIL", "SIL"], words=words)
    views = unit_views(build_inventory([spoken, recording("b", ["SIL", "P", "A", "SIL"])]))
    assert [u.key for u in views.sentences] == ["a:0-6", "b:0-3"]
    assert {w: [u.key for u in units] for w, units in views.words.items()} == {"pat": ["a:1-3"]}
    assert views.diphones["P", "A"] == 2
    data = views.as_dict()
    assert data["diphone_units"] == 9
    assert data["all_spans"] == 6 * 7 // 2 + 3 * 4 // 2
    assert json.loads(json.dumps(data)) == data
