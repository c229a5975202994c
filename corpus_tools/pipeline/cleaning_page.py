"""The cleaning report as one page without scripts: pictures are SVG in it; equal reports, equal bytes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from html import escape
from math import ceil
from typing import Any

from corpus_tools.core import counted

__all__ = ["cleaning_page", "found_in"]

MOST_PICTURES = 12
"""Recordings that are drawn, the worst ones (our choice: a page is read; all numbers are in the table)."""

_WIDTH, _HEIGHT, _LEFT, _STRIP = 490.0, 90.0, 56.0, 10.0
_FONT = 'font-family="system-ui,sans-serif" font-size="11" fill="#1c2127"'
_STYLE = """
body{font:15px/1.5 system-ui,sans-serif;color:#1c2127;background:#fff}
body{margin:2rem auto;max-width:1180px;padding:0 1rem}
h1{font-size:1.5rem}h2{font-size:1.15rem;margin-top:2rem}p,li{max-width:50rem}
table{border-collapse:collapse;font-size:13px;font-variant-numeric:tabular-nums}.wide{overflow-x:auto}
th,td{padding:.25rem .6rem;text-align:right;border-bottom:1px solid #dde2e7;white-space:nowrap}
th:first-child,td:first-child,td:last-child,th:last-child{text-align:left}td:last-child{white-space:normal}
figure{display:inline-block;margin:.4rem 1rem .8rem 0;vertical-align:top}figcaption{font-size:13px}
small{color:#5a6570}
@media(prefers-color-scheme:dark){body{background:#15191d;color:#e4e8ec}th,td{border-color:#343c44}
small{color:#9aa5b0}svg{background:#fff}}
"""


def _path(values: Sequence[float | None], top: float) -> str:
    """Return a polyline of values over frames, broken where there is none."""
    scale_x, scale_y = _WIDTH / max(len(values) - 1, 1), _HEIGHT / top
    runs: list[list[str]] = [[]]
    for index, value in enumerate(values):
        if value is None:
            runs.append([])
        else:
            x, y = _LEFT + index * scale_x, 8.0 + _HEIGHT - min(value, top) * scale_y
            runs[-1].append(f"{x:.1f},{y:.1f}")
    lines = (f'<polyline points="{" ".join(run)}"/>' for run in runs if len(run) > 1)
    return f'<g fill="none" stroke="#1f6feb" stroke-width="1.2">{"".join(lines)}</g>'


def _flag_strip(shares: Sequence[float]) -> str:
    """Return a strip under the curve: darker where more markers of a frame are flagged."""
    step, parts = _WIDTH / max(len(shares), 1), []
    for index, share in enumerate(shares):
        if share:
            opacity = 0.35 + 0.65 * share
            place = f'x="{_LEFT + index * step:.1f}" y="{_HEIGHT + 12:.1f}" width="{max(step, 1.0):.2f}"'
            parts.append(f'<rect {place} height="{_STRIP}" fill="#b35900" fill-opacity="{opacity:.2f}"/>')
    return "".join(parts)


def _slip_lines(row: dict[str, Any]) -> str:
    parts = []
    for slip in row["slips"]:
        x = _LEFT + _WIDTH * slip["frame"] / max(row["n_frames"] - 1, 1)
        line = f'<line x1="{x:.1f}" x2="{x:.1f}" y1="8" y2="{_HEIGHT + 8:.0f}" stroke="#b3261e"/>'
        anchor = "end" if x > _LEFT + 0.7 * _WIDTH else "start"
        text = f"{escape(slip['marker'])} slips {slip['size_mm']:.1f} mm"
        shift = -4 if anchor == "end" else 4
        parts.append(f'{line}<text x="{x + shift:.1f}" y="20" text-anchor="{anchor}" {_FONT}>{text}</text>')
    return "".join(parts)


def _top(rows: Sequence[dict[str, Any]]) -> float:
    """Return the end of the axis that all pictures share, mm: their curves are to be compared."""
    largest = [row["head"]["residual_largest_mm"] for row in rows]
    return max(0.1, float(ceil(11.0 * max(largest, default=0.0))) / 10.0)


def _picture(row: dict[str, Any], top: float) -> str:
    seconds = row["n_frames"] / row["rate_hz"]
    title = f"{row['id']}: residual of the head fit by time"
    labels = (
        f'<text x="{_LEFT - 6}" y="16" text-anchor="end" {_FONT}>{top:.1f} mm</text>'
        f'<text x="{_LEFT - 6}" y="{_HEIGHT + 8:.0f}" text-anchor="end" {_FONT}>0</text>'
        f'<text x="{_LEFT}" y="{_HEIGHT + 38:.0f}" {_FONT}>0 s</text>'
        f'<text x="{_LEFT + _WIDTH}" y="{_HEIGHT + 38:.0f}" text-anchor="end" {_FONT}>{seconds:.2f} s</text>'
    )
    frame = (
        f'<rect x="{_LEFT}" y="8" width="{_WIDTH}" height="{_HEIGHT}" fill="none" stroke="#dde2e7"/>'
        f"{_path(row['head']['residual_mm'], top)}{_flag_strip(row['flagged_by_frame'])}{_slip_lines(row)}"
    )
    size = f'width="{_LEFT + _WIDTH + 8:.0f}" height="{_HEIGHT + 44:.0f}"'
    caption = f"{escape(row['id'])}: {escape(_remarks(row)) or 'nothing to remark'}"
    return (
        f'<figure><svg xmlns="http://www.w3.org/2000/svg" {size} role="img" '
        f'aria-label="{escape(title)}"><title>{escape(title)}</title>{frame}{labels}</svg>'
        f"<figcaption>{caption}</figcaption></figure>"
    )


def _remarks(row: dict[str, Any]) -> str:
    parts = [f"{s['marker']} slips {s['size_mm']:.1f} mm at {s['time_s']:.2f} s" for s in row["slips"]]
    parts += [f"{' and '.join(s['markers'])} exchanged {s['first']}-{s['last']}" for s in row["swaps"]]
    if row["fillers"]:
        parts.append(f"gaps filled by {row['fillers']}")
    return "; ".join(parts)


_COLUMNS: dict[str, Callable[[dict[str, Any]], object]] = {
    "recording": lambda r: escape(r["id"]),
    "gaps": lambda r: r["gaps"],
    "longest, s": lambda r: f"{r['longest_gap_s']:.2f}",
    "filled": lambda r: r["filled_samples"],
    "doubtful": lambda r: r["doubtful_samples"],
    "largest band, mm": lambda r: f"{r['filled_sd_largest_mm']:.2f}",
    "spikes": lambda r: r["spikes"],
    "swaps": lambda r: len(r["swaps"]),
    "slips": lambda r: len(r["slips"]),
    "noise, mm": lambda r: f"{r['noise_mm']:.3f}",
    "head residual, mm": lambda r: f"{r['head']['residual_median_mm']:.2f}",
    "largest, mm": lambda r: f"{r['head']['residual_largest_mm']:.2f}",
    "remarks": lambda r: escape(_remarks(r)),
}


def _table(rows: Sequence[dict[str, Any]]) -> str:
    head = "".join(f'<th scope="col">{escape(name)}</th>' for name in _COLUMNS)
    body = "".join(
        "<tr>" + "".join(f"<td>{cell(row)}</td>" for cell in _COLUMNS.values()) + "</tr>" for row in rows
    )
    return f'<div class="wide"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'


def _timing(report: dict[str, Any]) -> str:
    offset = report["audio_offset_s"]
    if offset is None:
        return "Too few bilabials tell whether sound and motion lie together."
    advice = "".join(
        f" To apply it, set <code>{escape(line)}</code> in corpus.toml." for line in report["advice"]
    )
    return (
        f"The lips close best in p, b and m when the motion is moved by {1000 * offset + 0.0:.0f} ms against "
        f"the sound. This is an estimate and was not applied.{advice}"
    )


def found_in(s: dict[str, Any]) -> str:
    """Return what the summary of a report counts, for people."""
    return (
        f"{counted(s['gaps'], 'gap')}, {counted(s['filled_samples'], 'sample')} filled, "
        f"{s['doubtful_samples']} doubtful; {counted(s['spikes'], 'spike')}, "
        f"{counted(s['swaps'], 'exchanged pair')}, {counted(s['slips'], 'slip')}"
    )


def _lead(s: dict[str, Any]) -> str:
    return (
        f"{counted(s['recordings'], 'recording')}, {counted(s['frames'], 'frame')}: {found_in(s)}. "
        f"Residual of the head fit {s['head_residual_median_mm']:.2f} mm (median)."
    )


def cleaning_page(report: dict[str, Any]) -> str:
    """Return the HTML of a report of :func:`~corpus_tools.pipeline.cleaning_report.cleaning_report`."""
    name, rows, skipped = escape(report["corpus"]), report["recordings"], report["skipped"]
    worst = rows[:MOST_PICTURES]
    pictures = "".join(_picture(row, _top(worst)) for row in worst)
    left_out = "".join(f"<li>{escape(k)}: {escape(v)}</li>" for k, v in skipped.items())
    parts = (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Cleaning of {name}</title>',
        f"<style>{_STYLE}</style></head><body><h1>Cleaning of {name}</h1><p>{_lead(report['summary'])}</p>",
        f"<p>{_timing(report)}</p><h2>Worst first</h2>",
        "<p><small>Curve: distance of the head markers from the shape of the head after the fit. ",
        "Strip: frames with samples that were filled, are doubtful or were outliers.</small></p>",
        f"{pictures}<h2>All recordings</h2>{_table(rows)}",
        f"<h2>Left out</h2><ul>{left_out}</ul>" if left_out else "",
        "</body></html>\n",
    )
    return "".join(parts)
