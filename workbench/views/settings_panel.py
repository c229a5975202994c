"""Choices of the blend page: the names of g(u), method, overlap rule, head, deformer."""

from __future__ import annotations

import html
from typing import Any

import panel as pn
import panel_material_ui as pmui

from corpus_tools.mesh import CHARACTERS, DEFORMERS
from corpus_tools.methods import SEARCHES
from corpus_tools.synthesis import WEIGHTINGS
from workbench.state import Session
from workbench.views.action_html import ActionHtml
from workbench.views.controls import Controls, select

__all__ = ["PRESETS", "SettingsPanel", "settings_html"]

_SHORT = {
    "exponential": "Exp.",
    "raised-cosine": "Raised c.",
    "smoothstep": "Smooth",
    "smootherstep": "Smoother",
}
"""Names of g(u) that have no room: each is cut, so that the config's name is known in it."""
_RULES = {"Shared phone": "shared-phone", "As printed": "paper"}


def _presets() -> dict[str, str]:
    return {_SHORT.get(name, name.capitalize()): name for name in WEIGHTINGS}


PRESETS = _presets()
"""Label -> weighting function, in the order of the keys 1, 2, ..."""


def _labels() -> dict[str, dict[str, str]]:
    """Return label -> value of every choice, by parameter of the session."""
    return {
        "method": {name.capitalize(): name for name in SEARCHES},
        "rule": _RULES,
        "mesh": {name.capitalize(): name for name in CHARACTERS},
        "deformer": {n.upper() if n in ("rbf", "bid") else n.capitalize(): n for n in DEFORMERS},
    }


def settings_html(session: Session, shown: bool) -> str:
    """Return the line that says the settings and folds them out: "Settings  Viterbi · Base · BID"."""
    said = []
    for name, options in _labels().items():
        value = getattr(session, name)
        said.append(next((label for label, v in options.items() if v == value), value))
    return (
        f'<button type="button" class="fold" data-action="fold" aria-expanded="{str(shown).lower()}" '
        f'title="Method, overlap rule, head, deformer"><b>Settings</b> '
        f"<span>{html.escape(' · '.join(said))}</span>"
        f'<i aria-hidden="true">{"▾" if shown else "▸"}</i></button>'
    )


class SettingsPanel(pn.viewable.Viewer):
    """The choices that are not g(u): method, overlap rule, head, deformer; folded to one line that says them.

    Parameters
    ----------
    session : Session
    controls : Controls
    """

    def __init__(self, session: Session, controls: Controls, **params: Any) -> None:
        self._session = session
        super().__init__(**params)
        self._line = ActionHtml(on_action=lambda action, value: self.fold())
        self._rows = pn.Column(*self._selects(controls), sizing_mode="stretch_width", margin=0, visible=False)
        session.param.watch(self._update, list(_labels()))
        self._update()

    def _selects(self, controls: Controls) -> list[Any]:
        pair = {"margin": (10, 4, 2, 12)}, {"margin": (10, 12, 2, 4)}
        labels = _labels()
        rows = []
        for couple in (
            (("Method", "method"), ("Overlap rule", "rule")),
            (("Head", "mesh"), ("Deformer", "deformer")),
        ):
            made = [
                select(controls, label, name, labels[name], **place)
                for (label, name), place in zip(couple, pair, strict=True)
            ]
            rows.append(pn.Row(*made, sizing_mode="stretch_width", margin=0))
        self.beside = controls.make(
            pmui.MultiChoice,
            label="Heads beside it",
            options=labels["mesh"],
            variant="outlined",
            sizing_mode="stretch_width",
            margin=(10, 12, 2, 12),
        )
        controls.tie(self.beside, "beside")
        return [*rows, self.beside]

    def fold(self) -> None:
        """Fold the choices out, or in again."""
        self._rows.visible = not self._rows.visible
        self._update()

    def _update(self, *events: Any) -> None:
        self._line.html = settings_html(self._session, bool(self._rows.visible))

    def __panel__(self) -> Any:
        return pn.Column(self._line, self._rows, sizing_mode="stretch_width", margin=0)
