"""A server that tests started: wait until it answers."""

from __future__ import annotations

import time
import urllib.request

__all__ = ["wait_until_answers"]


def wait_until_answers(url: str, timeout_s: float = 60.0) -> None:
    """Ask for an address until it answers."""
    until = time.monotonic() + timeout_s
    while True:
        try:
            urllib.request.urlopen(url, timeout=5).close()
            return
        except OSError:
            assert time.monotonic() < until, f"{url} does not answer"
            time.sleep(0.05)
