"""What a person edits: target, settings, pins and bans; with undo, a history, and two settings to compare."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

import param

from corpus_tools.config import ConfigBase, config_from_dict, config_with
from corpus_tools.synthesis import DEFAULT_CURVE
from workbench.state.history import History, change_text
from workbench.state.picks import Options

__all__ = ["EDITABLE", "SETTINGS", "TARGETS", "Editing", "default_config"]

SETTINGS = {
    "method": "selection__method",
    "mode": "blend__mode",
    "weighting": "blend__weighting",
    "shape": "blend__shape",
    "curve_weights": "blend__curve_weights",
    "overlap_s": "blend__overlap_s",
    "inertial_s": "blend__inertial_s",
    "rule": "blend__rule",
    "mesh": "deform__mesh",
    "deformer": "deform__deformer",
    "pins": "overrides__pins",
    "bans": "overrides__bans",
}
"""Parameters of a session that are values of the config, and where they stand in it."""

TARGETS = ("recording", "text")
"""What can be spoken: the sentence of a recording, or words that were typed."""

_TARGET = ("target_kind", "sentence", "text")
EDITABLE = (*SETTINGS, *_TARGET, "held_out", "base")
"""Parameters that a person edits: what the history holds, and what undo brings back."""


def target_of(values: Mapping[str, Any]) -> tuple[str, str]:
    """Return what editable values speak: ("recording", id) or ("text", words)."""
    kind = values["target_kind"]
    return (kind, values["text"].strip() if kind == "text" else values["sentence"])


def default_config() -> ConfigBase:
    """Return the config in which every value is the default."""
    return config_from_dict({})


class Editing(param.Parameterized):
    """The editable values of a session.

    A change of any of them is an entry of the history (:attr:`history`), and can be undone. Pins count the
    phones of one target, so each target has its own; they come back with it.
    """

    target_kind = param.Selector(default="recording", objects=list(TARGETS))
    sentence = param.String(default="", doc="Recording whose sentence is spoken.")
    text = param.String(default="", doc="Words that are spoken when the target is a text.")
    held_out = param.Boolean(default=True, doc="Keep that recording out of the inventory.")
    method = param.String(default="viterbi")
    mode = param.Selector(default="crossfade", objects=["crossfade", "inertial"])
    weighting = param.String(default="smootherstep")
    shape = param.Number(default=0.0, bounds=(-1.0, 1.0))
    curve_weights = param.ClassSelector(class_=tuple, default=DEFAULT_CURVE, doc="Of the curve 'user'.")
    overlap_s = param.Number(default=0.12, bounds=(0.0, 0.5))
    inertial_s = param.Number(
        default=0.12, bounds=(0.0, 0.3), inclusive_bounds=(False, True), doc="Of mode 'inertial'."
    )
    rule = param.Selector(default="shared-phone", objects=["shared-phone", "paper"])
    mesh = param.String(default="base")
    deformer = param.String(default="bid")
    pins = param.ClassSelector(class_=tuple, default=(), doc="Units that must speak target phones.")
    bans = param.ClassSelector(class_=tuple, default=(), doc="Units and recordings that must not be used.")
    base = param.ClassSelector(class_=ConfigBase, doc="Config of the values that have no parameter here.")
    options = param.ClassSelector(class_=Options, allow_None=True, default=None, doc="Of the place.")

    edits = param.Integer(default=0, doc="Grows with every change of the history.")
    kept = param.Dict(default=None, allow_None=True, doc="Setting A, to compare with; None: not kept yet.")
    side = param.Selector(default="B", objects=["A", "B"], doc="Which of the two is shown.")

    def __init__(self, base: ConfigBase | None = None, **values: Any) -> None:
        base = base or default_config()
        self._restoring = False
        self._pins_of: dict[tuple[str, str], tuple[str, ...]] = {}
        self._aside: dict[str, Any] = {}
        self.history = History()
        super().__init__(**{**self._from_config(base), **values, "base": base})
        self._spoken = self.target
        self.param.watch(self._edited, list(EDITABLE))

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
        return config_with(self.base, **{place: getattr(self, n) for n, place in SETTINGS.items()})

    def load_config(self, config: ConfigBase) -> None:
        """Take over every value of a config, also those that have no parameter here."""
        self.param.update(**self._from_config(config), base=config)

    def take_config(self, config: ConfigBase, spoken: Mapping[str, Any], what: str) -> None:
        """Take over a config as one change that can be undone.

        Parameters
        ----------
        config : config
        spoken : mapping
            `target_kind`, `sentence`, `text`, `held_out`, as far as they are to be others.
        what : str
            The change in words, for the history.
        """
        self.side = "B"
        self._pins_of[self._spoken] = self.pins
        self.restore({**self._from_config(config), "base": config, **spoken})
        self.history.record(self.values, time.time(), what)
        self.edits += 1

    @property
    def target(self) -> tuple[str, str]:
        """What is spoken: ("recording", id) or ("text", words)."""
        return target_of({n: getattr(self, n) for n in _TARGET})

    def begin_history(self) -> None:
        """Begin anew with the present values, which are setting A too."""
        self.history = History()
        self.history.record(self.values, time.time())
        self._spoken, self._pins_of = self.target, {}
        self.param.update(kept=self.values, side="B", edits=self.edits + 1)

    @property
    def phones(self) -> tuple[str, ...]:
        """Labels of the phones of the target; empty while they are not known."""
        return ()

    @property
    def values(self) -> dict[str, Any]:
        """Every editable value."""
        return {name: getattr(self, name) for name in EDITABLE}

    def restore(self, values: Mapping[str, Any]) -> None:
        """Take over editable values (of the history); this is no new entry of it."""
        self._restoring = True
        try:
            self.param.update(**{k: v for k, v in values.items() if k in EDITABLE}, options=None)
            self._spoken = self.target
        finally:
            self._restoring = False
        self.edits += 1

    def _edited(self, *events: Any) -> None:
        if self._restoring:
            return
        if self.target != self._spoken:
            self._pins_of[self._spoken] = self.pins
            self._spoken, self._restoring = self.target, True
            pins = self._pins_of.get(self.target, ())
            try:
                self.param.update(pins=pins, options=None)
            finally:
                self._restoring = False
        if self.history.entries:
            self.side = "B"
            self.history.record(self.values, time.time(), phones=self.phones)
            self.edits += 1

    def undo(self) -> bool:
        """Go back one change; False when there is none."""
        return self._go(self.history.undo())

    def redo(self) -> bool:
        """Take the last undone change again; False when there is none."""
        return self._go(self.history.redo())

    def go_to(self, number: int) -> bool:
        """Go to an entry of the history; False when it is not there."""
        return self._go(self.history.go(number))

    def _go(self, values: Mapping[str, Any] | None) -> bool:
        if values is None:
            return False
        self.side = "B"
        self.restore(values)
        return True

    def keep_as_a(self) -> None:
        """Make the present settings setting A."""
        self.param.update(kept=self.values, side="B")
        self.edits += 1

    @property
    def other_settings(self) -> dict[str, Any]:
        """The settings of the side that is not shown; kept for another target, A has no pins in this one."""
        shown = (self.kept or {}) if self.side == "B" else self._aside
        own = self.side == "A" or self._same_target_as_a()
        pins = shown.get("pins", ()) if own else ()
        return {n: shown.get(n, getattr(self, n)) for n in SETTINGS} | {"pins": pins}

    def swap_sides(self) -> bool:
        """Show setting A, or the edited one again; the sentence stays. False when they do not differ."""
        if not self.difference:
            return False
        other = self.other_settings
        if self.side == "B":
            self._aside = {n: getattr(self, n) for n in SETTINGS}
        self.side = "A" if self.side == "B" else "B"
        self.restore(other)
        return True

    def _same_target_as_a(self) -> bool:
        return bool(self.kept) and target_of(self.kept) == self.target

    @property
    def difference(self) -> str:
        """In words, what setting B has changed from setting A; empty when nothing."""
        if not self.kept:
            return ""
        here, other = {n: getattr(self, n) for n in SETTINGS}, self.other_settings
        before, after = (here, other) if self.side == "A" else (other, here)
        return change_text(before, after, self.phones)
