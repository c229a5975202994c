"""Stopping by a signal, from the first moment on: what is told while libraries still start is not lost."""

from __future__ import annotations

import signal
import threading
from types import FrameType, TracebackType
from typing import Any

__all__ = ["StoppedBySignal"]

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


class StoppedBySignal:
    """Takes note of Ctrl-C and of a termination signal while it is entered; serves until one of them came.

    The signals are noted and never raised: an exception in the middle of an import, or of a callback of the
    server, would be swallowed there. Outside the main thread, where Python allows no handlers, none is noted.

    Parameters
    ----------
    noted : bool
        False leaves the handlers as they are.
    """

    def __init__(self, noted: bool = True) -> None:
        self._noted = noted and threading.current_thread() is threading.main_thread()
        self._told = False
        self._loop: Any = None
        self._before: dict[int, Any] = {}

    def __enter__(self) -> StoppedBySignal:
        self._listen()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _listen(self) -> None:
        for number in _SIGNALS if self._noted else ():
            handler = signal.signal(number, self._note)
            self._before.setdefault(number, handler)

    def _note(self, number: int, frame: FrameType | None) -> None:
        self._told = True
        if self._loop is not None:
            self._loop.asyncio_loop.call_soon_threadsafe(self._loop.stop)

    def run(self, server: Any) -> None:
        """Serve until a signal came; at once back when one came before.

        Parameters
        ----------
        server : panel.io.server.Server
            Made, and not started yet.
        """
        self._loop = server.io_loop
        self._listen()  # making a server puts a handler of its own in the place of ours
        if not self._told:
            server.start()
            server.io_loop.start()
