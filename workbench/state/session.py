"""The state of one person's work on the blend page, without any user interface."""

from __future__ import annotations

from typing import Any

import param

from corpus_tools.config import ConfigBase, config_from_dict, config_with
from corpus_tools.pipeline import OpenCorpus
from workbench.state.stages import Request, Result

__all__ = ["SETTINGS", "STATUSES", "Session", "default_config"]

STATUSES = ("empty", "opening", "ready", "error")
"""empty: no corpus; opening: one is being read; ready: a corpus is open; error: it could not be opened."""

SETTINGS = {
    "method": "selection__method",
    "weighting": "blend__weighting",
    "shape": "blend__shape",
    "overlap_s": "blend__overlap_s",
    "rule": "blend__rule",
    "mesh": "deform__mesh",
    "deformer": "deform__deformer",
}
"""Parameters of a session that are values of the config, and where they stand in it."""


def default_config() -> ConfigBase:
    """Return the config in which every value is the default."""
    return config_from_dict({})


class Session(param.Parameterized):
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

    sentence = param.String(default="", doc="Recording whose sentence is spoken.")
    held_out = param.Boolean(default=True, doc="Keep that recording out of the inventory.")
    method = param.String(default="viterbi")
    weighting = param.String(default="smootherstep")
    shape = param.Number(default=0.0, bounds=(-1.0, 1.0))
    overlap_s = param.Number(default=0.12, bounds=(0.0, 0.5))
    rule = param.Selector(default="shared-phone", objects=["shared-phone", "paper"])
    mesh = param.String(default="base")
    deformer = param.String(default="rbf")

    theme = param.Selector(default="light", objects=["light", "dark"])
    selected = param.Integer(default=0, bounds=(0, None), doc="Index of the selected fragment.")
    working = param.Boolean(default=False, doc="A result is being computed.")
    result = param.ClassSelector(class_=Result, allow_None=True, default=None)

    def __init__(self, base: ConfigBase | None = None, **values: Any) -> None:
        self._base = base or default_config()
        self._accepted = 0
        super().__init__(**{**self._from_config(self._base), **values})

    @staticmethod
    def _from_config(config: ConfigBase) -> dict[str, Any]:
        found = {}
        for name, place in SETTINGS.items():
            part, _, key = place.partition("__")
            found[name] = getattr(getattr(config, part), key)
        return found

    @property
    def config(self) -> ConfigBase:
        """The config of the present settings.

        Raises
        ------
        ConfigError
            A value is out of range.
        """
        return config_with(self._base, **{place: getattr(self, n) for n, place in SETTINGS.items()})

    def load_config(self, config: ConfigBase) -> None:
        """Take over every value of a config, also those that have no parameter here."""
        self._base = config
        self.param.update(**self._from_config(config))

    @property
    def sentences(self) -> tuple[str, ...]:
        """Ids of the sentences of the corpus; empty without one."""
        return self.corpus.names if self.corpus is not None else ()

    def text_of(self, name: str) -> str:
        """Return the words of a recording, or an empty string."""
        if self.corpus is None or name not in self.corpus.names:
            return ""
        return str(self.corpus.utterance(name).text)

    def request(self) -> Request | None:
        """Return what is to be computed now, or None without corpus or sentence."""
        if self.corpus is None or not self.sentence:
            return None
        return Request(self.corpus, self.sentence, self.config, self.held_out)

    def begin_opening(self, folder: str) -> None:
        """Show that a corpus is being read; what is open stays until the new one is there."""
        self.param.update(folder=folder, status="opening", fraction=0.0, doing="reading", trouble="")

    def opened(self, corpus: OpenCorpus, sentence: str | None = None) -> None:
        """Take over an opened corpus and pick a sentence: the given one, or the first of the corpus."""
        first = sentence or corpus.names[0]
        corpus.utterance(first)
        self.param.update(
            corpus=corpus,
            status="ready",
            fraction=1.0,
            doing="",
            trouble="",
            message="",
            result=None,
            selected=0,
            sentence=first,
        )

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
        self.param.update(corpus=None, result=None, status="empty", **empty)

    def step_sentence(self, step: int) -> None:
        """Go `step` sentences on (or back), staying inside the corpus."""
        names = self.sentences
        if not names:
            return
        here = names.index(self.sentence) if self.sentence in names else 0
        self.sentence = names[min(len(names) - 1, max(0, here + step))]

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
        n = len(result.selection.chosen)
        self.param.update(result=result, selected=min(self.selected, n - 1), message="")
        return True

    def refuse(self, number: int, message: str) -> bool:
        """Show why a request could not be computed; the last good result stays. False when it is old news."""
        if number <= self._accepted:
            return False
        self._accepted = number
        self.message = message
        return True
