"""Ways from timed phones to marker motion, under one interface.

A method is found by its id. It is fitted on recordings (:class:`~corpus_tools.methods.training.TrainingSet`)
and then predicts the motion of any utterance of the same phone set. Those made of fragments also choose units
on their own (:data:`SEARCHES`), so that a change of g(u) needs no new search.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, get_type_hints

from corpus_tools.core import InputError, Registry, Selection, Trajectory, Utterance
from corpus_tools.core.errors import suggestion
from corpus_tools.methods.settings import setting_value
from corpus_tools.methods.training import TrainingSet
from corpus_tools.synthesis import select_greedy, select_viterbi

__all__ = ["METHODS", "SEARCHES", "Method", "Predictor", "TunedPredictor", "Variant", "parse_variant"]

Predictor = Callable[[Utterance], Trajectory]
"""What fitting gives: the motion of an utterance at a uniform rate from 0 s to its end."""


@dataclass(frozen=True, slots=True)
class Method:
    """A way from timed phones to marker motion.

    Attributes
    ----------
    name : str
        Method id, as on the command line.
    summary : str
        One sentence for lists and tooltips.
    fit : callable
        ``fit(training, **settings) -> Predictor``; every setting has a default.
    """

    name: str
    summary: str
    fit: Callable[..., Predictor]

    @property
    def settings(self) -> dict[str, Any]:
        """The settings and their defaults."""
        parameters = list(inspect.signature(self.fit).parameters.values())[1:]
        return {p.name: p.default for p in parameters}

    @property
    def kinds(self) -> dict[str, Any]:
        """What values each setting takes, as of :func:`~corpus_tools.methods.settings.setting_value`."""
        hints = get_type_hints(self.fit, include_extras=True)
        return {name: hints[name] for name in self.settings}


@dataclass(frozen=True, slots=True)
class TunedPredictor:
    """A predictor whose weights were found on the recordings that it was fitted on.

    Attributes
    ----------
    predict : callable
    weights : mapping of str to float
        As a config names them, section `selection`.
    """

    predict: Predictor
    weights: Mapping[str, float]

    def __call__(self, utterance: Utterance) -> Trajectory:
        """Return the motion of an utterance."""
        return self.predict(utterance)


METHODS: Registry[Method] = Registry("method")
SEARCHES: Registry[Callable[..., Selection]] = Registry("method of fragments")
"""``search(model, utterance, *, exclude, pins, bans, **weights) -> Selection``, fragments of paper A:
they are then aligned, resampled and blended."""

SEARCHES.add("greedy", select_greedy)
SEARCHES.add("viterbi", select_viterbi)


@dataclass(frozen=True, slots=True)
class Variant:
    """A method with some of its settings changed.

    Attributes
    ----------
    label : str
        As the user wrote it: ``viterbi:mode=inertial+remove_bias=off``.
    method : Method
    changes : mapping of str to value
    """

    label: str
    method: Method
    changes: Mapping[str, Any] = field(default_factory=dict)

    def fit(self, training: TrainingSet) -> Predictor:
        """Fit the method on recordings, under these settings."""
        return self.method.fit(training, **self.changes)


def parse_variant(text: str) -> Variant:
    """Return the method that ``ID`` or ``ID:key=value+key=value`` names.

    Raises
    ------
    InputError
        There is no such method or setting, or its value is of another kind or out of range.
    """
    name, _, settings = text.strip().partition(":")
    method = METHODS[name]
    kinds, changes = method.kinds, {}
    for pair in settings.split("+") if settings else ():
        key, sign, value = pair.partition("=")
        if key not in kinds:
            hint = suggestion(key, kinds) or f"; known: {', '.join(kinds) or 'none'}."
            raise InputError(f"'{text}': the method '{name}' has no setting '{key}'{hint}")
        if not sign:
            raise InputError(f"'{text}': '{pair}' is not of the form KEY=VALUE, as in remove_bias=off.")
        try:
            changes[key] = setting_value(kinds[key], value)
        except ValueError as error:
            raise InputError(f"'{text}': {key} is '{value}'; {error} was expected.") from None
    return Variant(text.strip(), method, changes)
