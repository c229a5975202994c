"""Back-pressure: at most one change is on its way to the browser, and the latest replaces the waiting one."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

__all__ = ["AfterPainted", "LatestWins"]


class LatestWins:
    """Sends changes no faster than they are acknowledged.

    Before somebody is there to acknowledge (:meth:`ready`) changes are sent at once: they only set the state
    that the browser will begin with. A change that stays without an answer for `patience_s` (a hidden tab
    draws nothing, a closed one says nothing) no longer holds up the next.

    Parameters
    ----------
    send : callable
        ``send(number, key, change)``; numbers grow by one.
    patience_s : float, s
    now : callable
        The clock, in seconds.

    Attributes
    ----------
    dropped : int
        Changes that were replaced by a later one before they were sent.
    """

    def __init__(
        self,
        send: Callable[[int, str, Any], None],
        patience_s: float = 2.0,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._send, self._patience_s, self._now = send, patience_s, now
        self._lock = threading.RLock()
        self._number = 0
        self._flying = 0
        self._since_s = 0.0
        self._listening = False
        self._waiting: dict[str, Any] = {}
        self.dropped = 0

    @property
    def number(self) -> int:
        """Number of the last change that was sent; 0: none."""
        return self._number

    @property
    def listening(self) -> bool:
        """Whether somebody is there who acknowledges."""
        return self._listening

    @property
    def flying(self) -> bool:
        """Whether a change is on its way: somebody listens and has not acknowledged it yet."""
        return bool(self._flying)

    @property
    def waiting(self) -> bool:
        """Whether a change waits for an acknowledgement of the one before."""
        return bool(self._waiting)

    def ready(self) -> None:
        """Somebody listens from now on; what was on its way has become part of what they begin with."""
        with self._lock:
            self._listening = True
            self._flying = 0
            self._flush()

    def offer(self, key: str, change: Any) -> None:
        """Send a change, or let it wait; a waiting one of the same key is dropped."""
        with self._lock:
            self.dropped += key in self._waiting
            self._waiting[key] = change
            if not self._flying or self._now() - self._since_s > self._patience_s:
                self._flush()

    def acknowledge(self, number: int) -> None:
        """Take note that change `number`, and all before it, was painted."""
        with self._lock:
            if number >= self._flying:
                self._flying = 0
                self._flush()

    def _flush(self) -> None:
        waiting, self._waiting = self._waiting, {}
        for key, change in waiting.items():
            self._number += 1
            if self._listening:
                self._flying, self._since_s = self._number, self._now()
            self._send(self._number, key, change)


class AfterPainted:
    """Lets what can wait give way to a picture that follows a drag.

    An action runs once the picture has been painted. In a drag, when the next is asked for soon after, only
    the newest runs, when the drag pauses.

    Parameters
    ----------
    line : LatestWins
        Changes of the picture.
    deliver : callable
        ``deliver(action)`` runs ``action()`` where the page's parameters may be set.
    quiet_s : float, s
        A pause: so long nobody asks (our choice: a little more than the time between two steps of a drag).
    patience_s : float, s
        So long an action waits at most, in a drag that does not end or for a tab that paints nothing.
    """

    def __init__(
        self,
        line: LatestWins,
        deliver: Callable[[Callable[[], None]], None],
        quiet_s: float = 0.5,
        patience_s: float = 3.0,
    ) -> None:
        self._line, self._deliver = line, deliver
        self._quiet_s, self._patience_s = quiet_s, patience_s
        self._lock = threading.Lock()
        self._action: Callable[[], None] | None = None
        self._latest_s = self._quiet_from_s = self._asked_s = 0.0

    def __call__(self, action: Callable[[], None]) -> None:
        """Let an action wait for its time; it replaces one that waits."""
        with self._lock:
            now_s = time.monotonic()
            waits, self._action = self._action is not None, action
            pause = now_s - self._asked_s > self._quiet_s
            self._asked_s, self._quiet_from_s = now_s, now_s if pause else now_s + self._quiet_s
            if not waits:
                self._latest_s = now_s + self._patience_s
                self._look_after(0.0 if pause else min(self._quiet_s, self._patience_s))

    def _look_after(self, wait_s: float) -> None:
        timer = threading.Timer(wait_s, self._look)
        timer.daemon = True
        timer.start()

    def _look(self) -> None:
        """Run what waits, or look again when it may be time."""
        with self._lock:
            now_s = time.monotonic()
            quiet = now_s >= self._quiet_from_s and not self._line.flying
            if not quiet and now_s < self._latest_s:
                again_s = min(max(self._quiet_from_s, now_s + 0.02), self._latest_s)
                self._look_after(again_s - now_s)
                return
            action, self._action = self._action, None
        if action is not None:
            self._deliver(action)
