"""The bar: which corpus, which sentence, state, theme."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui

from workbench.state import Session
from workbench.views.controls import Controls, button
from workbench.views.theme import style_sheet

__all__ = ["AppBar", "sentence_options"]


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
    """

    def __init__(
        self, session: Session, controls: Controls, on_corpus: Callable[[], None], **params: Any
    ) -> None:
        self._session = session
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
        self.held_out = pn.pane.HTML("", stylesheets=[style_sheet()], margin=(10, 8))
        self.theme = button(controls, "◐", description="Light or dark: T", margin=(5, 8), width=34)
        self.theme.on_click(lambda _: self.toggle_theme())
        session.param.watch(self._update, ["corpus"])
        self._update()

    def toggle_theme(self) -> None:
        """Light to dark and back."""
        self._session.theme = "dark" if self._session.theme == "light" else "light"

    def _update(self, *events: Any) -> None:
        corpus = self._session.corpus
        have = corpus is not None
        for control in (self.before, self.after, self.sentence):
            control.visible = have
        if corpus is None:
            self.corpus.label = "Open a corpus"
            return
        self.corpus.label = f"{corpus.description.name} · {len(corpus.names)} recordings ▾"
        self.sentence.param.update(options=sentence_options(self._session), value=self._session.sentence)

    def __panel__(self) -> Any:
        return pn.Row(
            self.corpus,
            self.before,
            self.sentence,
            self.after,
            pn.layout.HSpacer(),
            self.theme,
            sizing_mode="stretch_width",
            height=40,
            margin=0,
        )
