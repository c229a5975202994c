"""The history of settings and the comparison of two, as HTML that acts."""

from __future__ import annotations

import html
import math
import time

from workbench.state import Entry, Result, Session
from workbench.views.action_html import action_button

__all__ = ["compare_html", "history_html"]

SHOWN = 12


def _ratio(value: float) -> str:
    return f"{value:.2f}" if math.isfinite(value) else "–"


def _row(entry: Entry, here: bool, taken: bool) -> str:
    """Return a state as a row; one that did not lead to the present state is struck out and set in."""
    clock = time.strftime("%H:%M:%S", time.localtime(entry.when_s))
    high = ' class="num warn"' if entry.effect > 1.0 else ' class="num"'
    now = ' class="now" aria-selected="true"' if here else ""
    text = html.escape(entry.what)
    shown = f"<b>▸ {text}</b>" if here else text
    style = "white-space:normal;overflow-wrap:anywhere;line-height:1.35"
    if not taken:
        shown, style = f"<s>{text}</s>", f"{style};padding-left:14px;color:var(--vsw-ink3)"
    title = f"{clock} · {text}" if taken else f"{clock} · undone: {text}"
    return (
        f'<tr{now} role="option" tabindex="{0 if here else -1}" data-action="go" data-value="{entry.number}" '
        f'title="{title}"><td>{clock}</td><td style="{style}">{shown}</td>'
        f"<td{high}>{_ratio(entry.effect)}</td></tr>"
    )


def history_html(session: Session) -> str:
    """Return the latest states, the newest first; a click goes back to one.

    Those that led to the present state stand in one line; undone ones are struck out and set in.

    The number is the worst join: peak acceleration over the 95th percentile of natural stretches.
    """
    history = session.history
    if not history.entries:
        return ""
    line = history.line
    shown = [e for i, e in enumerate(history.entries[::-1]) if i < SHOWN or e.number == history.at]
    rows = [_row(e, e.number == history.at, e.number in line) for e in shown]
    return (
        f'<section><h3>History<span class="end">{len(history.entries)}</span></h3>'
        '<div class="rows history"><table>'
        '<colgroup><col style="width:64px"><col><col style="width:44px"></colgroup>'
        '<thead><tr><th>When</th><th>What</th><th class="num" '
        'title="Worst join: peak acceleration over the 95th percentile of natural stretches">Worst</th>'
        "</tr></thead>"
        f'<tbody data-list="history" role="listbox" aria-label="States of this session">{"".join(rows)}'
        "</tbody></table></div></section>"
    )


def _worst(result: Result | None) -> str:
    if result is None:
        return "…"
    return _ratio(max(result.ratios)) if result.ratios else "no joins"


def compare_html(session: Session) -> str:
    """Return what B has changed from A, and what that does to the worst join."""
    result, other = session.result, session.other
    difference = session.difference
    if result is None:
        return ""
    a, b = (other, result) if session.side == "B" else (result, other)
    if not difference:
        told = "<p>A and B are equal: change a setting.</p>"
    else:
        title = "Peak acceleration of the worst join over the 95th percentile of natural stretches"
        told = (
            f'<dl><dt title="{title}">Worst join</dt><dd title="{title}">A {_worst(a)} → '
            f'<span class="acc">B {_worst(b)}</span></dd>'
            f'<dt>Changed</dt><dd class="wrap">{html.escape(difference)}</dd></dl>'
        )
    buttons = action_button(
        "sides", f"Show {'A' if session.side == 'B' else 'B'}", "X", disabled=not difference
    )
    buttons += action_button(
        "keep", "Keep as A", disabled=not difference, title="Compare with this from now on"
    )
    shown = f'<span class="end">showing {session.side}</span>' if difference else ""
    return f'<section><h3>Compare{shown}</h3>{told}<div class="buttons">{buttons}</div></section>'
