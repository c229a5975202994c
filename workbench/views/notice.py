"""Messages at the place they belong to: which, where, why, and what can be done."""

from __future__ import annotations

import html
from collections.abc import Sequence

__all__ = ["NOTICE_KINDS", "notice_html"]

NOTICE_KINDS = {"err": "✕", "warn": "▲", "ok": "✓", "info": ""}
"""Kinds of notices and the sign that stands beside their colour."""


def notice_html(kind: str, what: str, where: str = "", why: str = "", do: Sequence[str] = ()) -> str:
    """Return a notice as HTML; every text is escaped.

    Parameters
    ----------
    kind : str
        One of :data:`NOTICE_KINDS`.
    what : str
        Headline: what happened.
    where, why : str
        File, tier, sentence; and the reason. One line each, left out when empty.
    do : sequence of str
        What the reader can do; command lines between back ticks are set as code.
    """
    sign = NOTICE_KINDS[kind]
    lines = [f"<h3>{sign} {html.escape(what)}</h3>"]
    lines += [f"<p>{html.escape(text)}</p>" for text in (where, why) if text]
    for text in do:
        pieces = html.escape(text).split("`")
        code = "".join(f"<code>{p}</code>" if i % 2 else p for i, p in enumerate(pieces))
        lines.append(f"<p>{code}</p>")
    role = "alert" if kind == "err" else "status"
    return f'<div class="notice {kind}" role="{role}">{"".join(lines)}</div>'
