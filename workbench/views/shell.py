"""The frame of every dashboard: rail, bar, transport, work area, inspector, status line in fixed places."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from typing import Any, ClassVar

import panel as pn
import param

from workbench.state import THEMES, key_table
from workbench.views.esm import esm
from workbench.views.theme import fonts, style_sheet

__all__ = ["Board", "Shell", "bindings"]


def bindings(*scopes: str) -> list[dict[str, Any]]:
    """Return the key table of some scopes as plain data, with the captions of the key caps."""
    rows = [b for b in key_table() if b.scope in scopes]
    return [{**asdict(b), "keys": list(b.keys), "caption": b.caption} for b in rows]


class Shell(pn.custom.JSComponent):
    """The frame (places and sizes of the token file).

    Parameters
    ----------
    bar, transport, work, start, inspector, inspector_foot : viewable
        What stands in the places, from the beginning: children that come later would be rendered anew with
        all others. `start` is shown instead of `work` and the inspector while `starting`. The inspector
        scrolls, its foot does not.
    on_key, on_rail, on_ready : callable, optional
        ``on_key(action id, which of its keys)``, ``on_rail(dashboard id)``, and ``on_ready()`` when the
        browser has the page.
    """

    bar = pn.custom.Child()
    transport = pn.custom.Child()
    work = pn.custom.Child()
    start = pn.custom.Child()
    inspector = pn.custom.Child()
    inspector_foot = pn.custom.Child()

    theme = param.Selector(default="light", objects=list(THEMES))
    fill = param.Boolean(default=True, doc="Fill the window; False inside a notebook cell.")
    starting = param.Boolean(default=False, doc="Show the start page instead of work area and inspector.")
    dashboards = param.List(default=[], doc="{id, label} of every dashboard that exists.")
    active = param.String(default="")
    bindings = param.List(default=[])
    status_keys = param.List(default=[], doc="Actions whose keys the status line shows.")
    status_text = param.String(default="")
    measured = param.String(default="", doc="HTML: the measured time of the last action.")
    jobs_text = param.String(default="")
    fonts = param.List(default=[])
    page_title = param.String(default="Visual speech workbench")
    session = param.String(default="default", doc="Id of the clock.")

    _esm = esm("shell", "renderShell")
    _stylesheets: ClassVar[list[Any]] = [style_sheet()]

    def __init__(
        self,
        on_key: Callable[[str, int], None] | None = None,
        on_rail: Callable[[str], None] | None = None,
        on_ready: Callable[[], None] | None = None,
        **params: Any,
    ) -> None:
        self._on_key, self._on_rail, self._on_ready = on_key, on_rail, on_ready
        defaults = {
            "sizing_mode": "stretch_both",
            "bindings": bindings("transport", "blend"),
            "fonts": fonts(),
        }
        super().__init__(**{**defaults, **params})

    def _handle_msg(self, data: Any) -> None:
        if data.get("type") == "key" and self._on_key is not None:
            self._on_key(str(data["id"]), int(data["index"]))
        if data.get("type") == "rail" and self._on_rail is not None:
            self._on_rail(str(data["id"]))
        if data.get("type") == "ready" and self._on_ready is not None:
            self._on_ready()


class Board(pn.custom.JSComponent):
    """The work area of the blend page: face, g(u) and lane as cards.

    `stale` greys what is shown while something newer is computed; `message` and `warning` stand in the lane.

    Parameters
    ----------
    on_action : callable, optional
        ``on_action(id)`` of a button in a card.

    Attributes
    ----------
    on_tab : callable
        ``on_tab(id, earlier)`` once the browser has said which tab this is: its id outlives a reload;
        `earlier` is that of the tab it was copied from, if it was.
    """

    face = pn.custom.Child()
    inset = pn.custom.Child()
    mode = pn.custom.Child()
    presets = pn.custom.Child()
    plot = pn.custom.Child()
    sliders = pn.custom.Child()
    lane = pn.custom.Child()
    curves = pn.custom.Child()

    preset_names = param.Dict(default={}, doc="Label of a g(u) -> its name in the config.")
    shown = param.Selector(default="lane", objects=["lane", "curves"], doc="What the lower card shows.")
    overlays = param.List(default=[], doc="{id, label, on, can} of what can be shown over the head.")
    inset_shown = param.Boolean(default=False, doc="Whether there is a recording to compare with.")
    head_text = param.String(default="")
    lane_text = param.String(default="")
    held_out_text = param.String(default="")
    message = param.String(default="")
    warning = param.String(default="", doc="What stood in where the corpus has nothing.")
    hint = param.String(default="", doc="What to do where there is nothing to show yet.")
    title = param.String(default="", doc="Headline over the progress.")
    fraction = param.Number(default=0.0, doc="Progress of a corpus that is being made or opened, 0-1.")
    doing = param.String(default="", doc="What is being done; empty when nothing is.")
    left_text = param.String(default="", doc="How long it will take.")
    stale = param.Boolean(default=False)
    working = param.Boolean(default=False, doc="Something is computed; it is said when it takes a second.")
    moves = param.Integer(
        default=0, doc="Grows with every motion of the head: what is computed goes on well."
    )
    side = param.Selector(default="B", objects=["A", "B"], doc="Which of two settings is shown.")
    unused = param.String(default="", doc="Why g(u) does nothing now; empty when it does something.")
    compared = param.Boolean(default=False, doc="Whether the two settings differ.")

    _esm = esm("board", "renderBoard")
    _stylesheets: ClassVar[list[Any]] = [style_sheet()]

    def __init__(self, on_action: Callable[[str], None] | None = None, **params: Any) -> None:
        self._on_action = on_action
        self.on_tab: Callable[[str, str], None] = lambda tab, earlier: None
        super().__init__(**{"sizing_mode": "stretch_both", **params})

    def _handle_msg(self, data: Any) -> None:
        if data.get("type") == "tab":
            self.on_tab(str(data.get("id", "")), str(data.get("earlier", "")))
        if data.get("type") == "action" and self._on_action is not None:
            self._on_action(str(data["id"]))
