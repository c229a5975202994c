"""The first start: the head at once, progress, Esc; then Space alone plays a sentence."""

import threading

import pytest
from browser.shown import FIND

from corpus_tools.demo import simulate_corpus
from workbench.apps.options import Options, free_port
from workbench.apps.serving import Workbench


@pytest.fixture
def started(tmp_path):
    """Serve without a corpus; the simulated one is finished when `go` is set."""
    go = threading.Event()
    simulate_corpus(tmp_path / "made", n_sentences=4)
    workbench = Workbench(Options(browser=False))

    def make(progress):
        while not go.wait(0.02):
            progress(0.4, "simulating sentence 2 of 4")
        return tmp_path / "made"

    workbench.make_demo = make
    port = free_port()
    server = workbench.serve(port)
    yield f"http://127.0.0.1:{port}/", go
    go.set()
    for page in list(workbench.pages):
        page.close()
    server.stop()


def test_the_head_is_there_at_once_and_space_alone_plays(started, browser_page):
    url, go = started
    browser_page.goto(url)
    browser_page.wait_for_function(f"() => {FIND}?.vsw.draws > 0")
    bar = browser_page.get_by_role("progressbar", name="Progress")
    browser_page.locator('[aria-label=Progress][aria-valuenow="24"]').wait_for()
    browser_page.locator(".waiting .doing", has_text="simulating sentence 2 of 4").wait_for()
    go.set()
    bar.wait_for(state="hidden")
    browser_page.wait_for_function(f"() => {FIND}.vsw.shown >= 0")
    browser_page.locator(".vsw-transport button.play:not([disabled])").wait_for()
    browser_page.keyboard.press("Space")
    browser_page.wait_for_function(f"() => {FIND}.vsw.shown > 20")


def test_escape_ends_the_making_and_leaves_the_choice(started, browser_page):
    browser_page.goto(started[0])
    browser_page.get_by_role("progressbar", name="Progress").wait_for()
    browser_page.keyboard.press("Escape")
    browser_page.get_by_label("Folder of the corpus").wait_for()
    browser_page.get_by_role("button", name="Open the simulated starter corpus").wait_for()
