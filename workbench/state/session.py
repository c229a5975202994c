"""The state of one person's work on the blend page, without any user interface."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import param

from corpus_tools.config import ConfigBase, config_with
from corpus_tools.pipeline import OpenCorpus
from workbench.state.corpus_facts import CorpusFacts
from workbench.state.editing import SETTINGS, Editing
from workbench.state.effects import Effects
from workbench.state.picks import fragment_at
from workbench.state.stages import Request, Result

__all__ = ["STATUSES", "Session"]

STATUSES = ("empty", "opening", "ready", "error")
"""empty: no corpus; opening: one is being read; ready: a corpus is open; error: it could not be opened."""


class Session(Editing):
    """Corpus, sentence, settings and result of one browser tab.

    Parameters are watched by the views; results arrive through :meth:`accept`, which refuses what belongs to
    an older request. Nothing here is shared between two sessions but the opened corpus, which is read-only.
    """

    corpus = param.ClassSelector(class_=OpenCorpus, allow_None=True, default=None, doc="The opened corpus.")
    folder = param.String(default="", doc="Folder of the corpus, as the person gave it.")
    status = param.Selector(default="empty", objects=list(STATUSES))
    fraction = param.Number(default=0.0, bounds=(0.0, 1.0), doc="Progress of opening, 0-1.")
    doing = param.String(default="", doc="What is being done, for the progress bar.")
    trouble = param.String(default="", doc="Why a corpus could not be opened; empty when all is well.")
    message = param.String(default="", doc="Why the sentence cannot be spoken so; empty when it can.")

    theme = param.Selector(default="light", objects=["light", "dark"])
    selected = param.Integer(default=0, bounds=(0, None), doc="Index of the selected fragment.")
    working = param.Boolean(default=False, doc="A result is being computed.")
    result = param.ClassSelector(class_=Result, allow_None=True, default=None)
    moving = param.ClassSelector(
        class_=Result,
        allow_None=True,
        default=None,
        doc="Whose motion the head shows, a moment before `result`.",
    )
    effects = param.ClassSelector(class_=Effects, allow_None=True, default=None, doc="Of every g(u).")
    recorded = param.ClassSelector(
        class_=Result, allow_None=True, default=None, doc="The capture's own motion."
    )
    other = param.ClassSelector(class_=Result, allow_None=True, default=None, doc="Of setting A, if another.")

    beside = param.List(default=[], item_type=str, doc="Heads that speak beside the first.")
    cast = param.ClassSelector(class_=tuple, default=(), doc="The result on each of them, as far as known.")
    facts = param.ClassSelector(
        class_=CorpusFacts, allow_None=True, default=None, doc="What a check of the corpus found."
    )
    check_doing = param.String(default="", doc="What the check of the corpus is at; empty when none runs.")
    check_trouble = param.String(default="", doc="Why the corpus could not be checked.")

    def __init__(self, base: ConfigBase | None = None, **values: Any) -> None:
        self._accepted = 0
        self._place = 0
        super().__init__(base, **values)

    @property
    def sentences(self) -> tuple[str, ...]:
        """Ids of the sentences of the corpus; empty without one."""
        return self.corpus.names if self.corpus is not None else ()

    def text_of(self, name: str) -> str:
        """Return the words of a recording, or an empty string."""
        if self.corpus is None or name not in self.corpus.names:
            return ""
        return str(self.corpus.utterance(name).text)

    @property
    def phones(self) -> tuple[str, ...]:
        """Labels of the phones of the target; empty while they are not known."""
        kind, what = self.target
        if self.corpus is not None and kind == "recording" and what in self.corpus.names:
            return tuple(self.corpus.utterance(what).labels)
        shown = self.result.request if self.result is not None else None
        if kind == "text" and shown is not None and shown.text == what and self.result is not None:
            return tuple(self.result.utterance.labels)
        return ()

    def request(self) -> Request | None:
        """Return what is to be computed now, or None without corpus or target."""
        kind, what = self.target
        if self.corpus is None or not what:
            return None
        if kind == "text":
            return Request(self.corpus, "", self.config, self.held_out, what)
        return Request(self.corpus, what, self.config, self.held_out)

    def request_of_a(self) -> Request | None:
        """Return what the setting that is *not* shown would speak now; None when there is no other."""
        now = self.request()
        if now is None or not self.difference:
            return None
        values = self.other_settings
        return replace(now, config=config_with(self.base, **{SETTINGS[n]: v for n, v in values.items()}))

    def begin_opening(self, folder: str) -> None:
        """Show that a corpus is being read; what is open stays until the new one is there."""
        self.param.update(folder=folder, status="opening", fraction=0.0, doing="reading", trouble="")

    def opened(self, corpus: OpenCorpus, sentence: str | None = None) -> None:
        """Take over an opened corpus and pick a sentence: the given one, or the first of the corpus."""
        first = sentence or corpus.names[0]
        corpus.utterance(first)
        self._pins_of, self._place = {}, 0
        self.param.update(
            corpus=corpus,
            status="ready",
            fraction=1.0,
            doing="",
            trouble="",
            message="",
            moving=None,
            result=None,
            selected=0,
            options=None,
            target_kind="recording",
            sentence=first,
            pins=(),
            bans=(),
        )
        self.begin_history()

    def opening_failed(self, why: str) -> None:
        """Show why a corpus could not be opened; one that is open stays."""
        status = "ready" if self.corpus is not None else "error"
        self.param.update(status=status, trouble=why, doing="", fraction=0.0)

    def opening_cancelled(self) -> None:
        """Go back to what was there before."""
        status = "ready" if self.corpus is not None else "empty"
        self.param.update(status=status, trouble="", doing="", fraction=0.0)

    def close(self) -> None:
        """Leave the corpus: back to the empty state."""
        empty = {"folder": "", "sentence": "", "trouble": "", "message": ""}
        self.param.update(corpus=None, moving=None, result=None, status="empty", **empty)

    def step_sentence(self, step: int) -> None:
        """Go `step` sentences on (or back), staying inside the corpus."""
        names = self.sentences
        if not names:
            return
        here = names.index(self.sentence) if self.sentence in names else 0
        self.sentence = names[min(len(names) - 1, max(0, here + step))]

    def move(self, number: int, result: Result) -> bool:
        """Let the head move as a result says, ahead of :meth:`accept`; False when it is old news."""
        now = self.request()
        if number <= self._accepted or now is None or not now.same_target(result.request):
            return False
        self.moving = result
        return True

    def accept(self, number: int, result: Result) -> bool:
        """Show a result, unless a newer one is shown already or the person has gone on to something else.

        Parameters
        ----------
        number : int
            Of the job; jobs are numbered in the order they were asked for.

        Returns
        -------
        bool
            Whether it was taken.
        """
        now = self.request()
        if number <= self._accepted or now is None or not now.same_target(result.request):
            return False
        self._accepted = number
        if self.result is None or not self.result.request.same_target(result.request):
            self._place = 0
        selected = fragment_at(result, self._place)
        current = result.request.config == now.config
        if current and self.options is not None and not self.options.holds(result):
            self.options = None
        self.param.update(moving=result, result=result, selected=selected, message="")
        if self.side == "B" and current:
            self.history.settle(max(result.ratios, default=0.0))
            self.edits += 1
        return True

    def select(self, index: int) -> None:
        """Select a fragment of the result; its place stays selected when other units come to speak it."""
        if self.result is None or not 0 <= index < len(self.result.selection.chosen):
            return
        self._place = self.result.selection.chosen[index].first
        self.param.update(selected=index, options=None)

    def refuse(self, number: int, message: str) -> bool:
        """Show why a request could not be computed; False when it is old news.

        The last good result stays, unless it is of another sentence.
        """
        if number <= self._accepted:
            return False
        self._accepted = number
        now = self.request()
        if self.result is not None and (now is None or not now.same_target(self.result.request)):
            self.param.update(moving=None, result=None)
        self.message = message
        return True
