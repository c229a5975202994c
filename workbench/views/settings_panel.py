"""Choices of the blend page: the names of g(u), method, overlap rule, head, deformer."""

from __future__ import annotations

import panel as pn

from corpus_tools.mesh import CHARACTERS, DEFORMERS
from corpus_tools.methods import SEARCHES
from corpus_tools.synthesis import WEIGHTINGS
from workbench.views.controls import Controls, select

__all__ = ["PRESETS", "settings_panel"]

_SHORT = {
    "exponential": "Exp.",
    "user": "Yours",
    "raised-cosine": "Cosine",
    "smoothstep": "Smooth",
    "smootherstep": "Smoother",
}
_RULES = {"Shared phone": "shared-phone", "As printed": "paper"}


def _presets() -> dict[str, str]:
    return {_SHORT.get(name, name.capitalize()): name for name in WEIGHTINGS}


PRESETS = _presets()
"""Label -> weighting function, in the order of the keys 1, 2, ..."""


def settings_panel(controls: Controls) -> pn.Column:
    """Return the choices that are not g(u): method, overlap rule, head, deformer."""
    methods = {name.capitalize(): name for name in SEARCHES}
    heads = {name.capitalize(): name for name in CHARACTERS}
    deformers = {name.upper() if name in ("rbf", "bid") else name.capitalize(): name for name in DEFORMERS}
    pair = {"margin": (10, 4, 2, 12)}, {"margin": (10, 12, 2, 4)}
    return pn.Column(
        pn.Row(
            select(controls, "Method", "method", methods, **pair[0]),
            select(controls, "Overlap rule", "rule", _RULES, **pair[1]),
            sizing_mode="stretch_width",
            margin=0,
        ),
        pn.Row(
            select(controls, "Head", "mesh", heads, **pair[0]),
            select(controls, "Deformer", "deformer", deformers, **pair[1]),
            sizing_mode="stretch_width",
            margin=0,
        ),
        sizing_mode="stretch_width",
        margin=0,
    )
