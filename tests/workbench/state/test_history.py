"""The history: undo and redo walk a tree of states, and a slider is one entry."""

from hypothesis import given
from hypothesis import strategies as st

from workbench.state import Entry, History, change_text


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


def test_changes_are_told_in_words():
    text = change_text({"overlap_s": 0.12, "method": "viterbi"}, {"overlap_s": 0.08, "method": "greedy"})
    assert text == "method viterbi → greedy, overlap 120 ms → 80 ms"
    assert change_text({"rule": "paper"}, {"rule": "paper"}) == ""
