"""The inspector of the blend page: the selected fragment, its alternatives, A and B, the history."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn

from corpus_tools.core import UnitRef
from workbench.actions import ban_unit, is_tried, options_shown, swap_to, swap_unit, toggle_pin, unban
from workbench.state import Session, fragment_details, pin_at
from workbench.views.action_html import ActionHtml
from workbench.views.history_list import compare_html, history_html
from workbench.views.inspector import bans_html, details_html, options_html

__all__ = ["FragmentInspector"]


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
        watched = ["result", "other", "selected", "options", "theme", "edits", "side", "kept", "working"]
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

    def _begins_s(self, unit: UnitRef) -> float:
        """Return when a unit begins in its own recording."""
        corpus = self._session.corpus
        assert corpus is not None
        return corpus.utterance(unit.recording).phones.intervals[unit.first].centre_s

    def _awaited(self) -> bool:
        """Whether a result of other settings than those of the shown one is on its way, or about to be."""
        s, wanted = self._session, self._session.request()
        return s.working or (
            s.result is not None and wanted is not None and s.result.request.config != wanted.config
        )

    def _update(self, *events: Any) -> None:
        """Write it anew; what is written down of a setting waits for the result of that setting."""
        s, details = self._session, None
        if events and all(e.name in ("edits", "working") for e in events) and self._awaited():
            return
        if s.result is not None and s.selected < len(s.result.selection.chosen):
            details = fragment_details(s.result, s.selected)
        rate = s.result.trajectory.rate_hz if s.result is not None else 120.0
        parts = [details_html(details, s.theme, rate)]
        options = options_shown(s)
        if options is not None and s.result is not None:
            chosen = s.result.selection.chosen[s.selected]
            pinned = bool(pin_at(s.pins, chosen.first, chosen.last))
            parts.append(options_html(options, s.text_of, pinned, is_tried(s), self._begins_s))
        parts += [bans_html(s.bans), compare_html(s), history_html(s)]
        self.pane.html = "".join(parts)

    def __panel__(self) -> Any:
        return self.pane
