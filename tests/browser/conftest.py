"""A real Chromium for the tests; errors on its console and requests that leave the machine fail."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from browser import chromium as shared
from playwright.sync_api import Browser, BrowserContext, Page, sync_playwright

from corpus_tools.demo import simulate_corpus
from workbench.apps.options import Options, free_port
from workbench.apps.serving import Workbench


@pytest.fixture(scope="session")
def chromium() -> Iterator[Browser]:
    """Return a headless Chromium with software WebGL; without one the test is skipped (in CI it fails)."""
    path = shared.find_chromium()
    if path is None:
        pytest.skip("there is no Chromium; on Debian or Ubuntu: apt-get install chromium")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=list(shared.FLAGS))
        yield browser
        browser.close()


@pytest.fixture
def watched(chromium: Browser) -> Iterator[tuple[BrowserContext, shared.Watch]]:
    """Return a fresh browser context, and what listens to all its pages; fails the test at its end."""
    context = chromium.new_context(viewport={"width": 1440, "height": 900}, device_scale_factor=1)
    context.set_default_timeout(shared.TIMEOUT_MS)
    watch = shared.Watch(context)
    yield context, watch
    context.close()
    assert not watch.unexpected(), "\n".join(watch.unexpected())


@pytest.fixture
def browser_page(watched: tuple[BrowserContext, shared.Watch]) -> Page:
    """Return an empty page of a fresh, watched context."""
    return watched[0].new_page()


@pytest.fixture
def serve() -> Iterator[Callable[..., str]]:
    """Return ``serve(make, static=None) -> address``: `make` builds what a new session shows."""
    servers = []

    def start(make: Callable[[], Any], static: dict[str, Path] | None = None) -> str:
        url, server = shared.serve(make, static)
        servers.append(server)
        return url

    yield start
    for server in servers:
        server.stop()


@pytest.fixture(scope="session")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Workbench, Path]]:
    """Serve the page of a simulated corpus of 12 sentences: its address, the workbench, and its root."""
    folder = tmp_path_factory.mktemp("page")
    simulate_corpus(folder / "corpus", n_sentences=12)
    workbench = Workbench(Options(corpus=folder / "corpus", root=folder, browser=False))
    port = free_port()
    server = workbench.serve(port)
    yield f"http://127.0.0.1:{port}/", workbench, folder
    for page in list(workbench.pages):
        page.close()
    server.stop()
