"""The bar: what is typed reaches the session whole, or is told."""

from corpus_tools.speech import MOST_CHARACTERS
from workbench.state import Session
from workbench.views.bar import AppBar
from workbench.views.controls import Controls


def test_the_text_field_takes_more_than_can_be_spoken():
    """Where a browser cuts a pasted text nobody is told; too long a text is refused instead."""
    session = Session()
    bar = AppBar(session, Controls(session), lambda: None)
    assert bar.text.max_length > MOST_CHARACTERS
    bar.text.value = "now " * MOST_CHARACTERS
    assert session.text == bar.text.value
