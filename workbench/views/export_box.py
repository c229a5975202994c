"""Export of the config: where to, and the line that replays it."""

from __future__ import annotations

import html
from collections.abc import Callable
from typing import Any

import panel as pn

from workbench.views.controls import Controls, button, text_field
from workbench.views.notice import notice_html
from workbench.views.theme import style_sheet

__all__ = ["ExportBox", "export_html"]


_COPY = "navigator.clipboard?.writeText((line.data ?? line).value)"


def export_html(kind: str, text: str) -> str:
    """Return what is shown after an export: that it was written, or the sentence of an error."""
    if kind == "ok":
        return (
            '<div class="vsw-html" style="padding:0 12px"><p class="ok" role="status" '
            f'title="{html.escape(text)}">✓ Config written. This line makes the same motion:</p></div>'
        )
    notice = notice_html("err", "The config was not written", why=text)
    return f'<div class="vsw-html" style="padding:4px 12px">{notice}</div>'


class ExportBox(pn.viewable.Viewer):
    """File field, export button, command line with a copy button.

    Parameters
    ----------
    controls : Controls
    path : str
        Suggested file.
    on_export : callable
        ``on_export(path, done)`` with ``done(kind, text)``.
    """

    def __init__(
        self,
        controls: Controls,
        path: str,
        on_export: Callable[[str, Callable[[str, str], None]], None],
        **params: Any,
    ) -> None:
        self._run = on_export
        self.kind, self.text = "", ""
        super().__init__(**params)
        self.path = text_field(controls, "Config file", value=path, margin=(10, 4, 4, 12))
        self.export = button(
            controls, "Export", primary=True, margin=(12, 12, 4, 0), description="Export config: E"
        )
        self.line = text_field(controls, "Command that replays it", margin=(10, 4, 4, 12), visible=False)
        self.copy = button(controls, "Copy", margin=(12, 12, 4, 0), visible=False)
        self.copy.js_on_click(args={"line": self.line}, code=_COPY)
        self.export.on_click(lambda _: self.submit())
        self._said = pn.pane.HTML("", stylesheets=[style_sheet()], sizing_mode="stretch_width", margin=0)

    def submit(self) -> None:
        """Export to the file of the field."""
        self.export.disabled = True
        self._run(self.path.value_input or self.path.value or "", self.show)

    def show(self, kind: str, text: str) -> None:
        """Show the outcome of an export."""
        self.kind, self.text = kind, text
        self.export.disabled = False
        self._said.object = export_html(kind, text)
        for part in (self.line, self.copy):
            part.visible = kind == "ok"
        if kind == "ok":
            self.line.value = text

    def __panel__(self) -> Any:
        return pn.Column(
            pn.Row(self.path, self.export, sizing_mode="stretch_width", margin=0),
            self._said,
            pn.Row(self.line, self.copy, sizing_mode="stretch_width", margin=0),
            sizing_mode="stretch_width",
            margin=0,
        )
