"""The blend page's work area, fed by a session: head, g(u), lane and inspector follow it."""

from __future__ import annotations

from typing import Any

import panel as pn

from corpus_tools.mesh import CHARACTERS, DEFORMERS
from corpus_tools.methods import METHODS
from corpus_tools.synthesis import WEIGHTINGS
from workbench.state import Result, Session, fragment_details
from workbench.views.controls import Controls, preset_buttons, select, slider
from workbench.views.face import Face
from workbench.views.inspector import details_html
from workbench.views.lane import Lane, WeightingPlot
from workbench.views.shell import Board
from workbench.views.theme import style_sheet

__all__ = ["PRESETS", "BlendBoard", "FragmentInspector", "head_text", "settings_panel"]

_SHORT = {
    "raised-cosine": "Cosine",
    "smoothstep": "Smooth",
    "smootherstep": "Smoother",
}
_RULES = {"Shared phone": "shared-phone", "As printed": "paper"}


def _presets() -> dict[str, str]:
    return {_SHORT.get(name, name.capitalize()): name for name in WEIGHTINGS}


PRESETS = _presets()
"""Label -> weighting function, in the order of the keys 1, 2, ..."""


def head_text(result: Result) -> str:
    """Return which head is shown and how large it is."""
    mesh, n_markers = result.head.mesh, len(result.head.names)
    return f"{mesh.name} head · {mesh.n_vertices} vertices · {n_markers} markers"


class BlendBoard(pn.viewable.Viewer):
    """Face, g(u) with its sliders, and lane.

    Parameters
    ----------
    session : Session
    controls : Controls
    clock : str
        Id of the clock that moves face and lane.
    """

    def __init__(self, session: Session, controls: Controls, clock: str, **params: Any) -> None:
        self._session = session
        super().__init__(**params)
        self.face = Face(clock=clock, theme=session.theme)
        self.lane = Lane(session=clock, theme=session.theme)
        self.plot = WeightingPlot(theme=session.theme)
        self.presets = preset_buttons(controls, "Weighting function g(u)", "weighting", PRESETS)
        self.overlap = slider(
            controls, "Longest overlap, s", "overlap_s", (0.0, 0.3), step=0.005, format="0.000"
        )
        self.shape = slider(
            controls, "Crossover early – late", "shape", (-1.0, 1.0), step=0.02, format="0.00"
        )
        self.board = Board(
            face=self.face.view,
            presets=self.presets,
            plot=self.plot,
            sliders=pn.Row(self.overlap, self.shape, sizing_mode="stretch_width", margin=0),
            lane=self.lane,
        )
        session.param.watch(self._theme, "theme")
        session.param.watch(self._result, "result")
        session.param.watch(self._select, "selected")
        session.param.watch(self._curve, ["weighting", "shape"])
        session.param.watch(self._state, ["message", "working"])
        self.lane.param.watch(self._picked, "selected")
        self._curve()
        self._result()

    def _theme(self, event: Any) -> None:
        for view in (self.face, self.lane, self.plot):
            view.theme = event.new

    def _select(self, event: Any) -> None:
        self.lane.selected = self.plot.selected = event.new

    def _picked(self, event: Any) -> None:
        result = self._session.result
        if result is not None and 0 <= event.new < len(result.selection.chosen):
            self._session.selected = event.new

    def _curve(self, *events: Any) -> None:
        self.plot.draw(self._session.weighting, self._session.shape)

    def _state(self, *events: Any) -> None:
        session = self._session
        shown = session.result is not None and session.result.request.sentence == session.sentence
        stale = session.working and not shown
        self.board.param.update(message=session.message, stale=stale)

    def _result(self, *events: Any) -> None:
        result = self._session.result
        if result is None:
            self.lane.clear()
            self.plot.joins = []
            return
        self.face.show(result)
        self.lane.show(result)
        self.lane.selected = self.plot.selected = self._session.selected
        self.plot.joins = self.lane.joins
        n = len(result.selection.chosen)
        self.board.param.update(
            head_text=head_text(result),
            lane_text=f"{result.selection.method} · {n} fragment{'s' * (n != 1)} · "
            f"{n - 1} join{'s' * (n != 2)} · cost {result.selection.total_cost:.2f}",
            held_out_text=f"recording {result.request.sentence} held out" if result.request.held_out else "",
        )
        self._state()

    def __panel__(self) -> Any:
        return self.board


class FragmentInspector(pn.viewable.Viewer):
    """What the selected fragment is, why it was chosen, and what was turned down."""

    def __init__(self, session: Session, **params: Any) -> None:
        self._session = session
        super().__init__(**params)
        self.pane = pn.pane.HTML(stylesheets=[style_sheet()], sizing_mode="stretch_width", margin=0)
        session.param.watch(self._update, ["result", "selected", "theme"])
        self._update()

    def _update(self, *events: Any) -> None:
        s = self._session
        details = None
        if s.result is not None and s.selected < len(s.result.selection.chosen):
            details = fragment_details(s.result, s.selected)
        self.pane.object = details_html(details, s.theme)

    def __panel__(self) -> Any:
        return self.pane


def settings_panel(controls: Controls) -> pn.Column:
    """Return the choices that are not g(u): method, overlap rule, head, deformer."""
    methods = {name.capitalize(): name for name in METHODS}
    heads = {name.capitalize(): name for name in CHARACTERS}
    deformers = {name.upper() if name == "rbf" else name.capitalize(): name for name in DEFORMERS}
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
