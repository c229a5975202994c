"""The history: undo and redo walk a tree of states, and a slider is one entry."""

from hypothesis import given
from hypothesis import strategies as st

from workbench.state import Entry, History, Session, change_text
from workbench.views.history_list import history_html


def test_a_slider_that_goes_on_is_one_entry_and_a_pause_ends_it():
    history = History()
    history.record({"shape": 0.0}, 0.0)
    for step in range(1, 9):
        history.record({"shape": 0.1 * step}, 10.0 + 0.1 * step)
    assert [e.what for e in history.entries] == ["opened", "crossover +0.00 → +0.80"]
    history.record({"shape": 0.9}, 20.0)
    assert len(history.entries) == 3


def test_a_drag_of_the_own_curve_is_one_entry():
    history = History()
    history.record({"weighting": "linear", "shape": 0.2, "curve_weights": (1,)}, 0.0)
    for step in range(5):
        values = {"weighting": "user", "shape": 0.0, "curve_weights": (step, 2)}
        history.record(values, 10.0 + 0.1 * step)
    assert len(history.entries) == 2
    assert history.undo()["weighting"] == "linear"


def test_other_values_are_entries_of_their_own_however_quick():
    history = History()
    history.record({"bans": ()}, 0.0)
    history.record({"bans": ("a",)}, 0.1)
    history.record({"bans": ("a", "b")}, 0.2)
    assert len(history.entries) == 3


def test_an_equal_state_is_no_entry():
    history = History()
    assert isinstance(history.record({"rule": "paper"}, 0.0), Entry)
    assert history.record({"rule": "paper"}, 1.0) is None


def test_a_change_after_undo_keeps_the_undone_branch():
    history = History()
    for number, method in enumerate("abc"):
        history.record({"method": method}, 10.0 * number)
    assert history.undo() == {"method": "b"}
    history.record({"method": "d"}, 100.0)
    assert not history.can_redo
    assert [e.values["method"] for e in history.entries] == ["a", "b", "c", "d"]
    assert history.undo() == {"method": "b"}
    assert history.redo() == {"method": "d"}
    assert history.go(2) == {"method": "c"}


def test_the_effect_belongs_to_the_state_it_was_measured_in():
    history = History()
    history.record({"method": "a"}, 0.0)
    history.settle(1.5)
    history.record({"method": "b"}, 10.0)
    history.settle(0.8)
    history.undo()
    assert [e.effect for e in history.entries] == [1.5, 0.8]


@given(st.lists(st.tuples(st.sampled_from(["set", "undo", "redo"]), st.integers(0, 5)), max_size=40))
def test_undo_takes_back_what_redo_gave(steps):
    history, now = History(most=1000), 0.0
    history.record({"method": 0}, now)
    for what, value in steps:
        now += 10.0
        if what == "set":
            history.record({"method": value}, now)
        else:
            getattr(history, what)()
        if history.can_undo:
            here = history.at
            before = history.undo()
            assert history.redo() is not None
            history.go(here)
            assert history.undo() == before
            history.go(here)


def test_old_entries_go_first_and_undo_ends_where_they_were():
    history = History(most=3)
    for number in range(6):
        history.record({"method": number}, 10.0 * number)
    assert [e.values["method"] for e in history.entries] == [3, 4, 5]
    while history.undo() is not None:
        pass
    assert history.at == 3


@given(st.lists(st.sampled_from(["set", "undo", "redo", "go"]), max_size=30))
def test_the_line_is_what_undo_goes_through(steps):
    history = History(most=1000)
    history.record({"method": 0}, 0.0)
    for now, what in enumerate(steps, 1):
        if what == "set":
            history.record({"method": now}, 10.0 * now)
        elif what == "go":
            history.go(now // 2)
        else:
            getattr(history, what)()
    line, met = history.line, {history.at}
    while history.undo() is not None:
        met.add(history.at)
    assert line == met


def test_undone_states_are_struck_out_and_the_present_one_is_marked():
    session = Session(weighting="linear")
    session.begin_history()
    for name in ("septic", "bump"):
        session.weighting = name
    session.undo()
    session.weighting = "sigmoid"
    rows = history_html(session).split("<tr")[2:]
    assert ["<s>" in row for row in rows] == [False, True, False, False]
    assert ["▸" in row for row in rows] == [True, False, False, False]
    assert "undone: g(u) septic → bump" in rows[1]


def test_changes_are_told_in_words():
    text = change_text({"overlap_s": 0.12, "method": "viterbi"}, {"overlap_s": 0.08, "method": "greedy"})
    assert text == "method viterbi → greedy, overlap 120 ms → 80 ms"
    assert change_text({"rule": "paper"}, {"rule": "paper"}) == ""


def test_an_exchanged_pin_is_one_change_and_pins_of_another_target_are_none():
    one, two = {"pins": ("0-2=a:1-3",)}, {"pins": ("0-2=b:4-6",)}
    assert change_text(one, two, ("SIL", "K", "AH")) == "pin SIL–AH → b:4-6"
    assert change_text(one, two) == "pin phones 0–2 → b:4-6"
    other = {"sentence": "y", "pins": ()}
    assert change_text({"sentence": "x", **one}, other) == "sentence x → y"
