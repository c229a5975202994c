"""Back-pressure between Python and the browser, driven by a browser that acknowledges when it likes."""

import threading

from hypothesis import given
from hypothesis import strategies as st

from workbench.views.latest import AfterPainted, LatestWins


class Line:
    def __init__(self, patience_s=2.0):
        self.sent, self.now = [], 0.0
        self.line = LatestWins(
            lambda n, key, change: self.sent.append((n, key, change)), patience_s, self.time
        )

    def time(self):
        return self.now


def test_before_anybody_listens_changes_are_sent_at_once():
    made = Line()
    for value in range(3):
        made.line.offer("motion", value)
    assert made.sent == [(1, "motion", 0), (2, "motion", 1), (3, "motion", 2)]


def test_one_is_on_its_way_and_the_latest_replaces_the_waiting_one():
    made = Line()
    made.line.ready()
    for value in range(5):
        made.line.offer("motion", value)
    assert made.sent == [(1, "motion", 0)]
    assert made.line.waiting
    assert made.line.dropped == 3
    made.line.acknowledge(1)
    assert made.sent[1:] == [(2, "motion", 4)]
    made.line.acknowledge(2)
    made.line.offer("motion", 5)
    assert made.sent[-1] == (3, "motion", 5)


def test_an_old_acknowledgement_releases_nothing():
    made = Line()
    made.line.offer("motion", 0)
    made.line.ready()
    made.line.offer("motion", 1)
    made.line.offer("motion", 2)
    made.line.acknowledge(1)
    assert [c for _, _, c in made.sent] == [0, 1]


def test_changes_of_different_actors_do_not_replace_one_another():
    made = Line()
    made.line.ready()
    for key in ("skin", "skin", "dots", "dots"):
        made.line.offer(key, key)
    made.line.acknowledge(1)
    assert [(n, key) for n, key, _ in made.sent] == [(1, "skin"), (2, "skin"), (3, "dots")]
    made.line.acknowledge(2)
    made.line.offer("skin", 0)
    assert len(made.sent) == 3
    made.line.acknowledge(3)
    assert made.sent[-1] == (4, "skin", 0)


def test_a_browser_that_never_answers_does_not_stop_the_line():
    made = Line(patience_s=2.0)
    made.line.ready()
    made.line.offer("motion", 0)
    made.now = 1.9
    made.line.offer("motion", 1)
    assert len(made.sent) == 1
    made.now = 2.1
    made.line.offer("motion", 2)
    assert [c for _, _, c in made.sent] == [0, 2]


@given(st.lists(st.sampled_from(["offer", "ack"]), max_size=40))
def test_the_last_offer_always_arrives_and_never_two_fly(steps):
    made = Line()
    made.line.ready()
    painted = offered = 0
    for step in steps:
        if step == "offer":
            offered += 1
            made.line.offer("motion", offered)
        elif painted < len(made.sent):
            painted += 1
            made.line.acknowledge(made.sent[painted - 1][0])
        assert len(made.sent) - painted <= 1
    while painted < len(made.sent):
        painted += 1
        made.line.acknowledge(made.sent[painted - 1][0])
    assert not made.line.waiting
    assert (made.sent[-1][2] if made.sent else 0) == offered
    assert made.line.dropped + len(made.sent) == offered


def waits_of(made, **times):
    done, ran = [], threading.Event()

    def deliver(action):
        action()
        ran.set()

    return done, ran, AfterPainted(made.line, deliver, **times)


def test_what_can_wait_runs_once_the_picture_is_painted_and_only_the_newest():
    made = Line()
    done, ran, after = waits_of(made, quiet_s=0.02, patience_s=30)
    made.line.ready()
    made.line.offer("motion", 0)
    after(lambda: done.append("old"))
    after(lambda: done.append("new"))
    assert not ran.wait(0.15)
    made.line.acknowledge(1)
    assert ran.wait(5)
    assert done == ["new"]


def test_it_waits_while_others_are_asked_for_but_not_for_ever():
    made = Line()
    done, ran, after = waits_of(made, quiet_s=5.0, patience_s=0.2)
    after(lambda: done.append("first"))
    assert ran.wait(3)
    ran.clear()
    for number in range(5):
        after(lambda number=number: done.append(number))
    assert done == ["first"]
    assert ran.wait(3)
    assert done == ["first", 4]


def test_what_waits_for_a_tab_that_paints_nothing_runs_all_the_same():
    made = Line()
    made.line.ready()
    made.line.offer("motion", 0)
    done, ran, after = waits_of(made, quiet_s=0.01, patience_s=0.05)
    after(lambda: done.append("shown"))
    assert ran.wait(5)
    assert done == ["shown"]
