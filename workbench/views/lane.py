"""Lane of fragments and plot of g(u): canvases on the shared clock, fed with plain data."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt
import panel as pn
import param

from workbench.state import THEMES, Result, aperture_curves, joins_data, score
from workbench.views.esm import esm
from workbench.views.theme import palettes, style_sheet

__all__ = ["NO_EFFECT", "Lane", "Points", "WeightingPlot", "on_curve"]

_NO_SCORE = {"duration": 1.0, "phones": [], "fragments": []}
NO_EFFECT: dict[str, Any] = {"overlaps": [], "curves": [], "now": None, "other": None}
Points = list[tuple[float, float]]


def on_curve(points: Points, values: npt.ArrayLike) -> Points:
    """Return the handles moved up or down onto a curve.

    Parameters
    ----------
    points : list of (u, g)
    values : (n,) array_like
        The curve at even u from 0 to 1.
    """
    g = np.asarray(values, float)
    even = np.linspace(0.0, 1.0, len(g))
    return [(u, float(np.interp(u, even, g))) for u, _ in points]


class Lane(pn.custom.JSComponent):
    """Target phones, chosen fragments, lip aperture and joins of a result on one time axis.

    A click selects a fragment (`selected`), a drag on the curve moves the clock, the wheel zooms.
    """

    score = param.Dict(default=_NO_SCORE, doc="Phones and fragments, as of workbench.state.score.")
    joins = param.List(default=[])
    curves = param.Dict(default={}, doc="As of workbench.state.aperture_curves.")
    band = param.Dict(default={}, doc="As of workbench.state.band_data.")
    selected = param.Integer(default=0)
    theme = param.Selector(default="light", objects=list(THEMES))
    palettes = param.Dict(default={})
    session = param.String(default="default", doc="Id of the clock.")

    _esm = esm("lane", "renderLane")
    _stylesheets: ClassVar[list[Any]] = [style_sheet()]

    def __init__(self, on_swap: Callable[[int, int], None] | None = None, **params: Any) -> None:
        self._on_swap = on_swap
        super().__init__(**{"sizing_mode": "stretch_both", "palettes": palettes(), **params})

    def show(self, result: Result, other: Result | None = None, side: str = "B") -> None:
        """Show a result, and that of the other setting dashed; the joins tell A's ratio before B's.

        Only what changed is sent (a drag of g(u): curves and joins).
        """
        changes: dict[str, Any] = {
            "joins": joins_data(result, other if side == "B" else None),
            "curves": aperture_curves(result, other),
        }
        phones_and_fragments = score(result)
        if phones_and_fragments != self.score:
            changes["score"] = phones_and_fragments
        self.param.update(**changes)

    def clear(self) -> None:
        """Show nothing."""
        self.param.update(score=_NO_SCORE, joins=[], curves={}, band={}, selected=0)

    def _handle_msg(self, data: Any) -> None:
        if data.get("type") == "swap" and self._on_swap is not None:
            self._on_swap(int(data["fragment"]), int(data["option"]))


class WeightingPlot(pn.custom.JSComponent):
    """The curve g(u) with handles, and the peak acceleration of one join for every curve and overlap.

    Parameters
    ----------
    on_points : callable, optional
        ``on_points(points)`` with [[u, g], ...] of the handles when one was moved.
    """

    values = param.Bytes(default=b"", doc="g at even u, float32.")
    other_values = param.Bytes(default=b"", doc="g of setting A; empty when it is the same.")
    points = param.List(default=[], doc="Handles of the user's own curve; empty: they lie on the curve.")
    label = param.String(default="")
    title = param.String(default="")
    hint = param.String(default="")
    effect = param.Dict(default=NO_EFFECT)
    unused = param.String(default="", doc="Why g(u) does nothing now: it is drawn grey, without handles.")
    theme = param.Selector(default="light", objects=list(THEMES))
    palettes = param.Dict(default={})

    _esm = esm("curve", "renderCurve")
    _stylesheets: ClassVar[list[Any]] = [style_sheet()]

    def __init__(self, on_points: Callable[[Points], None] | None = None, **params: Any) -> None:
        self._on_points = on_points
        super().__init__(**{"sizing_mode": "stretch_both", "palettes": palettes(), **params})

    def draw(self, values: npt.ArrayLike, label: str, other: npt.ArrayLike | None = None) -> None:
        """Draw g at even u, and that of setting A where it is another one."""
        self.param.update(
            values=np.asarray(values, np.float32).tobytes(),
            other_values=b"" if other is None else np.asarray(other, np.float32).tobytes(),
            label=label,
        )

    def _handle_msg(self, data: Any) -> None:
        if data.get("type") == "points" and self._on_points is not None:
            self._on_points([(float(u), float(g)) for u, g in data["points"]])
