"""The page says that its server is gone, once, and not before."""

import pytest

from workbench.apps.options import Options, free_port
from workbench.apps.serving import Workbench


@pytest.fixture
def started():
    """Serve a page without a corpus; return its address and its server."""
    workbench, port = Workbench(Options(browser=False, demo=False)), free_port()
    server = workbench.serve(port)
    yield f"http://127.0.0.1:{port}/", server
    for page in list(workbench.pages):
        page.close()
    server.stop()


def test_a_stopped_server_is_told_in_a_band(started, browser_page, watched):
    url, server = started
    watched[1].expected.append("not connected so cannot send")  # what the page was sending at that moment
    browser_page.goto(url)
    browser_page.get_by_label("Folder of the corpus").wait_for()
    band = browser_page.get_by_role("alert").filter(has_text="Connection lost")
    assert band.count() == 0
    server.stop()
    band.wait_for()
    assert "reload when it is back" in band.inner_text()
    assert browser_page.get_by_text("Client connection was lost").count() == 0  # Bokeh's own words
    box, status = band.bounding_box(), browser_page.locator(".status").bounding_box()
    assert box["y"] + box["height"] <= status["y"] + 0.5
    band.get_by_role("button", name="Reload").wait_for()
