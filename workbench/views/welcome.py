"""The page without a corpus: open a folder, make one from recordings, or start from the simulated corpus."""

from __future__ import annotations

import html
from collections.abc import Callable
from typing import Any

import panel as pn

from workbench.state import Session
from workbench.views.controls import Controls, button, text_field
from workbench.views.corpus_page import CorpusOverview
from workbench.views.notice import notice_html
from workbench.views.theme import style_sheet

__all__ = ["Welcome", "progress_html", "welcome_html"]

_INIT = (
    "corpus-tools init WORK --motion 'RECORDINGS/markers/{id}.npz' "
    "--audio 'RECORDINGS/wav/{id}.wav' --labels 'RECORDINGS/textgrid/{id}.TextGrid' "
    "--set frame_time=centre --set head_scale=true"
)


def welcome_html(has_corpus: bool) -> str:
    """Return the text above the field: what this page is for."""
    if has_corpus:
        title, text = "Open another corpus", "The one that is open stays until the new one has been read."
    else:
        title, text = (
            "Open a corpus",
            "A corpus is a folder with a corpus.toml that says where recordings lie.",
        )
    return (
        f'<div class="vsw-html welcome"><h1>{title}</h1>'
        f"<p>{text} Nothing in it is copied or changed.</p></div>"
    )


def _help_html() -> str:
    return (
        '<div class="vsw-html welcome"><p>Your own recordings (marker motion, sound, phone labels) become a '
        "corpus with one line in a terminal; <code>{id}</code> stands for the name of a recording:</p>"
        f"<pre>{html.escape(_INIT)}</pre>"
        "<p><code>frame_time=centre</code> says that frame i was taken at (i + 0.5) / rate, as video frames "
        "are; <code>start</code> says i / rate. <code>head_scale=true</code> lets head removal scale, which "
        "landmarks from one camera need and optical capture must not have.</p>"
        "<p>Then <code>corpus-tools check WORK</code> says what to mend; open WORK in the field above."
        " Without recordings, start with the simulated corpus.</p></div>"
    )


def progress_html(fraction: float, doing: str) -> str:
    """Return the progress bar of opening, with what is being done."""
    percent = round(100 * fraction)
    return (
        f'<div class="vsw-html" role="status"><div class="progress" role="progressbar" '
        f'aria-valuenow="{percent}" aria-valuemin="0" aria-valuemax="100" aria-label="Opening the corpus">'
        f'<i style="width:{percent}%"></i></div>{html.escape(doing)} · {percent} %</div>'
    )


class Welcome(pn.viewable.Viewer):
    """Path field, starter corpus, progress with cancel, and the sentence of an error.

    Parameters
    ----------
    session : Session
    controls : Controls
    on_open : callable
        ``on_open(folder)``.
    on_demo, on_cancel : callable
        Without arguments.
    on_back : callable
        Back to the open corpus.
    on_speak : callable
        ``on_speak(recording)``: shows one on the blend page.
    """

    def __init__(
        self,
        session: Session,
        controls: Controls,
        on_open: Callable[[str], None],
        on_demo: Callable[[], None],
        on_cancel: Callable[[], None],
        on_back: Callable[[], None],
        on_speak: Callable[[str], None],
        **params: Any,
    ) -> None:
        self._session, self._on_open = session, on_open
        super().__init__(**params)
        sheets = [style_sheet()]
        self.overview = CorpusOverview(session, on_speak)
        self._title = pn.pane.HTML(stylesheets=sheets, sizing_mode="stretch_width", margin=0)
        self._state = pn.pane.HTML(stylesheets=sheets, sizing_mode="stretch_width", margin=(8, 0))
        self.path = text_field(
            controls, "Folder of the corpus", placeholder="/path/to/corpus", margin=(8, 8, 8, 0)
        )
        self.open = button(controls, "Open", primary=True, margin=(8, 0))
        self.demo = button(controls, "Open the simulated starter corpus", margin=(0, 8, 0, 0))
        self.back = button(controls, "Back to the open corpus", margin=(0, 0))
        self.cancel = button(controls, "Cancel", margin=(0, 0))
        self.open.on_click(lambda _: self._submit())
        self.path.param.watch(lambda _: self._submit(), "enter_pressed")
        self.demo.on_click(lambda _: on_demo())
        self.cancel.on_click(lambda _: on_cancel())
        self.back.on_click(lambda _: on_back())
        help_ = pn.pane.HTML(
            _help_html(), stylesheets=sheets, sizing_mode="stretch_width", margin=(16, 0, 0, 0)
        )
        self._panel = pn.Column(
            self._title,
            pn.Row(self.path, self.open, sizing_mode="stretch_width", margin=0),
            self._state,
            self.cancel,
            pn.Row(self.demo, self.back, margin=0),
            help_,
            width=640,
            margin=(24, 0, 24, 24),
        )
        session.param.watch(self._update, ["status", "trouble", "fraction", "doing", "corpus"])
        self._update()

    def _submit(self) -> None:
        self._on_open(self.path.value_input or self.path.value or "")

    def _update(self, *events: Any) -> None:
        s = self._session
        opening = s.status == "opening"
        self._title.object = welcome_html(s.corpus is not None)
        if opening:
            self._state.object = progress_html(s.fraction, s.doing)
        elif s.trouble:
            notice = notice_html("err", "The corpus could not be opened", why=s.trouble)
            self._state.object = f'<div class="vsw-html">{notice}</div>'
        else:
            self._state.object = ""
        self.cancel.visible = opening
        self.demo.visible = not opening
        self.back.visible = s.corpus is not None and not opening

    def __panel__(self) -> Any:
        return pn.Column(self.overview, self._panel, sizing_mode="stretch_both", scroll="y-auto", margin=0)
