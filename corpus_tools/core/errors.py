"""Errors that a user reads: one sentence each, saying where, what was expected and what to do.

::

    WorkbenchError                exit 2, printed without a traceback
    ├── InputError                a file or an argument that cannot be used
    │   ├── CorpusError           corpus.toml, a missing or empty corpus
    │   ├── LabelError            tiers, times, phones outside the set
    │   ├── MotionError           marker files
    │   ├── MeshError             mesh files and correspondences
    │   └── ConfigError           configs: unknown keys, values out of range
    ├── OutputError               a folder or file that cannot be written
    ├── MissingExtraError         an optional package or program that is not installed
    ├── EngineError               a speech engine that died or did not answer
    └── SynthesisError            a result of the method: no unit covers a diphone, ...
        └── NoUnitError           carries the missing diphones
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable

from corpus_tools.core.words import counted

__all__ = [
    "ConfigError",
    "CorpusError",
    "EngineError",
    "InputError",
    "LabelError",
    "MeshError",
    "MissingExtraError",
    "MotionError",
    "NoUnitError",
    "OutputError",
    "SynthesisError",
    "WorkbenchError",
    "suggestion",
]


MOST_NAMED = 8
"""Missing diphones that a sentence names (our choice); the error carries all of them."""


class WorkbenchError(Exception):
    """Base of every error that is the user's to mend; ``str(error)`` is the sentence to show."""


class InputError(WorkbenchError):
    """A file or an argument that cannot be used as it is."""


class CorpusError(InputError):
    """A corpus folder or its ``corpus.toml`` that cannot be used."""


class LabelError(InputError):
    """Labels that cannot be used: cut files, disordered times, phones outside the set."""


class MotionError(InputError):
    """A marker file that cannot be used."""


class MeshError(InputError):
    """A mesh, or its correspondence to the markers, that cannot be used."""


class ConfigError(InputError):
    """A config with an unknown key or a value out of range."""


class OutputError(WorkbenchError):
    """A file or folder that cannot be written."""


class MissingExtraError(WorkbenchError):
    """An optional package or program is needed and not installed."""


class EngineError(WorkbenchError):
    """A speech engine that died, or did not answer in time."""


class SynthesisError(WorkbenchError):
    """The method itself could not do what was asked; the sentence says why."""


class NoUnitError(SynthesisError):
    """No unit of the inventory covers a diphone of the target, not even by backoff.

    Parameters
    ----------
    diphones : iterable of (str, str)
        The diphones that no unit covers.
    by_class : bool
        Viseme classes were tried too.
    banned, held_out : bool
        Units would cover them all if no unit were banned, or no recording held out.
    """

    def __init__(
        self,
        diphones: Iterable[tuple[str, str]],
        by_class: bool = True,
        banned: bool = False,
        held_out: bool = False,
    ) -> None:
        self.diphones = tuple(diphones)
        names = ", ".join(f"{a}-{b}" for a, b in self.diphones[:MOST_NAMED])
        if len(self.diphones) > MOST_NAMED:
            names += f" and {counted(len(self.diphones) - MOST_NAMED, 'more diphone')}"
        if banned or held_out:
            why, advice = (
                ("banned", "lift a ban")
                if banned
                else ("held out", "record it in another sentence, or let the held-out recording be used")
            )
            other = "" if by_class else ", or allow backoff to viseme classes"
            super().__init__(f"No unit may speak {names}: those that could are {why}; {advice}{other}.")
            return
        tried, advice = (
            (", not even by viseme class", "choose words without it")
            if by_class
            else ("", "allow backoff to viseme classes")
        )
        super().__init__(
            f"No unit of the corpus covers {names}{tried}: record a sentence that holds it, or {advice}."
        )


def suggestion(word: str, known: Iterable[str]) -> str:
    """Return ``"; did you mean 'x'?"`` for the nearest known word, or an empty string."""
    near = difflib.get_close_matches(word, list(known), n=1, cutoff=0.6)
    return f"; did you mean '{near[0]}'?" if near else ""
