"""The blend page's work area, fed by a session: head, g(u), lane and inspector follow it."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import panel as pn

from corpus_tools.mesh import CHARACTERS, DEFORMERS
from corpus_tools.methods import METHODS
from corpus_tools.synthesis import WEIGHTINGS, curve_through
from workbench.actions import ban_unit, options_shown, swap_to, swap_unit, toggle_pin, unban
from workbench.state import (
    Effects,
    Result,
    Session,
    band_data,
    effect_data,
    fragment_details,
    missing_of,
    pin_at,
    stand_ins,
    weighting_samples,
)
from workbench.views.action_html import ActionHtml
from workbench.views.controls import Controls, preset_buttons, select, slider
from workbench.views.face import Face
from workbench.views.history_list import compare_html, history_html
from workbench.views.inspector import bans_html, details_html, options_html
from workbench.views.lane import NO_EFFECT, Lane, Points, WeightingPlot
from workbench.views.shell import Board
from workbench.views.trajectories import Trajectories

__all__ = [
    "PRESETS",
    "BlendBoard",
    "FragmentInspector",
    "head_text",
    "lower_text",
    "missing_text",
    "settings_panel",
]

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


def head_text(result: Result) -> str:
    """Return which head is shown and how large it is."""
    mesh, n_markers = result.head.mesh, len(result.head.names)
    return f"{mesh.name} head · {mesh.n_vertices} vertices · {n_markers} markers"


def missing_text(result: Result) -> str:
    """Return which diphones the corpus does not hold, and what stood in; empty when it holds all."""
    stood = stand_ins(result)
    if not stood:
        return ""
    gone = ", ".join(f"{a}-{b}" for a, b in missing_of(result)) or "Banned units"
    more = f" and {len(stood) - 3} more" if len(stood) > 3 else ""
    return f"No motion for {gone}: {'; '.join(stood[:3])}{more}"


def lower_text(effects: Effects | None, result: Result, join: int) -> str:
    """Return what would bring a join lower still, empty when nothing does by more than 2 %."""
    best = effects.best(join) if effects is not None and effects.fits(result) else None
    if best is None or best[2] > 0.98 * result.ratios[join]:
        return ""
    return f"lower still: {best[0]} at {1000 * best[1]:.0f} ms, {best[2]:.2f}"


class BlendBoard(pn.viewable.Viewer):
    """Face, g(u) with its sliders, and lane.

    Parameters
    ----------
    session : Session
    controls : Controls
    clock : str
        Id of the clock that moves face and lane.
    on_cancel : callable
        Stops what is under way.
    """

    def __init__(
        self,
        session: Session,
        controls: Controls,
        clock: str,
        on_cancel: Callable[[], None],
        **params: Any,
    ) -> None:
        self._session, self._on_cancel = session, on_cancel
        self._began_s = 0.0
        super().__init__(**params)
        self.face = Face(clock=clock, theme=session.theme)
        self.inset = Face(clock=clock, theme=session.theme)
        self.inset.mesh_view.description = "Recorded head"
        self.face.mesh_view.param.watch(self._look, "camera")
        self.lane = Lane(on_swap=self._swap, session=clock, theme=session.theme)
        self._handles: tuple[tuple[float, ...], Points] = ((), [])
        self.plot = WeightingPlot(on_points=self._points, theme=session.theme)
        self.trajectories = Trajectories(session, controls, clock)
        self.presets = preset_buttons(controls, "Weighting function g(u)", "weighting", PRESETS)
        self.overlap = slider(
            controls, "Longest overlap, s", "overlap_s", (0.0, 0.3), step=0.005, format="0.000"
        )
        self.shape = slider(
            controls, "Crossover early – late", "shape", (-1.0, 1.0), step=0.02, format="0.00"
        )
        self.board = Board(
            face=self.face.view,
            inset=self.inset.view,
            presets=self.presets,
            plot=self.plot,
            sliders=pn.Row(self.overlap, self.shape, sizing_mode="stretch_width", margin=0),
            lane=self.lane,
            curves=self.trajectories.__panel__(),
            on_action=self._act,
        )
        watch = session.param.watch
        watch(self._theme, "theme")
        watch(self._result, ["result", "other"])
        watch(self._recorded, "recorded")
        watch(self._select, "selected")
        watch(self._curve, ["weighting", "shape", "curve_weights", "kept", "side"])
        watch(self._effect, ["result", "other", "effects", "selected"])
        watch(self._state, ["message", "working", "side", "edits"])
        watch(self._opening, ["status", "fraction", "doing", "corpus", "target_kind", "text"])
        self.lane.param.watch(self._picked, "selected")
        self.face.show_rest(session.mesh)
        self._curve()
        self._result()
        self._opening()

    def _look(self, event: Any) -> None:
        """Look at the recording as at the blend."""
        self.inset.mesh_view.camera = dict(event.new)

    def _recorded(self, event: Any) -> None:
        if event.new is not None:
            self.inset.show(event.new)
            self.inset.mesh_view.camera = dict(self.face.mesh_view.camera)
        self.board.inset_shown = event.new is not None

    def _opening(self, *events: Any) -> None:
        session = self._session
        if any(e.name == "status" for e in events) or not self._began_s:
            self._began_s = time.monotonic()
        passed = time.monotonic() - self._began_s
        opening = session.status == "opening" and session.corpus is None
        hint = ""
        if session.corpus is not None and session.request() is None:
            hint = "Type a sentence above, and press Enter to hear and see it."
        left = passed * (1 - session.fraction) / session.fraction if session.fraction > 0.05 else 0.0
        self.board.param.update(
            title="Opening the corpus" if session.folder else "Making the simulated demo corpus",
            doing=(session.doing or "starting") if opening else "",
            fraction=session.fraction,
            left_text=f"about {left:.0f} s left" if left >= 1 else "",
            hint=hint,
        )

    def _theme(self, event: Any) -> None:
        for view in (self.face, self.inset, self.lane, self.plot):
            view.theme = event.new

    def _select(self, event: Any) -> None:
        self.lane.selected = event.new

    def _picked(self, event: Any) -> None:
        if event.new != self._session.selected:
            self._session.select(event.new)

    def _swap(self, fragment: int, option: int) -> None:
        self._session.select(fragment)
        swap_to(self._session, option)

    def _act(self, action: str) -> None:
        if action == "sides":
            self._session.swap_sides()
        elif action == "cancel":
            self._on_cancel()
        elif action == "view":
            self.switch_view()

    def switch_view(self) -> None:
        """Show the trajectories instead of the lane, or the lane again."""
        curves = self.board.shown == "lane"
        self.board.shown = "curves" if curves else "lane"
        self.trajectories.shown = curves

    def _points(self, points: Points) -> None:
        """Let the person's own curve go through the handles."""
        weights = curve_through(points)
        self._handles = (weights, points)
        self._session.param.update(curve_weights=weights, weighting="user", shape=0.0)

    def _curve(self, *events: Any) -> None:
        session = self._session
        values = weighting_samples(session.weighting, session.shape, session.curve_weights)
        other = None
        if session.kept and session.difference:
            kept = session.other_settings
            other = weighting_samples(kept["weighting"], kept["shape"], kept["curve_weights"])
        mine = session.weighting == "user" and session.curve_weights == self._handles[0]
        self.plot.points = [list(p) for p in self._handles[1]] if mine and not session.shape else []
        self.plot.draw(values, session.weighting, other)

    def _effect(self, *events: Any) -> None:
        session, result = self._session, self._session.result
        if result is None:
            return
        band = band_data(session.effects)
        if self.lane.band != band:
            self.lane.band = band
        join = max(0, session.selected - 1)
        a_and_b = (result, session.other) if session.side == "B" else (session.other or result, result)
        data = effect_data(session.effects, a_and_b[0], a_and_b[1], join)
        title, hint = "Peak acceleration ÷ natural p95", ""
        if join < len(result.ratios):
            title = f"Join {join + 1}, {result.trajectory.joins[join].phone}: peak accel. ÷ natural p95"
            hint = lower_text(session.effects, result, join)
        self.plot.param.update(effect=data, title=title, hint=hint)

    def _state(self, *events: Any) -> None:
        session = self._session
        request = session.request()
        result = session.result
        shown = result is not None and request is not None and result.request.same_target(request)
        self.board.param.update(
            message=session.message,
            stale=session.working and not shown,
            side=session.side,
            compared=bool(session.difference),
        )

    def _result(self, *events: Any) -> None:
        result = self._session.result
        if result is None:
            self.lane.clear()
            self.plot.param.update(effect=NO_EFFECT, title="", hint="")
            return
        if self.face.result is not result:
            self.face.show(result)
        self.lane.show(result, self._session.other if self._session.side == "B" else None)
        self.lane.selected = self._session.selected
        n = len(result.selection.chosen)
        self.board.param.update(
            head_text=head_text(result),
            lane_text=f"{result.selection.method} · {n} fragment{'s' * (n != 1)} · "
            f"{n - 1} join{'s' * (n != 2)} · cost {result.selection.total_cost:.2f}",
            held_out_text=f"recording {result.request.sentence} held out" if result.request.exclude else "",
            warning=missing_text(result),
        )
        self._state()

    def __panel__(self) -> Any:
        return self.board


class FragmentInspector(pn.viewable.Viewer):
    """What the selected fragment is and why, what else could speak its place, A and B, the history.

    Parameters
    ----------
    session : Session
    on_hear : callable
        ``on_hear(option)`` plays a fragment in its own recording; None: the selected one.
    """

    def __init__(self, session: Session, on_hear: Callable[[int | None], None], **params: Any) -> None:
        self._session, self._on_hear = session, on_hear
        super().__init__(**params)
        self.pane = ActionHtml(on_action=self.act)
        watched = ["result", "other", "selected", "options", "theme", "edits", "side", "kept"]
        session.param.watch(self._update, watched)
        self._update()

    def act(self, action: str, value: str = "") -> None:
        """Do what a button, a row or a key asks for."""
        session = self._session
        number = int(value) if value.lstrip("-").isdigit() else 0
        commands: dict[str, Callable[[], object]] = {
            "swap": lambda: swap_to(session, number),
            "step": lambda: swap_unit(session, number),
            "pin": lambda: toggle_pin(session),
            "ban": lambda: ban_unit(session),
            "unban": lambda: unban(session, value),
            "hear": lambda: self._on_hear(None),
            "sides": session.swap_sides,
            "keep": session.keep_as_a,
            "go": lambda: session.go_to(number),
        }
        if action in commands:
            commands[action]()

    def _update(self, *events: Any) -> None:
        s, details = self._session, None
        if s.result is not None and s.selected < len(s.result.selection.chosen):
            details = fragment_details(s.result, s.selected)
        rate = s.result.trajectory.rate_hz if s.result is not None else 120.0
        parts = [details_html(details, s.theme, rate)]
        options = options_shown(s)
        if options is not None and s.result is not None:
            chosen = s.result.selection.chosen[s.selected]
            pinned = bool(pin_at(s.pins, chosen.first, chosen.last))
            parts.append(options_html(options, s.text_of, pinned))
        parts += [bans_html(s.bans), compare_html(s), history_html(s)]
        self.pane.html = "".join(parts)

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
