"""The session's clock as a moving line over a Bokeh or HoloViews plot."""

from __future__ import annotations

from typing import Any

import panel as pn
import param

from workbench.state import THEMES
from workbench.views.esm import esm
from workbench.views.theme import palettes

__all__ = ["ClockPane"]


class ClockPane(pn.custom.JSComponent):
    """A plot with the clock's cursor over it.

    Parameters
    ----------
    object : viewable
        A Bokeh figure, a HoloViews element or a pane of one; its x axis is time in seconds. Every plot in it
        gets a cursor. The line stands above the plot: Bokeh draws nothing anew when it moves.
    session : str
        Id of the clock.
    theme : "light" or "dark"
    """

    object = pn.custom.Child()
    session = param.String(default="default")
    theme = param.Selector(default="light", objects=list(THEMES))
    palettes = param.Dict(default={})

    _esm = esm("clock_pane", "renderClockPane")

    def __init__(self, object: Any, **params: Any) -> None:
        super().__init__(**{"object": object, "palettes": palettes(), **params})
