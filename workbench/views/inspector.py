"""The inspector's account of one fragment: its join, why it was chosen, what else could speak the place."""

from __future__ import annotations

import html
from collections.abc import Callable

from corpus_tools.core import Costs, UnitRef, counted
from workbench.state import FragmentDetails, Option, Options, tokens
from workbench.views.action_html import action_button

__all__ = ["bans_html", "details_html", "options_html"]

_TERMS = {
    "timing": "timing",
    "context": "context",
    "place": "place",
    "stress": "stress",
    "backoff": "stand-in",
    "flagged": "doubtful",
    "position": "join posture",
    "velocity": "join velocity",
    "acceleration": "join acceleration",
    "aperture": "join lip aperture",
    "sound": "join sound",
    "each": "each join",
}
_DOUBTS = ("backoff", "flagged")
_COLUMNS = (
    ("At, s", "Where it begins in its own recording"),
    ("Timing", "Cost: how far its phones are from the durations wanted"),
    ("Context", "Cost: neighbours other than those it is to have"),
    ("Join", "Cost: posture and how it moves where it meets the fragment before"),
)


def _escape(text: object) -> str:
    return html.escape(str(text))


def _verdict(ratio: float | None) -> str:
    if ratio is None:
        return ""
    if ratio > 1.0:
        return (
            '<span class="end badge warn" title="Above the 95th percentile of natural stretches">'
            "▲ above p95</span>"
        )
    return '<span class="end badge ok">✓ natural</span>'


def _source(name: str, text: str, colour: str) -> str:
    return f'<i class="dot" style="background:{colour}"></i><b>{_escape(name)}</b> “{_escape(text)}”'


def _join_html(details: FragmentDetails, colours: list[str], frames_hz: float) -> str:
    join = details.join
    if join is None:
        return "<dt>Join</dt><dd>none: the sentence begins here</dd>"
    ratio = join["ratio"]
    peak = "unknown" if ratio is None else f"{ratio:.2f} × natural p95"
    frames = round(join["overlap"] * frames_hz)
    over, inertial = f"{join['overlap']:.3f} s, {counted(frames, 'frame')}", join["inertial"]
    if join.get("g"):
        over += f", g(u) {join['g']}"
    if inertial:
        over = f"in {inertial:.3f} s to either side"
        if join["overlap"] < 2 * inertial - 0.001:  # at an end of the sentence
            over += f", {join['overlap']:.3f} s in all"
    colour = colours[join["before_slot"] % len(colours)]
    return (
        f'<dt>Out</dt><dd title="{_escape(join["before"])}: {_escape(join["before_text"])}">'
        f"{_source(join['before'], join['before_text'], colour)}</dd>"
        '<dt>Peak accel.</dt><dd title="Over the 95th percentile of the peaks of natural stretches">'
        f"{peak}</dd>"
        f"<dt>{'Dies away' if inertial else 'Overlap'}</dt><dd>{over}</dd>"
        f"<dt>Gap before</dt><dd>{join['gap']:.2f} mm, {join['gap_mm_s']:.0f} mm/s</dd>"
    )


def _head_html(details: FragmentDetails, colours: list[str], frames_hz: float) -> str:
    join = details.join
    where = f" · {_escape(join['phone'])}, {join['time']:.2f} s" if join else ""
    backoff = "".join(
        f'<dt class="warn">▲ stand-in</dt><dd class="warn">{_escape(a)} spoken as {_escape(b)}</dd>'
        for a, b in details.backoff
    )
    colour = colours[details.slot % len(colours)]
    role, title = "In" if join else "Source", f"{_escape(details.source)}: {_escape(details.text)}"
    return (
        f"<section><h3>Fragment {details.index + 1} of {details.n_fragments}{where}"
        f"{_verdict(join['ratio'] if join else None)}</h3><dl>"
        f"{_join_html(details, colours, frames_hz)}"
        f'<dt>{role}</dt><dd title="{title}">{_source(details.source, details.text, colour)}</dd>'
        f'<dt>Phones</dt><dd class="wrap">{_escape(details.phones)}</dd>'
        f"<dt>Taken from</dt><dd>{details.first_s:.3f}–{details.last_s:.3f} s</dd>{backoff}</dl></section>"
    )


def _costs_html(details: FragmentDetails, colour: str) -> str:
    largest = max((abs(v) for _, v in details.costs), default=0.0) or 1.0
    rows = "".join(
        f'<span class="name">{_escape(_TERMS.get(name, name))}</span>'
        f'<span><i class="bar" style="display:block;width:{100 * abs(value) / largest:.1f}%;'
        f'background:{colour}"></i></span><span class="value">{value:.2f}</span>'
        for name, value in details.costs
        if value
    )
    free = ", ".join(_escape(_TERMS.get(name, name)) for name, value in details.costs if not value)
    title = "Sum of the terms, of that of the sentence, which the search keeps low"
    title += f". Nothing for {free}." if free else "."
    return (
        f'<section><h3>Why this fragment<span class="end" title="{title}">'
        f"cost {details.total:.2f} of {details.of_all:.2f}</span>"
        "</h3>"
        f'<div class="bars">{rows}</div></section>'
    )


def _cost(costs: Costs, term: str) -> str:
    value = dict(costs.target).get(term)
    return "–" if value is None else f"{value:.2f}"


def _option_row(index: int, option: Option, options: Options, text: str, at_s: float) -> str:
    """Return one unit as a row: where it was recorded, and the costs that tell it from the others."""
    name, costs = option.unit.recording, option.costs
    terms = ", ".join(f"{_TERMS.get(k, k)} {v:.2f}" for k, v in (*costs.target, *costs.join))
    n, most = option.last - option.first, max(o.last - o.first for o in options.options)
    target = dict(costs.target)
    mark = ""
    if n < most:
        short = f"It speaks only the first {counted(n + 1, 'phone')} of the place"
        mark += f' <span class="warn" title="{short}">{n + 1} ph.</span>'
    if any(target.get(term) for term in _DOUBTS):
        doubt = "Another phone stands in, or its frames were filled or doubtful"
        mark += f' <span class="warn" title="{doubt}">▲</span>'
    now = ' class="now" aria-selected="true"' if index == options.at else ""
    title = f"{name}, from {at_s:.3f} s: “{text}” · cost {costs.total:.2f}: {terms}"
    return (
        f'<tr{now} role="option" tabindex="{0 if index == options.at else -1}" data-action="swap" '
        f'data-value="{index}" title="{_escape(title)}"><td>{_escape(name)}{mark}</td>'
        f'<td class="num">{at_s:.2f}</td><td class="num">{_cost(costs, "timing")}</td>'
        f'<td class="num">{_cost(costs, "context")}</td><td class="num">{costs.join_total:.2f}</td></tr>'
    )


def _pin_button(pinned: bool, tried: bool) -> tuple[str, str]:
    if tried:
        return "Keep", "Keep the one that is tried here"
    return ("Unpin", "Let the search choose here") if pinned else ("Pin", "Keep it here")


def options_html(
    options: Options,
    text_of: Callable[[str], str],
    pinned: bool,
    tried: bool,
    at_s: Callable[[UnitRef], float],
) -> str:
    """Return the units that could speak the selected place, as a list to choose from.

    Sentences of one grammar look alike, so the list tells the units apart by recording, time and costs; the
    words stand in the tooltip.

    Parameters
    ----------
    options : Options
    text_of : callable
        Words of a recording.
    pinned : bool
        Whether the place is pinned.
    tried : bool
        Whether it is pinned by a swap that was not kept yet.
    at_s : callable
        When a unit begins in its own recording, s.
    """
    rows = [
        _option_row(i, o, options, text_of(o.unit.recording), at_s(o.unit))
        for i, o in enumerate(options.options)
    ]
    n = len(options.options)
    label, title = _pin_button(pinned, tried)
    buttons = (
        action_button("step", "Swap", "Alt ↓", "1", disabled=n < 2, title="Let the next one speak here")
        + action_button("pin", label, "K", pressed=pinned and not tried, title=title)
        + action_button("ban", "Ban", "B", title="Never use this unit")
        + action_button("hear", "Hear", "H", title="Play the fragment in its own recording")
    )
    heads = "".join(f'<th class="num" title="{title}">{label}</th>' for label, title in _COLUMNS)
    return (
        f'<section><h3>Alternatives<span class="end">{options.at + 1} of {n}</span></h3>'
        '<div class="rows options"><table><colgroup><col><col style="width:36px"><col style="width:44px">'
        '<col style="width:48px"><col style="width:36px"></colgroup>'
        f"<thead><tr><th>Source</th>{heads}</tr></thead>"
        '<tbody data-list="options" data-follow role="listbox" aria-label="What could speak this place">'
        f'{"".join(rows)}</tbody></table></div><div class="buttons">{buttons}</div></section>'
    )


def bans_html(bans: tuple[str, ...]) -> str:
    """Return the banned units, each with a button that allows it again; empty without any."""
    if not bans:
        return ""
    rows = "".join(
        f"<dt>{_escape(ban)}</dt><dd>{action_button('unban', 'Allow again', value=ban)}</dd>" for ban in bans
    )
    return (
        f'<section><h3>Banned<span class="end">{len(bans)}</span></h3><dl class="wide">{rows}</dl></section>'
    )


def details_html(details: FragmentDetails | None, theme: str, frames_hz: float = 120.0) -> str:
    """Return the inspector's account of a fragment as HTML; every text is escaped.

    Parameters
    ----------
    details : FragmentDetails or None
        None while there is no result yet.
    theme : str
        "light" or "dark": the source's colour is set in the text.
    frames_hz : float
        Frame rate of the motion.
    """
    if details is None:
        return "<section><h3>No fragment selected</h3><p>There is no result yet.</p></section>"
    colours = list(tokens(theme).sources.values())
    return _head_html(details, colours, frames_hz) + _costs_html(
        details, colours[details.slot % len(colours)]
    )
