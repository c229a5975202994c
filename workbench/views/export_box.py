"""Export of the config: where to, where it was written, and the line that replays it."""

from __future__ import annotations

import html
from collections.abc import Callable
from typing import Any

import panel as pn

from workbench.views.action_html import ActionHtml
from workbench.views.controls import Controls, button, text_field
from workbench.views.notice import notice_html

__all__ = ["ExportBox", "export_html"]


def export_html(kind: str, text: str, where: str = "") -> str:
    """Return what is shown after an export: where it was written and the line, or the sentence of an error.

    Parameters
    ----------
    kind : "ok", "there", "err", "opened", "unread" or ""
    text : str
        The line that replays it; or why it was not written ("there": another config is in its place).
    where : str
        The file that was written.
    """
    if not kind:
        return ""
    close = (
        '<button type="button" class="close" data-action="close" title="Put this away" '
        'aria-label="Put this away">✕</button>'
    )
    if kind == "opened":
        place = html.escape(where)
        return (
            f'<div class="export">{close}<p class="ok" role="status" title="{place}">'
            f"✓ Config opened: {place}; Undo takes it back</p></div>"
        )
    if kind != "ok":
        did = "opened" if kind == "unread" else "written"
        said = notice_html("warn" if kind == "there" else "err", f"The config was not {did}", why=text)
        return f'<div class="export">{close}{said}</div>'
    line, place = html.escape(text), html.escape(where)
    rows = min(14, 2 + len(text) // 30)
    return (
        f'<div class="export">{close}<p class="ok" role="status" title="{place}">'
        f"✓ Config written: {place}</p>"
        '<p>This line makes the same motion: <button type="button" data-copy="replay" '
        'title="Copy the line to the clipboard">Copy</button></p>'
        f'<textarea id="replay" readonly rows="{rows}" spellcheck="false" '
        f'aria-label="Command that replays it" title="{line}">{line}</textarea></div>'
    )


class ExportBox(pn.viewable.Viewer):
    """File field, export button, command line with a copy button.

    A config that is in the place of the file is replaced at the second press only.

    Parameters
    ----------
    controls : Controls
    on_export : callable
        ``on_export(path, replace, done)`` with ``done(kind, text, where)``.
    on_open : callable
        ``on_open(path, done)``.
    """

    def __init__(
        self,
        controls: Controls,
        on_export: Callable[[str, bool, Callable[[str, str, str], None]], None],
        on_open: Callable[[str, Callable[[str, str, str], None]], None],
        **params: Any,
    ) -> None:
        self._run, self._open, self.suggested, self._asked = on_export, on_open, "", ""
        self.kind = self.text = self.where = ""
        super().__init__(**params)
        self.path = text_field(controls, "Config file", margin=(10, 4, 4, 12))
        self.export = button(
            controls, "Export", primary=True, margin=(12, 4, 4, 0), description="Export config: E"
        )
        self.export.on_click(lambda _: self.submit())
        self.open = button(
            controls,
            "Open",
            margin=(12, 12, 4, 0),
            description="Open the config of this file",
        )
        self.open.on_click(lambda _: self.submit_open())
        self._said = ActionHtml(on_action=lambda action, value: self.show("", ""))

    def suggest(self, path: str) -> None:
        """Suggest a file, unless the person has typed another."""
        typed = (self.path.value or "") != self.suggested
        self.suggested = path
        if not typed:
            self.path.value = path

    def submit(self) -> None:
        """Export to the file of the field."""
        path = self.path.value_input or self.path.value or ""
        replace = self.kind == "there" and path == self._asked
        self.export.disabled, self._asked = True, path
        self._run(path, replace, self.show)

    def submit_open(self) -> None:
        """Open the config of the field."""
        path = self.path.value_input or self.path.value or ""
        self._open(
            path, lambda kind, text, where: self.show("unread" if kind == "err" else kind, text, where)
        )

    def show(self, kind: str, text: str, where: str = "") -> None:
        """Show the outcome of an export."""
        self.kind, self.text, self.where = kind, text, where
        self.export.disabled = False
        self._said.html = export_html(kind, text, where)

    def __panel__(self) -> Any:
        return pn.Column(
            pn.Row(self.path, self.export, self.open, sizing_mode="stretch_width", margin=0),
            self._said,
            sizing_mode="stretch_width",
            margin=0,
        )
