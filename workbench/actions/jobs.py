"""Long work off the page's thread: one job at a time, the newest request wins, progress and cancel."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Generic, TypeVar

from corpus_tools.core import WorkbenchError

__all__ = ["Cancelled", "Gate", "Job", "LatestJob"]

T = TypeVar("T")
Deliver = Callable[[Callable[[], None]], None]


class Cancelled(Exception):  # noqa: N818
    """Raised inside a job that nobody waits for any more."""


class Gate:
    """Keeps what is to be done for a page until the browser has the page, then does it in order.

    A change made while the page is on its way would be lost: the browser drops changes that arrive before the
    page, which may have been written down before they were made.

    Parameters
    ----------
    deliver : callable
        ``deliver(action)`` runs ``action()`` where the page's parameters may be set.
    """

    def __init__(self, deliver: Deliver) -> None:
        self._deliver = deliver
        self._lock = threading.RLock()
        self._kept: list[Callable[[], None]] | None = []

    def __call__(self, action: Callable[[], None]) -> None:
        """Deliver an action, now or when the gate opens."""
        with self._lock:
            if self._kept is not None:
                self._kept.append(action)
                return
            self._deliver(action)

    def asked(self, action: Callable[[], None]) -> None:
        """Do what the user asked for: at once when the gate is open, or when it opens."""
        with self._lock:
            if self._kept is not None:
                self._kept.append(action)
                return
        action()

    def open(self) -> None:
        """Let everything through from now on; opening it again changes nothing."""
        with self._lock:
            kept, self._kept = self._kept or [], None
            for action in kept:
                self._deliver(action)


class Job:
    """What a running job knows of itself: its number, whether to stop, where to report progress."""

    def __init__(self, number: int, report: Callable[[float, str], None]) -> None:
        self.number = number
        self._stop = threading.Event()
        self._report = report

    def cancel(self) -> None:
        """Ask the job to stop at its next check."""
        self._stop.set()

    def check(self) -> None:
        """Raise :class:`Cancelled` when the job was cancelled."""
        if self._stop.is_set():
            raise Cancelled

    def progress(self, fraction: float, what: str) -> None:
        """Report progress (0-1) and check for cancel."""
        self.check()
        self._report(fraction, what)


class LatestJob(Generic[T]):
    """Runs one job at a time in a thread; a newer request replaces one that waits.

    What a job returns, raises or reports is handed to the callbacks through `deliver`, which must run it on
    the thread of the page (or at once, in a test).

    Parameters
    ----------
    deliver : callable
        ``deliver(action)`` runs ``action()`` where parameters may be set.
    done : callable
        ``done(number, value)`` for a job that ended well.
    failed : callable
        ``failed(number, sentence)``; faults of ours are worded as such.
    report : callable, optional
        ``report(number, fraction, what)``.
    idle : callable, optional
        Called when nothing runs and nothing waits.
    """

    def __init__(
        self,
        deliver: Deliver,
        done: Callable[[int, T], Any],
        failed: Callable[[int, str], Any],
        report: Callable[[int, float, str], Any] | None = None,
        idle: Callable[[], Any] | None = None,
    ) -> None:
        self._deliver, self._done, self._failed = deliver, done, failed
        self._report, self._idle = report, idle
        self._lock = threading.Lock()
        self._number = 0
        self._running: Job | None = None
        self._waiting: tuple[Job, Callable[[Job], T]] | None = None
        self._pool = ThreadPoolExecutor(max_workers=1, thread_name_prefix="workbench-job")
        self._closed = False

    @property
    def busy(self) -> bool:
        """Whether a job runs or waits."""
        with self._lock:
            return self._running is not None

    def submit(self, work: Callable[[Job], T], cancel_running: bool = False) -> int:
        """Ask for a job; return its number.

        Parameters
        ----------
        work : callable
            ``work(job) -> value``, run in the thread.
        cancel_running : bool
            Also stop the job that runs now (another sentence); else it may end and be shown (a slider).
        """
        with self._lock:
            if self._closed:
                return self._number
            self._number += 1
            number = self._number
            job = Job(number, lambda f, w: self._tell(number, f, w))
            if self._running is None:
                self._start(job, work)
            else:
                self._waiting = (job, work)
                if cancel_running:
                    self._running.cancel()
            return number

    def cancel(self) -> None:
        """Drop what waits and stop what runs."""
        with self._lock:
            self._waiting = None
            if self._running is not None:
                self._running.cancel()

    def close(self) -> None:
        """Cancel and let the thread end."""
        self.cancel()
        with self._lock:
            self._closed = True
        self._pool.shutdown(wait=False, cancel_futures=True)

    def _tell(self, number: int, fraction: float, what: str) -> None:
        report = self._report
        if report is not None:
            self._deliver(lambda: report(number, fraction, what))

    def _start(self, job: Job, work: Callable[[Job], T]) -> None:
        self._running = job
        self._pool.submit(self._run, job, work)

    def _run(self, job: Job, work: Callable[[Job], T]) -> None:
        try:
            job.check()
            value = work(job)
            self._deliver(lambda: self._done(job.number, value))
        except Cancelled:
            pass
        except WorkbenchError as error:
            sentence = str(error)
            self._deliver(lambda: self._failed(job.number, sentence))
        except Exception as error:
            sentence = f"A fault of this program, please report it: {type(error).__name__}: {error}"
            self._deliver(lambda: self._failed(job.number, sentence))
        finally:
            self._next()

    def _next(self) -> None:
        with self._lock:
            self._running = None
            waiting, self._waiting = self._waiting, None
            if waiting is not None and not self._closed:
                self._start(*waiting)
                return
        if self._idle is not None and not self._closed:
            self._deliver(self._idle)
