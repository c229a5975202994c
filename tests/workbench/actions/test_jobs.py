"""Jobs: the newest request wins, cancel stops, errors become one sentence."""

import queue
import threading

import pytest

from corpus_tools.core import InputError
from workbench.actions import Gate, LatestJob


class Page:
    """Collects what is delivered and runs it on the test's thread."""

    def __init__(self):
        self.waiting = queue.Queue()
        self.done, self.failed, self.reports, self.idle = [], [], [], 0
        self.jobs = LatestJob(
            self.waiting.put,
            lambda n, v: self.done.append((n, v)),
            lambda n, t: self.failed.append((n, t)),
            lambda n, f, w: self.reports.append((n, f, w)),
            self._rest,
        )

    def _rest(self):
        self.idle += 1

    def run_until(self, condition, timeout_s=5.0):
        while not condition():
            self.waiting.get(timeout=timeout_s)()


@pytest.fixture
def page():
    made = Page()
    yield made
    made.jobs.close()


def test_a_result_is_delivered_on_the_page(page):
    page.jobs.submit(lambda job: 7)
    assert page.done == []
    page.run_until(lambda: page.idle)
    assert page.done == [(1, 7)]


def test_the_newest_request_replaces_those_that_wait(page):
    gate, started = threading.Event(), threading.Event()

    def first(job):
        started.set()
        gate.wait(5)
        return "first"

    page.jobs.submit(first)
    started.wait(5)
    ran = []
    for number in range(2, 12):
        page.jobs.submit(lambda job, n=number: ran.append(n) or n)
    gate.set()
    page.run_until(lambda: page.idle)
    assert page.done == [(1, "first"), (11, 11)]
    assert ran == [11]


def test_cancel_stops_a_running_job_and_nothing_arrives(page):
    started = threading.Event()

    def endless(job):
        started.set()
        while True:
            job.progress(0.5, "working")

    page.jobs.submit(endless)
    started.wait(5)
    page.jobs.cancel()
    page.run_until(lambda: page.idle)
    assert page.done == []
    assert page.failed == []
    assert not page.jobs.busy


def test_another_sentence_cancels_the_job_that_runs(page):
    started = threading.Event()

    def endless(job):
        started.set()
        while True:
            job.check()

    page.jobs.submit(endless)
    started.wait(5)
    page.jobs.submit(lambda job: "new", cancel_running=True)
    page.run_until(lambda: page.idle)
    assert page.done == [(2, "new")]


def test_a_mistake_is_one_sentence_and_a_fault_says_so(page):
    def wrong(job):
        raise InputError("There is no method called 'x'.")

    def broken(job):
        raise ZeroDivisionError("division by zero")

    page.jobs.submit(wrong)
    page.run_until(lambda: page.idle == 1)
    page.jobs.submit(broken)
    page.run_until(lambda: page.idle == 2)
    assert page.failed[0] == (1, "There is no method called 'x'.")
    assert page.failed[1][1].startswith("A fault of this program")
    assert "ZeroDivisionError" in page.failed[1][1]


def test_after_close_nothing_starts(page):
    page.jobs.close()
    page.jobs.submit(lambda job: 1)
    assert page.done == []
    assert not page.jobs.busy


def test_a_gate_keeps_the_order_and_lets_nothing_through_before_it_opens():
    done = []
    gate = Gate(lambda action: action())
    gate(lambda: done.append(1))
    gate(lambda: (done.append(2), gate(lambda: done.append(3))))
    assert done == []
    gate.open()
    assert done == [1, 2, 3]
    gate(lambda: done.append(4))
    gate.open()
    assert done == [1, 2, 3, 4]


def test_what_the_user_asks_for_waits_for_the_gate_and_is_then_done_at_once():
    done, delivered = [], []
    gate = Gate(delivered.append)
    gate.asked(lambda: done.append(1))
    gate.open()
    assert done == []
    delivered.pop()()
    gate.asked(lambda: done.append(2))
    assert (done, delivered) == ([1, 2], [])
