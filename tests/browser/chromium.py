"""What browser tests and measurements share: which Chromium, with which switches, and what it must not do."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import panel as pn
from answering import wait_until_answers
from playwright.sync_api import BrowserContext, Page

from workbench.apps.options import free_port

CANDIDATES = ("chromium", "chromium-browser", "google-chrome")
FLAGS = (
    "--no-sandbox",
    "--disable-gpu-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--autoplay-policy=no-user-gesture-required",
)
TIMEOUT_MS = 20_000
LOCAL = ("http://127.0.0.1:", "ws://127.0.0.1:", "http://localhost:", "ws://localhost:", "blob:", "data:")


def find_chromium() -> str | None:
    """Return the path of an installed Chromium; the variable CHROMIUM goes before what is on the path."""
    named = os.environ.get("CHROMIUM")
    found = (shutil.which(name) for name in ([named] if named else CANDIDATES))
    return next((path for path in found if path), None)


class Watch:
    """Listens to the pages of a context and keeps what must not happen."""

    def __init__(self, context: BrowserContext) -> None:
        self.faults: list[str] = []
        self.expected: list[str] = []
        context.on("page", self._page)
        context.on("request", self._request)

    def _page(self, page: Page) -> None:
        page.on("pageerror", lambda error: self.faults.append(f"page error: {error}"))
        page.on("console", self._console)
        page.on("websocket", lambda socket: self._address(socket.url))

    def _console(self, message: Any) -> None:
        if message.type == "error":
            self.faults.append(f"console: {message.text}")

    def _request(self, request: Any) -> None:
        self._address(request.url)

    def _address(self, url: str) -> None:
        if not url.startswith(LOCAL):
            self.faults.append(f"a request leaves this machine: {url}")

    def unexpected(self) -> list[str]:
        """Return the faults that no test has announced (`expected`: words that they contain)."""
        return [f for f in self.faults if not any(words in f for words in self.expected)]


def serve(make: Callable[[], Any], static: dict[str, Path] | None = None) -> tuple[str, Any]:
    """Serve what `make` builds for each session; return its address, once it answers, and its thread."""
    port = free_port()
    server = pn.serve(
        {"/": make},
        port=port,
        address="127.0.0.1",
        websocket_origin=f"127.0.0.1:{port}",
        threaded=True,
        show=False,
        verbose=False,
        static_dirs={name: str(folder) for name, folder in (static or {}).items()},
    )
    url = f"http://127.0.0.1:{port}/"
    wait_until_answers(f"{url}static/js/bokeh.min.js", TIMEOUT_MS / 1000)
    return url, server
