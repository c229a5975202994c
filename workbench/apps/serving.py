"""The server: one page per browser tab, corpora shared, loopback unless a password guards it."""

from __future__ import annotations

import asyncio
import logging
import secrets
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import panel as pn

from corpus_tools.config import load_config
from corpus_tools.demo import demo_folder
from corpus_tools.pipeline.kept import cache_folder
from workbench.actions import CorpusCache
from workbench.apps.blend import BlendPage
from workbench.apps.options import Options, free_port, read_password
from workbench.apps.stopping import StoppedBySignal
from workbench.views.theme import ASSETS_ROUTE, FRONTEND

__all__ = ["Workbench"]

MAX_MESSAGE_BYTES = 64 * 1024 * 1024


class Workbench:
    """Builds a page for every browser tab and keeps the corpora they share.

    Attributes
    ----------
    pages : list of BlendPage
        The tabs that are open.
    """

    def __init__(self, options: Options) -> None:
        self.options = options
        self.cache = CorpusCache(options.root)
        self._config = (load_config(options.config), options.config.name) if options.config else None
        self.pages: list[BlendPage] = []
        self._demo_lock = threading.Lock()

    def make_demo(self, progress: Callable[[float, str], None]) -> Path:
        """Make the simulated starter corpus once, in the user's cache folder; return its folder."""
        folder = cache_folder() / "starter-corpus"
        while not self._demo_lock.acquire(timeout=0.2):
            progress(0.0, "another tab is making it")
        try:
            return demo_folder(folder, progress)
        finally:
            self._demo_lock.release()

    def page(self) -> Any:
        """Return the page of a new tab."""
        _expect_closed_tabs()
        doc = pn.state.curdoc

        def deliver(action: Callable[[], None]) -> None:
            if doc.session_context is not None and not doc.session_context.destroyed:
                doc.add_next_tick_callback(action)

        made = BlendPage(
            self.cache,
            self.make_demo,
            self.options.root / "exports" if self.options.root else None,
            deliver if doc is not None else _at_once,
            begin=self.options.app,
            home=str([str(p.absolute()) if p else "" for p in (self.options.corpus, self.options.config)]),
            config=self._config,
        )
        self.pages.append(made)
        if doc is not None:
            doc.on_session_destroyed(lambda _: self._gone(made))
            doc.title = made.shell.page_title
        if self.options.corpus is not None:
            made.open(self.options.corpus)
        elif self.options.demo and self.options.root is None:
            made.open_demo_later()
        return made.shell

    def _gone(self, page: BlendPage) -> None:
        page.close()
        if page in self.pages:
            self.pages.remove(page)

    def serve(self, port: int | None = None) -> Any:
        """Serve in a thread, without opening the browser; return the thread, which has ``stop()``."""
        return self._made(port, browser=False, threaded=True)

    def run(self, stop: StoppedBySignal) -> None:
        """Serve until a signal tells to stop; what still computes then ends: it would hold the process."""
        try:
            stop.run(self._made(None, browser=self.options.browser, start=False))
        finally:
            for page in tuple(self.pages):
                self._gone(page)

    def _made(self, port: int | None, browser: bool, **how: Any) -> Any:
        options = self.options
        port = (options.port if port is None else port) or free_port(options.host)
        if options.password_file is not None:
            how["basic_auth"] = read_password(options.password_file)
            how["cookie_secret"] = secrets.token_hex(32)
        return pn.serve(
            {"/": self.page},
            port=port,
            address=options.host,
            websocket_origin=list(options.origins)
            or [f"{name}:{port}" for name in ("127.0.0.1", "localhost")],
            show=browser,
            title="Visual speech workbench",
            static_dirs={ASSETS_ROUTE: str(FRONTEND / "fonts")},
            websocket_max_message_size=MAX_MESSAGE_BYTES,
            verbose=False,
            **how,
        )


class _ClosedTabs(logging.Filter):
    """Leaves out what Bokeh says of a tab that was closed while something was sent to it."""

    def filter(self, record: logging.LogRecord) -> bool:
        return "as connection was closed" not in record.getMessage()


_CLOSED_TABS = _ClosedTabs()


def _expect_closed_tabs() -> None:
    """Let a tab be closed while something is sent to it: no fault, and nothing for the log."""
    logging.getLogger("bokeh.server.views.ws").addFilter(_CLOSED_TABS)  # one filter is entered once

    def told(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        if type(context.get("exception")).__name__ not in ("WebSocketClosedError", "StreamClosedError"):
            loop.default_exception_handler(context)

    try:
        asyncio.get_running_loop().set_exception_handler(told)
    except RuntimeError:  # not in a server
        return


def _at_once(action: Callable[[], None]) -> None:
    action()
