"""Lane of fragments and plot of g(u): canvases on the shared clock, fed with plain data."""

from __future__ import annotations

from typing import Any, ClassVar

import panel as pn
import param

from workbench.state import THEMES, Result, aperture_curves, joins_data, score, weighting_samples
from workbench.views.esm import esm
from workbench.views.theme import palettes, style_sheet

__all__ = ["Lane", "WeightingPlot"]

_NO_SCORE = {"duration": 1.0, "phones": [], "fragments": []}


class Lane(pn.custom.JSComponent):
    """Target phones, chosen fragments, lip aperture and joins of a result on one time axis.

    A click selects a fragment (`selected`), a drag on the curve moves the clock, the wheel zooms.
    """

    score = param.Dict(default=_NO_SCORE, doc="Phones and fragments, as of workbench.state.score.")
    joins = param.List(default=[])
    curves = param.Dict(default={})
    selected = param.Integer(default=0)
    theme = param.Selector(default="light", objects=list(THEMES))
    palettes = param.Dict(default={})
    session = param.String(default="default", doc="Id of the clock.")

    _esm = esm("lane", "renderLane")
    _stylesheets: ClassVar[list[Any]] = [style_sheet()]

    def __init__(self, **params: Any) -> None:
        super().__init__(**{"sizing_mode": "stretch_both", "palettes": palettes(), **params})

    def show(self, result: Result) -> None:
        """Show a result; only what changed is sent (a drag of g(u) changes curves and joins)."""
        changes: dict[str, Any] = {"joins": joins_data(result), "curves": aperture_curves(result)}
        phones_and_fragments = score(result)
        if phones_and_fragments != self.score:
            changes["score"] = phones_and_fragments
        self.param.update(**changes)

    def clear(self) -> None:
        """Show nothing."""
        self.param.update(score=_NO_SCORE, joins=[], curves={}, selected=0)


class WeightingPlot(pn.custom.JSComponent):
    """The curve g(u) of both fragments, and the peak acceleration of every join on the natural range."""

    values = param.Bytes(default=b"", doc="g at even u, float32.")
    label = param.String(default="")
    joins = param.List(default=[])
    selected = param.Integer(default=0)
    theme = param.Selector(default="light", objects=list(THEMES))
    palettes = param.Dict(default={})

    _esm = esm("curve", "renderCurve")
    _stylesheets: ClassVar[list[Any]] = [style_sheet()]

    def __init__(self, **params: Any) -> None:
        super().__init__(**{"sizing_mode": "stretch_both", "palettes": palettes(), **params})

    def draw(self, weighting: str, shape: float) -> None:
        """Draw the weighting function `weighting` with crossover `shape`."""
        values = weighting_samples(weighting, shape).astype("float32").tobytes()
        self.param.update(values=values, label=weighting)
