"""A check that the workbench really starts: serve, open a session, wait for the motion, stop."""

from __future__ import annotations

import logging
import re
import time
import urllib.request
from dataclasses import dataclass, replace

from bokeh.client import pull_session
from bokeh.util.token import get_session_id

from corpus_tools.core import WorkbenchError
from workbench.apps.blend import BlendPage
from workbench.apps.options import Options, free_port
from workbench.apps.serving import Workbench

__all__ = ["CheckReport", "check_run"]

_TOKEN = re.compile(r'"token":"([^"]+)"')


@dataclass(frozen=True, slots=True)
class CheckReport:
    """What a check found: the corpus, the sentence shown, frames of motion, and how long things took."""

    url: str
    corpus: str
    sentence: str
    n_frames: int
    page_s: float
    ready_s: float


def _session_of_page(url: str, until: float) -> str:
    """Ask for the page until it answers; return the id of the session it would open its websocket for."""
    while True:
        try:
            with urllib.request.urlopen(url, timeout=30) as answer:
                found = _TOKEN.search(answer.read().decode("utf-8"))
        except OSError:
            if time.monotonic() > until:
                raise WorkbenchError(
                    "The workbench did not start: the page did not answer in time."
                ) from None
            time.sleep(0.05)
            continue
        if found is None:
            raise WorkbenchError("The workbench did not start: its page opens no session.")
        return str(get_session_id(found[1]))


def _wait_for_motion(page: BlendPage, until: float) -> None:
    session = page.session
    while session.result is None or not page.board.lane.score["fragments"]:
        if session.trouble or session.message:
            raise WorkbenchError(session.trouble or session.message)
        if time.monotonic() > until:
            raise WorkbenchError("The workbench did not start: no motion was shown in time.")
        time.sleep(0.05)


def check_run(options: Options, timeout_s: float = 180.0) -> CheckReport:
    """Start, open one session over the websocket, wait for its motion, and stop.

    Parameters
    ----------
    options : Options
        Its corpus is opened, or the simulated starter corpus.
    timeout_s : float
        Time allowed.

    Raises
    ------
    WorkbenchError
        The page does not answer, or the corpus cannot be opened: one sentence says which.
    """
    logging.getLogger("bokeh").setLevel(logging.ERROR)  # the check closes its session while it is being told
    started = time.monotonic()
    port = free_port()
    workbench = Workbench(replace(options, browser=False))
    server = workbench.serve(port)
    url = f"http://127.0.0.1:{port}/"
    try:
        session_id = _session_of_page(url, started + timeout_s)
        page_s = time.monotonic() - started
        client = pull_session(session_id=session_id, url=url)
        try:
            page = workbench.pages[-1]
            page.arrived()
            _wait_for_motion(page, started + timeout_s)
            session = page.session
            assert session.result is not None
            assert session.corpus is not None
            return CheckReport(
                url,
                session.corpus.description.name,
                session.sentence,
                len(session.result.animation.times_s),
                page_s,
                time.monotonic() - started,
            )
        finally:
            client.close()
    finally:
        for page in workbench.pages:
            page.close()
        server.stop()
