"""Child processes that answer one request each: no hang, nothing left behind, one silent second try."""

from __future__ import annotations

import atexit
import contextlib
import json
import subprocess
import threading
from collections.abc import Mapping, Sequence
from typing import Any

from corpus_tools.core import EngineError
from corpus_tools.speech.engines.espeak_worker import read_message, write_message

__all__ = ["Child", "ChildDiedError", "Children"]


class ChildDiedError(Exception):
    """The child ended before it had answered."""


class Child:
    """One process and the private pipe to it.

    Parameters
    ----------
    command : sequence of str
    """

    def __init__(self, command: Sequence[str]) -> None:
        self.process = subprocess.Popen(
            list(command), stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
        )

    @property
    def alive(self) -> bool:
        """Whether the process still runs."""
        return self.process.poll() is None

    def ask(self, request: Mapping[str, Any], limit_s: float) -> tuple[dict[str, Any], bytes]:
        """Send a request, return the answer and its data, and end the process.

        Raises
        ------
        TimeoutError
            No answer within `limit_s`; the process has been killed.
        ChildDiedError
            The process ended, or what it sent was no answer.
        """
        late = threading.Event()

        def give_up() -> None:
            late.set()
            self.process.kill()

        timer = threading.Timer(limit_s, give_up)
        timer.daemon = True
        timer.start()
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        try:
            write_message(self.process.stdin, json.dumps(request).encode())
            return json.loads(read_message(self.process.stdout)), read_message(self.process.stdout)
        except (EOFError, OSError, ValueError) as error:
            if late.is_set():
                raise TimeoutError from None
            raise ChildDiedError(str(error)) from None
        finally:
            timer.cancel()
            self.close()

    def close(self) -> None:
        """End the process if it still runs, and forget it."""
        for pipe in (self.process.stdin, self.process.stdout):
            if pipe is not None:
                with contextlib.suppress(OSError):
                    pipe.close()
        if self.alive:
            self.process.kill()
        self.process.wait()


class Children:
    """Starts a child for each request; who asks twice finds the next one ready.

    After a fork the waiting child is not one of the new process, counts as ended there, and is left alone.

    Parameters
    ----------
    command : sequence of str
    what : str
        Who answers, in the words of a message.
    """

    def __init__(self, command: Sequence[str], what: str) -> None:
        self.command = tuple(command)
        self.what = what
        self._lock = threading.Lock()
        self._spare: Child | None = None
        self._asked = False
        atexit.register(self.close)

    def prepare(self) -> None:
        """Start the next child now, so that it is ready when it is asked."""
        with self._lock:
            if self._spare is None:
                self._spare = Child(self.command)

    def _take(self) -> Child:
        with self._lock:
            child, self._spare = self._spare, None
        if child is not None and not child.alive:
            child.close()
            child = None
        return child or Child(self.command)

    def ask(self, request: Mapping[str, Any], limit_s: float) -> tuple[dict[str, Any], bytes]:
        """Return the answer to a request; a child that dies is replaced once, silently.

        Raises
        ------
        EngineError
            Two children ended before they had answered, or one did not answer in time.
        """
        again, self._asked = self._asked, True
        for _ in range(2):
            child = self._take()
            if again:
                self.prepare()
            try:
                return child.ask(request, limit_s)
            except TimeoutError:
                raise EngineError(
                    f"{self.what} did not answer within {limit_s:g} s and was stopped; "
                    "try again, or speak a shorter text."
                ) from None
            except ChildDiedError:
                continue
        raise EngineError(
            f"The process of {self.what} ended twice before it had answered; "
            "try again, and check that nothing stops it and that memory is left."
        )

    def close(self) -> None:
        """End the child that waits, if there is one."""
        with self._lock:
            child, self._spare = self._spare, None
        if child is not None:
            child.close()
