"""A tab goes on where it was: what is kept of a session gives the same session, and only that is read."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.config import config_with
from workbench.actions import Journal, journal_folder
from workbench.state import Session, default_config, resume, session_record

TAB, OTHER = "0123456789abcdef", "fedcba9876543210"
STEPS = {
    "g": lambda s, n: setattr(s, "weighting", ("linear", "septic", "user")[n]),
    "shape": lambda s, n: setattr(s, "shape", 0.25 * n),
    "pins": lambda s, n: setattr(s, "pins", (f"{n}-{n + 1}=time02:3-4",)),
    "bans": lambda s, n: setattr(s, "bans", (f"time0{n + 3}",)),
    "sentence": lambda s, n: setattr(s, "sentence", s.sentences[n]),
    "text": lambda s, n: s.param.update(target_kind="text", text="the time is two"),
    "undo": lambda s, n: s.undo(),
    "keep": lambda s, n: s.keep_as_a(),
    "config": lambda s, n: s.take_config(config_with(default_config(), rest__ease_s=0.1 * n), {}, "config"),
}


def session_of(opened, folder="/c"):
    session = Session(folder=folder)
    session.opened(opened)
    return session


def at_once(action):
    action()


@given(steps=st.lists(st.tuples(st.sampled_from(sorted(STEPS)), st.integers(0, 2)), max_size=8))
def test_a_record_gives_the_same_session_with_its_history_and_a(opened, steps):
    session = session_of(opened)
    for name, n in steps:
        STEPS[name](session, n)
    again = session_of(opened)
    assert resume(again, json.loads(json.dumps(session_record(session))))
    assert (again.values, again.config, again.kept) == (session.values, session.config, session.kept)
    assert again.difference == session.difference
    assert [e.what for e in again.history.entries] == [e.what for e in session.history.entries]
    assert again.history.at == session.history.at
    assert again.undo() == session.undo()
    assert again.values == session.values
    again.weighting = "bump"
    assert again.history.entries[-1].number not in {e.number for e in session.history.entries}


@pytest.mark.parametrize(
    "spoil",
    [
        lambda r: r.update(layout=0),
        lambda r: r.pop("entries"),
        lambda r: r.update(at=77),
        lambda r: r["entries"][-1]["values"].update(sentence="nobody"),
        lambda r: r["entries"][-1]["values"].update(shape=5.0),
        lambda r: r["entries"][-1]["values"].pop("pins"),
        lambda r: r["bases"][0].update(blend={"weighting": 3}),
    ],
)
def test_a_record_that_does_not_fit_changes_nothing(opened, spoil):
    session = session_of(opened)
    session.weighting = "linear"
    record = json.loads(json.dumps(session_record(session)))
    spoil(record)
    again = session_of(opened)
    before = again.values
    assert not resume(again, record)
    assert again.values == before


def test_each_tab_and_each_home_has_its_own_file(opened, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    assert journal_folder().is_relative_to(tmp_path)
    session, other = session_of(opened), session_of(opened)
    one, two = Journal(session, "home", at_once), Journal(other, "home", at_once)
    assert one.begin(TAB) is None
    assert two.begin(OTHER) is None
    session.weighting = "linear"
    other.weighting = "septic"
    while one.busy or two.busy:
        pass
    for tab, home, earlier, name in (
        (TAB, "home", "", "linear"),
        (OTHER, "home", "", "septic"),
        ("a" * 32, "home", TAB, "linear"),
        (TAB, "another", "", None),
        ("../../x" + TAB, "home", "", None),
    ):
        found = Journal(session_of(opened), home, at_once).begin(tab, earlier)
        again = session_of(opened)
        assert (found is not None and resume(again, found) and again.weighting) == (name or False)


def test_a_damaged_file_is_none(tmp_path, monkeypatch, opened):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    session = session_of(opened)
    journal = Journal(session, "home", at_once)
    journal.begin(TAB)
    session.weighting = "linear"
    while journal.busy:
        pass
    (path,) = journal_folder().iterdir()
    path.write_text(path.read_text()[:100])
    assert Journal(session, "home", at_once).begin(TAB) is None


def test_a_config_is_one_change_and_pins_of_the_sentence_before_come_back(opened):
    session = session_of(opened)
    session.pins = ("0-1=time02:3-4",)
    before, n = session.values, len(session.history.entries)
    config = config_with(
        default_config(), blend__weighting="bump", overrides__bans=["time05"], rest__ease_s=0.3
    )
    session.take_config(config, {"sentence": opened.names[3]}, "config a.toml")
    assert session.config == config
    assert session.sentence == opened.names[3]
    assert [e.what for e in session.history.entries[n:]] == ["config a.toml"]
    assert session.undo()
    assert session.values == before
    assert session.config.rest.ease_s == default_config().rest.ease_s
