"""The bar: which corpus, which sentence, state, theme."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui

from corpus_tools.core import counted
from corpus_tools.speech import MOST_CHARACTERS
from workbench.state import Session
from workbench.views.controls import Controls, button, preset_buttons

__all__ = ["AppBar", "sentence_options"]

MOST_LETTERS = 10 * MOST_CHARACTERS
"""Where the browser cuts a text: far above what can be spoken, so that too much is told, not cut."""

_KINDS = {"Recording": "recording", "Text": "text"}


def sentence_options(session: Session) -> dict[str, str]:
    """Return ``{"name  words": name}`` of every sentence of the open corpus."""
    return {f"{name}  {session.text_of(name)}".rstrip(): name for name in session.sentences}


class AppBar(pn.viewable.Viewer):
    """Corpus button, sentence picker with its neighbours, theme switch.

    Parameters
    ----------
    session : Session
    controls : Controls
    on_corpus : callable
        Shows the page that opens a corpus.
    on_speak : callable, optional
        Called when Enter was pressed in the text, once the session has the text.
    """

    def __init__(
        self,
        session: Session,
        controls: Controls,
        on_corpus: Callable[[], None],
        on_speak: Callable[[], None] = lambda: None,
        **params: Any,
    ) -> None:
        self._session, self._on_speak = session, on_speak
        super().__init__(**params)
        self.corpus = button(controls, "Open a corpus", margin=(5, 4, 5, 8))
        self.corpus.on_click(lambda _: on_corpus())
        self.before = button(controls, "‹", description="Sentence before: [", margin=(5, 2), width=34)
        self.after = button(controls, "›", description="Next sentence: ]", margin=(5, 2), width=34)
        self.before.on_click(lambda _: session.step_sentence(-1))
        self.after.on_click(lambda _: session.step_sentence(1))
        self.sentence = controls.make(
            pmui.AutocompleteInput,
            label="",
            placeholder="Sentence: type a name or a word",
            options=sentence_options(session),
            case_sensitive=False,
            search_strategy="includes",
            min_characters=0,
            restrict=True,
            size="small",
            variant="outlined",
            width=330,
            margin=(3, 2),
        )
        controls.tie(self.sentence, "sentence")
        self.kind = preset_buttons(controls, "What is spoken", "target_kind", _KINDS)
        self.kind.param.update(sizing_mode=None, width=150, margin=(6, 6), css_classes=["kind"])
        self.text = controls.make(
            pmui.TextInput,
            label="",
            placeholder="Type a sentence, then Enter",
            size="small",
            variant="outlined",
            max_length=MOST_LETTERS,
            width=420,
            margin=(3, 2),
            visible=False,
            css_classes=["typed"],
        )
        self.text.param.watch(lambda event: self._typed(event.new), "value")
        self.text.param.watch(lambda _: self._entered(), "enter_pressed")
        session.param.watch(lambda event: self.text.param.update(value=event.new), "text")
        session.param.watch(self._kind, "target_kind")
        self.theme = button(controls, "◐", description="Light or dark: T", margin=(5, 8), width=34)
        self.theme.on_click(lambda _: self.toggle_theme())
        self.undo = button(controls, "↶ Undo", description="Undo: Ctrl Z", margin=(5, 2))
        self.redo = button(controls, "↷", description="Redo: Ctrl Y", margin=(5, 2), width=34)
        self.undo.on_click(lambda _: session.undo())
        self.redo.on_click(lambda _: session.redo())
        session.param.watch(self._edits, "edits")
        session.param.watch(self._update, ["corpus"])
        self._edits()
        self._update()

    def toggle_theme(self) -> None:
        """Light to dark and back."""
        self._session.theme = "dark" if self._session.theme == "light" else "light"

    def _typed(self, text: str) -> None:
        """Take a text without the blanks around it, which say nothing."""
        if text != text.strip():
            self.text.value = text.strip()
        elif text != self._session.text:
            self._session.text = text

    def _entered(self) -> None:
        entered = (
            self.text.value_input or ""
        ).strip()  # Enter is told before the value, at times before both
        if entered:
            self._typed(entered)
        self._on_speak()

    def _kind(self, *events: Any) -> None:
        have, typed = self._session.corpus is not None, self._session.target_kind == "text"
        self.kind.visible = have
        self.text.visible = have and typed
        for control in (self.before, self.after, self.sentence):
            control.visible = have and not typed

    def _edits(self, *events: Any) -> None:
        history = self._session.history
        self.undo.param.update(disabled=not history.can_undo)
        self.redo.param.update(disabled=not history.can_redo)

    def _update(self, *events: Any) -> None:
        corpus = self._session.corpus
        self._kind()
        if corpus is None:
            self.corpus.label = "Open a corpus"
            return
        self.corpus.label = f"{corpus.description.name} · {counted(len(corpus.names), 'recording')} ▾"
        self.sentence.param.update(options=sentence_options(self._session), value=self._session.sentence)

    def __panel__(self) -> Any:
        return pn.Row(
            self.corpus,
            self.kind,
            self.before,
            self.sentence,
            self.after,
            self.text,
            pn.layout.HSpacer(),
            self.undo,
            self.redo,
            self.theme,
            sizing_mode="stretch_width",
            height=40,
            margin=0,
        )
