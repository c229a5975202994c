"""HTML with buttons and rows that act, made of plain text in Python."""

from __future__ import annotations

import html as html_
from collections.abc import Callable
from typing import Any, ClassVar

import panel as pn
import param

from workbench.views.esm import esm
from workbench.views.theme import style_sheet

__all__ = ["ActionHtml", "action_button"]


def action_button(action: str, label: str, key: str = "", value: str = "", **flags: Any) -> str:
    """Return a button as HTML: what it says, the cap of its key, and what it does.

    Parameters
    ----------
    action, value : str
        Handed to `on_action`.
    label : str
    key : str
        As written on the key cap.
    **flags
        `pressed`, `disabled`, `primary`: bool; `title`: str.
    """
    cap = f" <kbd>{html_.escape(key)}</kbd>" if key else ""
    more = "".join(
        (
            f' aria-pressed="{str(bool(flags["pressed"])).lower()}"' if "pressed" in flags else "",
            " disabled" if flags.get("disabled") else "",
            f' title="{html_.escape(flags["title"])}"' if flags.get("title") else "",
            ' class="primary"' if flags.get("primary") else "",
        )
    )
    return (
        f'<button type="button" data-action="{html_.escape(action)}" data-value="{html_.escape(value)}"'
        f"{more}>{html_.escape(label)}{cap}</button>"
    )


class ActionHtml(pn.custom.JSComponent):
    """Text whose elements with ``data-action`` call ``on_action(action, value)``.

    Parameters
    ----------
    html : str
        Every text in it must be escaped already.
    on_action : callable, optional
    """

    html = param.String(default="")

    _esm = esm("html", "renderHtml")
    _stylesheets: ClassVar[list[Any]] = [style_sheet()]

    def __init__(self, on_action: Callable[[str, str], None] | None = None, **params: Any) -> None:
        self._on_action = on_action
        super().__init__(**{"sizing_mode": "stretch_width", "margin": 0, **params})

    def _handle_msg(self, data: Any) -> None:
        if self._on_action is not None:
            self._on_action(str(data.get("action", "")), str(data.get("value", "")))
