"""Entry point of the console script: Ctrl-C is answered before anything heavy is imported."""

from __future__ import annotations

import os
import signal
import sys
from types import FrameType

__all__ = ["run"]

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


def _leave(signum: int, frame: FrameType | None) -> None:
    """End at once: while modules are imported there is nothing to clean up."""
    os.write(2, b"Stopped before the end: nothing was written.\n")
    os._exit(2)


def run() -> None:
    """Run ``corpus-tools``: exit 0 done, 2 wrong input or stopped, 1 a fault of this program."""
    for number in _SIGNALS:
        signal.signal(number, _leave)
    from corpus_tools.cli.common import guarded  # a second or more of imports: here, not above
    from corpus_tools.cli.main import app

    code = guarded(lambda: app(standalone_mode=True))
    for number in _SIGNALS:
        signal.signal(number, signal.SIG_IGN)  # it is done: a late Ctrl-C changes nothing any more
    sys.exit(code)
