"""The corpus page: what a check found, worst first, and nothing of it invented before the check."""

import copy
import dataclasses
import re

import pytest

from corpus_tools.pipeline import check_corpus
from workbench.state import Session, corpus_facts, recording_rows
from workbench.views.corpus_page import CorpusOverview, checking_html, overview_html
from workbench.views.diphone_map import diphone_map_svg


@pytest.fixture(scope="module")
def checked(opened):
    """Return the facts of the corpus and the fractions that were told on the way; made once."""
    steps = []
    return corpus_facts(opened, lambda fraction, what: steps.append(fraction)), steps


@pytest.fixture
def facts(checked):
    """Return the facts, to be changed at will."""
    return dataclasses.replace(checked[0], health=copy.deepcopy(checked[0].health))


def test_facts_are_those_of_check_and_coverage(opened, checked, facts, corpus_folder):
    before = recording_rows(opened)
    assert {r.name for r in before} == {*opened.names, *opened.skipped}
    assert all(r.problems is None and r.gap_frames is None for r in before if r.usable)
    assert checked[1] == sorted(checked[1])
    assert facts.health == check_corpus(corpus_folder)
    rows = recording_rows(opened, facts)
    known = {r["id"]: r for r in facts.health["recordings"]}
    for row in rows:
        assert row.problems == tuple(known[row.name]["problems"])
        assert row.gap_frames == sum(b - a + 1 for a, b in known[row.name]["gaps"])
    order = [(len(r.problems), r.gap_frames) for r in rows]
    assert order == sorted(order, reverse=True)
    first, *_, last = (r.name for r in rows)
    for row in facts.health["recordings"]:
        row["problems"] = {first: [], last: ["one.", "two."]}.get(row["id"], row["problems"])
    again = [r.name for r in recording_rows(opened, facts)]
    assert (again[0], again[-1]) == (last, first)
    assert facts.cover["n_diphones"] == sum(len(r.utterance.labels) - 1 for r in opened.recordings)


def test_the_page_shows_tallies_rows_and_every_diphone(opened, facts):
    session = Session()
    assert overview_html(session) == ""
    session.opened(opened)
    assert "Checking" in checking_html(session)
    session.facts = facts
    made = overview_html(session)
    assert checking_html(session) == ""
    assert made.count('data-action="speak"') == len(opened.names)
    assert made.count("<rect") == session.facts.cover["n_diphone_types"]
    session.param.update(facts=None, check_trouble="<img src=x>")
    assert "&lt;img" in checking_html(session)


def test_worst_first_is_said_only_where_something_is_wrong(opened, facts):
    session = Session()
    session.opened(opened)
    assert "worst first" not in overview_html(session)
    for row in facts.health["recordings"]:
        row["problems"] = []
    session.facts = facts
    assert "nothing to look at; by name" in overview_html(session)
    facts.health["recordings"][3]["problems"] = ["one."]
    assert "worst first" in overview_html(session)


def test_progress_of_the_check_leaves_the_table_as_it_is(opened, facts):
    session = Session()
    page = CorpusOverview(session, on_speak=lambda recording: None)
    assert not page.checking.visible
    session.opened(opened)
    made, written = page.pane.html, []
    page.pane.param.watch(lambda event: written.append(event.new), "html", onlychanged=False)
    session.check_doing = "cleaning, 40 %"
    assert "cleaning, 40 %" in page.checking.object
    assert (page.pane.html, written) == (made, [])
    session.facts = facts
    assert not page.checking.visible
    assert len(written) == 1


def test_the_map_marks_what_was_seldom_recorded():
    made = diphone_map_svg({"A-B": 1, "B-A": 40, "<-B": 2})
    assert len(re.findall('class="few"', made)) == 2
    assert "&lt;-B: 2 recorded" in made
    assert diphone_map_svg({}).count("<rect") == 0
