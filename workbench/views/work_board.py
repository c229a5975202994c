"""The blend page's work area, fed by a session: head, g(u), lane and inspector follow it."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import panel as pn

from corpus_tools.synthesis import curve_through
from workbench.actions import swap_to
from workbench.state import (
    Session,
    band_data,
    effect_data,
    held_out_text,
    lane_text,
    weighting_samples,
)
from workbench.views.board_texts import beside_of, head_text, lower_text, missing_text, overlap_label
from workbench.views.controls import Controls, preset_buttons, slider
from workbench.views.face import Face
from workbench.views.head_actors import OVERLAYS
from workbench.views.lane import NO_EFFECT, Lane, Points, WeightingPlot, on_curve
from workbench.views.settings_panel import PRESETS
from workbench.views.shell import Board
from workbench.views.trajectories import Trajectories

__all__ = ["BlendBoard"]

_MODES = {"Cross-fade": "crossfade", "Inertial": "inertial"}
KEYED = "keyed"
"""Class of the slider that the key of the overlap gives the focus to."""
PEAK = "Peak ÷ natural p95"
"""What the number of a join is, in these words wherever it stands."""
_UNUSED = "Inertial joins use no g(u): the offset of the fragments dies away"


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
        self.mode = preset_buttons(controls, "How fragments are joined", "mode", _MODES)
        self.mode.param.update(sizing_mode=None, width=170)
        self.overlap = slider(
            *(controls, "Longest overlap, ms", "overlap_s", (0.0, 300.0)),
            factor=1000.0,
            step=5.0,
            format="0",
            css_classes=[KEYED],
        )
        self.shape = slider(
            controls, "Crossover early – late", "shape", (-1.0, 1.0), step=0.02, format="0.00"
        )
        self.inertial = slider(
            *(controls, "Inertial duration, ms", "inertial_s", (10.0, 300.0)),
            factor=1000.0,
            step=5.0,
            format="0",
            css_classes=[KEYED],
        )
        self.board = Board(
            face=self.face.view,
            inset=self.inset.view,
            mode=self.mode,
            presets=self.presets,
            preset_names=PRESETS,
            plot=self.plot,
            sliders=pn.Row(self.overlap, self.shape, self.inertial, sizing_mode="stretch_width", margin=0),
            lane=self.lane,
            curves=self.trajectories.__panel__(),
            on_action=self._act,
        )
        watch = session.param.watch
        watch(self._theme, "theme")
        watch(self._moving, "moving")
        watch(self._result, ["result", "other"])
        watch(self._recorded, ["recorded", "cast"])
        watch(self._cast, ["cast", "beside"])
        watch(self._select, "selected")
        watch(self._mode, "mode")
        watch(self._curve_later, ["weighting", "shape", "curve_weights", "kept", "side"])
        watch(self._effect, ["result", "other", "effects", "selected"])
        watch(self._state, ["message", "working", "side", "edits"])
        watch(self._opening, ["status", "fraction", "doing", "corpus", "target_kind", "text"])
        self.lane.param.watch(self._picked, "selected")
        if session.moving is None:
            self.face.show_rest(session.mesh)
        else:
            self.face.show(session.moving)
        self._mode()
        self._curve()
        self._result()
        self._opening()

    def _mode(self, *events: Any) -> None:
        """Offer what the joins of this mode have."""
        inertial = self._session.mode == "inertial"
        self.board.unused = self.plot.unused = _UNUSED if inertial else ""
        self.presets.disabled = inertial
        self.inertial.visible = inertial
        self.overlap.visible = self.shape.visible = not inertial

    def _look(self, event: Any) -> None:
        """Look at the recording as at the blend."""
        self.inset.mesh_view.camera = dict(event.new)

    def reset_camera(self) -> None:
        """Look at the head as at first."""
        self.face.mesh_view.reset_camera()

    def _recorded(self, *events: Any) -> None:
        recorded, alone = self._session.recorded, not self._session.cast
        if recorded is not None and alone:
            if self.inset.result is not recorded:
                self.inset.show(recorded)
            self.inset.mesh_view.camera = dict(self.face.mesh_view.camera)
        self.board.inset_shown = recorded is not None and alone

    def _cast(self, *events: Any) -> None:
        session = self._session
        self.face.show_cast(session.cast)
        if session.result is not None:
            self.board.head_text = head_text(session.result, session.cast)
        self._overlays()

    def _several(self) -> None:
        """Let other heads speak beside the first, or let it be alone again."""
        session = self._session
        session.beside = [] if session.beside else beside_of(session.mesh)

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
        if action in ("A", "B"):
            if self._session.side != action:
                self._session.swap_sides()
        elif action == "cancel":
            self._on_cancel()
        elif action in ("lane", "curves"):
            if self.board.shown != action:
                self.switch_view()
        elif action == "several":
            self._several()
        elif action in OVERLAYS:
            name = f"show_{action}"
            setattr(self.face, name, not getattr(self.face, name))
            self._overlays()

    def _overlays(self) -> None:
        """Say what can be shown over this head: only patches have a surface to hang on."""
        can = {what: what == "markers" or self.face.has_surface for what in OVERLAYS}
        several = {"id": "several", "label": "Several heads", "on": bool(self._session.beside), "can": True}
        self.board.overlays = [
            *(
                {
                    "id": what,
                    "label": what.capitalize(),
                    "on": bool(getattr(self.face, f"show_{what}")) and can[what],
                    "can": can[what],
                }
                for what in OVERLAYS
            ),
            several,
        ]

    def switch_view(self) -> None:
        """Show the trajectories instead of the lane, or the lane again."""
        curves = self.board.shown == "lane"
        self.board.shown = "curves" if curves else "lane"
        self.trajectories.shown = curves

    def _points(self, points: Points) -> None:
        """Lay the person's own curve through the handles, and the handles on the curve.

        A smooth curve that falls cannot go through all handles anywhere: it comes as near as it can.
        """
        weights = curve_through(points)
        self._handles = (weights, on_curve(points, weighting_samples("user", 0.0, weights)))
        self._session.param.update(curve_weights=weights, weighting="user", shape=0.0)
        self._curve()

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

    def _curve_later(self, *events: Any) -> None:
        """Draw the curve in the same picture as the head that moves by it: every picture takes its time."""
        if not self._session.working:
            self._curve()

    def _effect(self, *events: Any) -> None:
        session, result = self._session, self._session.result
        if result is None:
            return
        band = band_data(session.effects)
        if self.lane.band != band:
            self.lane.band = band
        join = max(0, session.selected - 1)
        data = effect_data(session.effects, result, session.other, join, session.side)
        title, hint = PEAK, ""
        if join < len(result.ratios):
            title = f"Join {join + 1}: {PEAK[0].lower()}{PEAK[1:]}"
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
            working=session.working,
            side=session.side,
            compared=bool(session.difference),
        )

    def _moving(self, event: Any) -> None:
        if event.new is None and event.old is not None:
            self.face.show_rest(self._session.mesh)
        elif event.new is not None and self.face.result is not event.new:
            self.board.moves += 1
            self.face.show(event.new)
            self._curve()
            self._overlays()

    def _result(self, *events: Any) -> None:
        result = self._session.result
        if result is None:
            self.lane.clear()
            self.plot.param.update(effect=NO_EFFECT, title="", hint="")
            self.board.param.update(head_text="", lane_text="", held_out_text="", warning="")
            return
        self.overlap.label = overlap_label(result)
        self.lane.show(result, self._session.other, self._session.side)
        self.lane.selected = self._session.selected
        self.board.param.update(
            head_text=head_text(result, self._session.cast),
            lane_text=lane_text(result),
            held_out_text=held_out_text(result),
            warning=missing_text(result),
        )
        self._state()

    def __panel__(self) -> Any:
        return self.board
