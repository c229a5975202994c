"""The inspector's account of one fragment: where it comes from, why it was chosen, what was turned down."""

from __future__ import annotations

import html

from workbench.state import FragmentDetails, tokens

__all__ = ["details_html"]

_TERMS = {
    "timing": "timing",
    "context": "context",
    "backoff": "stand-in",
    "flagged": "doubtful",
    "position": "join posture",
    "velocity": "join velocity",
    "each": "each join",
}


def _escape(text: object) -> str:
    return html.escape(str(text))


def _verdict(percentile: float | None) -> str:
    if percentile is None:
        return ""
    if percentile > 95:
        return '<span class="end badge warn">▲ above p95</span>'
    return '<span class="end badge ok">✓ natural</span>'


def _join_html(details: FragmentDetails) -> str:
    join = details.join
    if join is None:
        return "<section><h3>Start of the sentence</h3><p>No join before this fragment.</p></section>"
    percentile = join["percentile"]
    peak = "unknown" if percentile is None else f"natural p{percentile:.0f}"
    return (
        f"<section><h3>Join {details.index} of {details.n_fragments - 1} at {_escape(join['phone'])}, "
        f"{join['time']:.2f} s{_verdict(percentile)}</h3><dl>"
        f"<dt>Out of</dt><dd>{_escape(join['before'])}</dd>"
        f"<dt>Peak accel.</dt><dd>{peak}</dd>"
        f"<dt>Overlap</dt><dd>{1000 * join['overlap']:.0f} ms</dd>"
        f"<dt>Gap before</dt><dd>{join['gap']:.2f} mm, {join['gap_mm_s']:.0f} mm/s</dd></dl></section>"
    )


def _source_html(details: FragmentDetails, colour: str) -> str:
    backoff = "".join(
        f'<dt class="warn">▲ stand-in</dt><dd class="warn">{_escape(a)} spoken as {_escape(b)}</dd>'
        for a, b in details.backoff
    )
    return (
        f"<section><h3>Fragment {details.index + 1} of {details.n_fragments}</h3><dl>"
        f'<dt>Source</dt><dd><i class="dot" style="background:{colour}"></i>'
        f"<b>{_escape(details.source)}</b></dd>"
        f'<dt>Sentence</dt><dd class="wrap">“{_escape(details.text)}”</dd>'
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
    )
    return (
        f'<section><h3>Why this fragment<span class="end">cost {details.total:.2f}</span></h3>'
        f'<div class="bars">{rows}</div></section>'
    )


def _rejected_html(details: FragmentDetails) -> str:
    if not details.rejected:
        return "<section><h3>Alternatives</h3><p>No other fragment covers these phones.</p></section>"
    target = sum(v for _, v in details.costs) - sum(v for _, v in details.join_costs)
    rows = [
        f'<tr class="now"><td>{_escape(details.source)}</td><td>{_escape(details.text)}</td>'
        f'<td class="num">{target:.2f}</td><td class="num">{details.total - target:.2f}</td></tr>'
    ]
    rows += [
        f'<tr title="{_escape(source)}: {_escape(text)}"><td>{_escape(source)}</td><td>{_escape(text)}</td>'
        f'<td class="num">{cost:.2f}</td><td class="num">{join:.2f}</td></tr>'
        for source, text, cost, join in details.rejected
    ]
    return (
        f'<section><h3>Alternatives turned down<span class="end">{len(details.rejected)}</span></h3><table>'
        '<colgroup><col style="width:62px"><col><col style="width:46px"><col style="width:46px"></colgroup>'
        '<tr><th>Source</th><th>Sentence</th><th class="num">Target</th><th class="num">Join</th></tr>'
        f"{''.join(rows)}</table></section>"
    )


def details_html(details: FragmentDetails | None, theme: str) -> str:
    """Return the inspector's account of a fragment as HTML; every text is escaped.

    Parameters
    ----------
    details : FragmentDetails or None
        None while there is no result yet.
    theme : str
        "light" or "dark": the source's colour is set in the text.
    """
    if details is None:
        return '<div class="vsw-html"><section><h3>No fragment selected</h3></section></div>'
    colours = list(tokens(theme).sources.values())
    colour = colours[details.slot % len(colours)]
    parts = (
        _source_html(details, colour),
        _join_html(details),
        _costs_html(details, colour),
        _rejected_html(details),
    )
    return f'<div class="vsw-html">{"".join(parts)}</div>'
