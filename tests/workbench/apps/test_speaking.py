"""Enter plays the text it was pressed in, and no other."""

import time

import pytest

from workbench.actions import CorpusCache
from workbench.apps.blend import BlendPage


def wait(condition, most_s=60.0):
    until = time.monotonic() + most_s
    while not condition():
        assert time.monotonic() < until, "the page did not get there"
        time.sleep(0.02)


@pytest.fixture
def page(tmp_path, simulated_corpus):
    page = BlendPage(CorpusCache(), lambda progress: tmp_path, tmp_path, lambda action: action())
    page.arrived()
    page.open(simulated_corpus)
    wait(lambda: page.session.result is not None)
    page.session.target_kind = "text"
    yield page
    page.close()


def spoken(page, text):
    """Let the page speak a text; return whether it plays by itself once the transport has it."""
    before = page.transport.loaded["n"]
    page.session.text = text
    wait(lambda: page.transport.loaded["n"] > before and page.transport.loaded["duration_s"] > 0)
    return page.transport.loaded["plays"]


def test_what_enter_was_pressed_in_plays_as_soon_as_it_is_there(page):
    page._speak_text()
    assert spoken(page, "the time is now ten") is True
    assert spoken(page, "the time is now five") is False


def test_enter_in_a_text_that_is_refused_does_not_play_another(page):
    page.session.text = "?!"
    page._speak_text()
    wait(lambda: page.session.message)
    assert spoken(page, "the time is now ten") is False


def test_a_complaint_of_an_export_goes_when_there_is_something_to_export(page):
    page.export.submit()
    assert page.export.kind == "err"
    assert spoken(page, "the time is now ten") is False
    assert page.export.kind == ""
