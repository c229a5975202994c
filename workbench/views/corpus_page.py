"""What is in the open corpus, and what to do first: tallies, recordings worst first, diphones, advice."""

from __future__ import annotations

import html
from collections.abc import Callable
from typing import Any

import panel as pn

from corpus_tools.core import counted
from workbench.state import CorpusFacts, RecordingRow, Session, recording_rows
from workbench.views.action_html import ActionHtml
from workbench.views.diphone_map import FEW, diphone_map_svg
from workbench.views.theme import style_sheet

__all__ = ["CorpusOverview", "checking_html", "overview_html"]

LEAST = 5
"""Sentences named that the others cover least (our choice)."""


def _tally(number: object, what: str, more: str, warn: bool = False) -> str:
    kind = ' class="warn"' if warn else ""
    sign = "▲ " if warn else ""
    return f"<div><b{kind}>{sign}{number}</b> {html.escape(what)}<p>{html.escape(more)}</p></div>"


def _tallies(session: Session, facts: CorpusFacts | None) -> str:
    corpus = session.corpus
    assert corpus is not None
    n, rates = len(corpus.recordings), sorted({r.capture.rate_hz for r in corpus.recordings})
    minutes = sum(r.capture.duration_s for r in corpus.recordings) / 60
    rate = " and ".join(f"{r:g}" for r in rates[:3])
    phones = sorted({p for r in corpus.recordings for p in r.utterance.labels})
    skipped = len(corpus.skipped)
    shown = [
        _tally(n, "recording" if n == 1 else "recordings", f"{minutes:.1f} min, {rate} Hz"),
        _tally(skipped, "left out", "units are cut from all others", skipped > 0),
    ]
    if facts is None:
        shown.append(_tally("…", "gaps, problems, diphones", "being checked"))
    else:
        s, cover = facts.health["summary"], facts.cover
        unlabelled = s["recordings"] - s["labelled"]
        shown += [
            _tally(unlabelled, "unlabelled", f"of {counted(s['recordings'], 'recording')}", unlabelled > 0),
            _tally(s["with_gaps"], "with gaps", "filled, and flagged as filled", s["with_gaps"] > 0),
            _tally(
                cover["n_diphone_types"],
                "diphones",
                f"{counted(len(phones), 'phone')}; others cover {100 * cover['mean']:.1f} % of each",
            ),
        ]
    return f'<div class="tallies">{"".join(shown)}</div>'


def _row(row: RecordingRow) -> str:
    said = " ".join(row.problems or ())
    if row.problems is None:
        state = "…"
    elif not row.problems:
        state = '<span class="ok">✓</span>'
    else:
        state = f'<span class="{"warn" if row.usable else "err"}">{"▲" if row.usable else "✕"} '
        state += f"{html.escape(said)}</span>"
    act = f'data-action="speak" data-value="{html.escape(row.name)}" tabindex="-1"' if row.usable else ""
    cells = (
        "–" if row.duration_s is None else f"{row.duration_s:.2f}",
        "…" if row.gap_frames is None else str(row.gap_frames or "–"),
        "–" if row.covered is None else f"{100 * row.covered:.0f}",
    )
    numbers = "".join(f'<td class="num">{c}</td>' for c in cells)
    return (
        f'<tr {act} title="{html.escape(said or row.text)}"><td>{html.escape(row.name)}</td>'
        f"<td>{html.escape(row.text)}</td>{numbers}<td>{state}</td></tr>"
    )


def _order(rows: tuple[RecordingRow, ...], checked: bool) -> str:
    """Return in which order the rows stand: the worst can only come first when something is wrong."""
    if any(row.problems for row in rows):
        return "worst first" if checked else "those left out first"
    return "nothing to look at; by name" if checked else "by name"


def _recordings(rows: tuple[RecordingRow, ...], checked: bool) -> str:
    body = "".join(_row(row) for row in rows).replace('tabindex="-1"', 'tabindex="0"', 1)
    return (
        f'<section><h3>Recordings<span class="end">{_order(rows, checked)}; '
        "a click speaks one on the blend page</span></h3>"
        '<div class="rows recordings"><table><colgroup><col style="width:84px"><col style="width:38%">'
        '<col style="width:60px"><col style="width:76px"><col style="width:88px"><col></colgroup><thead><tr>'
        '<th>Recording</th><th>Sentence</th><th class="num">Length, s</th>'
        '<th class="num" title="Frames in which markers are missing">Gaps, frames</th>'
        '<th class="num" title="Share of its diphones that the other recordings hold">Covered, %</th>'
        f'<th>To look at</th></tr></thead><tbody data-list="recordings">{body}</tbody></table></div>'
        "</section>"
    )


def _diphones(facts: CorpusFacts) -> str:
    counts = facts.cover["diphones"]
    few = sum(n < FEW for n in counts.values())
    least = sorted((u for u in facts.cover["utterances"] if u["missing"]), key=lambda u: u["coverage"])
    rows = "".join(
        f"<dt>{html.escape(u['id'])}</dt><dd>{100 * u['coverage']:.0f} %, lacks "
        f"{html.escape(', '.join(u['missing']))}</dd>"
        for u in least[:LEAST]
    )
    more = f"<p>And {counted(len(least) - LEAST, 'more sentence')}.</p>" if len(least) > LEAST else ""
    lacking = f"<h3>Least covered by the others</h3><dl>{rows}</dl>{more}" if rows else ""
    return (
        f'<section class="map"><h3>Diphones<span class="end">{few} recorded fewer than {FEW} times, '
        f"outlined</span></h3>{diphone_map_svg(counts)}{lacking}</section>"
    )


def _advice(facts: CorpusFacts) -> str:
    lines = [*facts.health["told"]]
    lines += [f"Set {line} in corpus.toml." for line in facts.health.get("advice", [])]
    items = "".join(f'<li class="warn">▲ {html.escape(line)}</li>' for line in lines)
    posture = facts.health.get("posture_offsets")
    if posture:
        items += (
            f"<li>Recordings keep a posture of their own: {posture['rms_mm']:.2f} mm rms, most in "
            f"{html.escape(posture['largest'])} ({posture['largest_mm']:.2f} mm); it is taken out.</li>"
        )
    offset = facts.health.get("closure_offset_s")
    if offset is not None:
        items += (
            f"<li>Lips close best with the motion moved by {round(1000 * offset):+d} ms (0 is right).</li>"
        )
    return f'<ul class="advice">{items}</ul>' if items else ""


def _facts(session: Session) -> CorpusFacts | None:
    """Return the facts of the open corpus, None before they are known."""
    known = session.facts is not None and session.facts.corpus is session.corpus
    return session.facts if known else None


def checking_html(session: Session) -> str:
    """Return how far the check of the open corpus is, or why there is none; empty when it is done."""
    if session.corpus is None or _facts(session) is not None:
        return ""
    if session.check_trouble:
        said = f'<p class="err">✕ It could not be checked: {html.escape(session.check_trouble)}</p>'
    else:
        said = f'<p role="status">Checking: {html.escape(session.check_doing or "reading")}…</p>'
    return f'<div class="vsw-html">{said}</div>'


def overview_html(session: Session) -> str:
    """Return what is known of the open corpus as HTML; every text is escaped; empty without a corpus."""
    corpus, facts = session.corpus, _facts(session)
    if corpus is None:
        return ""
    title = f"<h1>{html.escape(corpus.description.name)}</h1>"
    right = _diphones(facts) if facts else ""
    body = f'<div class="halves">{_recordings(recording_rows(corpus, facts), facts is not None)}{right}</div>'
    advice = _advice(facts) if facts else ""
    return f'<div class="overview">{title}{_tallies(session, facts)}{advice}{body}</div>'


class CorpusOverview(pn.viewable.Viewer):
    """The overview of the open corpus, and above it how far its check is.

    Parameters
    ----------
    session : Session
    on_speak : callable
        ``on_speak(recording)`` of a row.
    """

    def __init__(self, session: Session, on_speak: Callable[[str], None], **params: Any) -> None:
        self._session = session
        super().__init__(**params)
        self.pane = ActionHtml(on_action=lambda action, value: on_speak(value))
        self.checking = pn.pane.HTML(
            stylesheets=[style_sheet()], sizing_mode="stretch_width", margin=(16, 24, 0, 24)
        )
        session.param.watch(self._update, ["corpus", "facts"])
        session.param.watch(self._check, ["corpus", "facts", "check_doing", "check_trouble"])
        self._update()
        self._check()

    def _update(self, *events: Any) -> None:
        self.pane.html = overview_html(self._session)
        self.pane.visible = self._session.corpus is not None

    def _check(self, *events: Any) -> None:
        """Say how far the check is, without writing the table anew."""
        self.checking.object = checking_html(self._session)
        self.checking.visible = bool(self.checking.object)

    def __panel__(self) -> Any:
        return pn.Column(self.checking, self.pane, sizing_mode="stretch_width", margin=0)
