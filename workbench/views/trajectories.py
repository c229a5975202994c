"""Trajectories of lips, jaw or one marker: blend, fragments, recording and natural range, joins shaded."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import holoviews as hv
import numpy as np
import panel as pn

from workbench.state import (
    Result,
    Session,
    Signal,
    marker_signal,
    signal_band,
    signal_data,
    signals_of,
    tokens,
)
from workbench.views.clock_pane import ClockPane
from workbench.views.controls import Controls

__all__ = ["LIPS", "SPEEDS", "Trajectories", "signal_overlay", "source_columns"]

NOTE_FIRST_MS = 40
"""Wait before plots are made, so that the page says so first."""
LIPS, SPEEDS = "Lips and jaw", "Velocities of lips and jaw"


def source_columns(data: dict[str, Any], name: str) -> list[dict[str, Any] | None]:
    """Return the columns of each element of :func:`signal_overlay` in order; None: they do not change."""
    paths = [{"xs": [x for x, _ in lines], "ys": [y for _, y in lines]} for lines in data["beyond"]]
    now = {"time": data["now"][0], name: data["now"][1]}
    return [None, None, *paths, now, {"x0": data["spans"][0], "x1": data["spans"][1]}]


def signal_overlay(result: Result, signal: Signal, speed: bool, theme: str) -> hv.Overlay:
    """Return one plot: natural range, recording, continuations, blend, and the overlaps shaded.

    Parameters
    ----------
    result : Result
    signal : Signal
    speed : bool
        Its rate of change, mm/s; the natural range is then left out.
    theme : "light" or "dark"
    """
    t = tokens(theme)
    data = signal_data(result, signal, speed, len(t.sources))
    times, low, high = (np.zeros(0),) * 3 if speed else signal_band(result, signal)
    band = hv.Area((times, low, high), "time", [signal.id, f"{signal.id} high"])
    beyond = [
        hv.Path(lines, ["time", signal.id]).opts(color=colour, line_dash="dotted", line_width=1.4)
        for lines, colour in zip(data["beyond"], t.sources.values(), strict=True)
    ]
    recorded = hv.Curve(data["recorded"], "time", signal.id)
    now = hv.Curve(data["now"], "time", signal.id)
    shaded = hv.VSpans(tuple(list(v) for v in data["spans"]))
    return hv.Overlay(
        [
            band.opts(color=t.colours["nat"], alpha=0.2, line_alpha=0),
            recorded.opts(color=t.colours["nat"], line_width=1.6),
            *beyond,
            now.opts(color=t.colours["acc"], line_width=2.4),
            shaded.opts(color=t.colours["acc"], alpha=0.12, line_alpha=0),
        ]
    )


def _colours(theme: str) -> list[dict[str, str]]:
    """Return the colours of each element of :func:`signal_overlay` in order, by what they fill."""
    t = tokens(theme)
    acc, nat = t.colours["acc"], t.colours["nat"]
    sources = [{"line_color": colour} for colour in t.sources.values()]
    return [{"fill_color": nat}, {"line_color": nat}, *sources, {"line_color": acc}, {"fill_color": acc}]


def restyle(figure: Any, theme: str) -> None:
    """Give a Bokeh figure the colours and the type of the tokens."""
    t = tokens(theme)
    c = t.colours
    figure.background_fill_color, figure.border_fill_color = c["sunk"], c["panel"]
    figure.outline_line_color = c["line"]
    figure.toolbar.logo = None
    for axis in (*figure.xaxis, *figure.yaxis):
        axis.axis_label_text_color = axis.major_label_text_color = c["ink2"]
        axis.axis_line_color = axis.major_tick_line_color = c["line"]
        axis.minor_tick_line_color = None
        axis.axis_label_text_font_style = "normal"
        axis.axis_label_text_font = axis.major_label_text_font = t.family
        axis.axis_label_text_font_size = axis.major_label_text_font_size = "10px"
    for grid in (*figure.xgrid, *figure.ygrid):
        grid.grid_line_color = c["line2"]


class Trajectories(pn.viewable.Viewer):
    """Three plots on one time axis under the cursor of the clock; drawn only while they are looked at.

    Parameters
    ----------
    session : Session
    controls : Controls
    clock : str
        Id of the clock.
    """

    def __init__(self, session: Session, controls: Controls, clock: str, **params: Any) -> None:
        self._session, self._clock = session, clock
        self._shown = False
        self._drawn: Result | None = None
        self._sources: dict[Signal, list[Any]] = {}
        self._plots: dict[Signal, Any] = {}
        super().__init__(**params)
        import panel_material_ui as pmui

        self.what = controls.make(
            pmui.Select,
            label="Shown",
            options=[LIPS, SPEEDS],
            value=LIPS,
            size="small",
            variant="outlined",
            width=230,
            margin=(8, 8, 0, 76),
        )
        self.what.param.watch(self._build, "value")
        self._place = pn.Column(sizing_mode="stretch_both", margin=0)
        session.param.watch(self._update, "result")
        session.param.watch(self._build, "corpus")
        session.param.watch(self._theme, "theme")

    @property
    def shown(self) -> bool:
        """Whether the plots are looked at; only then they follow the results."""
        return self._shown

    @shown.setter
    def shown(self, shown: bool) -> None:
        self._shown = shown
        doc = pn.state.curdoc
        if shown and doc is not None and doc.session_context is not None:
            doc.add_timeout_callback(self._build, NOTE_FIRST_MS)
        elif shown:
            self._build()

    def _signals(self, result: Result) -> tuple[list[Signal], bool]:
        names = result.trajectory.names
        if self.what.value in names:
            return [marker_signal(self.what.value, axis) for axis in range(3)], False
        return list(signals_of(names)), self.what.value == SPEEDS

    def _build(self, *events: Any) -> None:
        """Make the plots anew: other signals, another corpus."""
        result = self._session.result
        if not self._shown or result is None:
            return
        options = [LIPS, SPEEDS, *result.trajectory.names]
        if self.what.options != options:
            self.what.options = options
        hv.extension("bokeh")
        signals, speed = self._signals(result)
        theme = self._session.theme
        self._sources, self._plots = {}, {}
        plots = []
        for index, signal in enumerate(signals):
            last = index == len(signals) - 1
            overlay = signal_overlay(result, signal, speed, theme)
            plots.append(
                overlay.opts(
                    hv.opts.Overlay(
                        responsive=True,
                        height=102 if last else 84,
                        xaxis="bottom" if last else None,
                        xlabel="",
                        xformatter="%g s",
                        ylabel=f"{signal.label}, {'mm/s' if speed else 'mm'}",
                        yticks=4,
                        show_legend=False,
                        hooks=[lambda plot, element: restyle(plot.state, theme), self._collect(signal)],
                        default_tools=["xwheel_zoom", "xpan", "reset"],
                        active_tools=["xwheel_zoom", "xpan"],
                        toolbar=None,
                    )
                )
            )
        layout = hv.Layout(plots).cols(1).opts(shared_axes=True, toolbar=None)
        pane = pn.pane.HoloViews(layout, sizing_mode="stretch_both", margin=0, linked_axes=False)
        self._drawn = result
        self._place[:] = [
            ClockPane(pane, session=self._clock, theme=theme, sizing_mode="stretch_both", margin=0)
        ]

    def _collect(self, signal: Signal) -> Callable[[Any, Any], None]:
        """Return a hook that keeps the data sources of a plot: new values go there, nothing is made anew."""

        def keep(plot: Any, element: Any) -> None:
            self._plots[signal] = plot
            self._sources[signal] = [part.handles["source"] for part in plot.subplots.values()]

        return keep

    def _theme(self, event: Any) -> None:
        """Give the plots that are there the colours of another theme: to make them anew takes seconds."""
        for plot in self._plots.values():
            restyle(plot.state, event.new)
            for part, colours in zip(plot.subplots.values(), _colours(event.new), strict=True):
                part.handles["glyph"].update(**colours)
        for pane in self._place:
            pane.theme = event.new

    def _update(self, *events: Any) -> None:
        result = self._session.result
        if not self._shown or result is None:
            return
        before = self._drawn
        if before is None or not before.request.same_target(result.request) or not self._sources:
            self._build()
            return
        self._drawn = result
        speed = self._signals(result)[1]
        for signal, sources in self._sources.items():
            columns = source_columns(signal_data(result, signal, speed), signal.id)
            for source, new in zip(sources, columns, strict=True):
                if new is not None:
                    source.data = new

    def __panel__(self) -> Any:
        return pn.Column(self.what, self._place, sizing_mode="stretch_both", margin=0)
