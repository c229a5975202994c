"""report.html: what came out, one page without scripts, pictures as SVG; equal results, equal bytes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from corpus_tools.evaluate.bootstrap import Estimate
from corpus_tools.evaluate.drawing import interval_plot, scatter_plot
from corpus_tools.evaluate.metrics import METRICS
from corpus_tools.evaluate.numbers import MISSING, interval_text, value_text
from corpus_tools.evaluate.runner import NATURAL, REPETITION
from corpus_tools.evaluate.table import Table

__all__ = ["report_html"]

_STYLE = """
body{font:15px/1.5 system-ui,sans-serif;color:#1c2127;background:#fff}
body{margin:2rem auto;max-width:1500px;padding:0 1.5rem}
h1{font-size:1.5rem;margin-bottom:.2rem}h2{font-size:1.15rem;margin-top:2.2rem}p{max-width:50rem}
table{border-collapse:collapse;font-size:13px;font-variant-numeric:tabular-nums}
th,td{padding:.25rem .6rem;text-align:right;border-bottom:1px solid #dde2e7;white-space:nowrap}
th:first-child,td:first-child{text-align:left}thead th{position:sticky;top:0;background:#fff}
small{color:#5a6570}.wide{overflow-x:auto}
figure{display:inline-block;margin:.4rem 1rem .4rem 0;vertical-align:top}
figcaption{font-size:13px;max-width:34rem}
dt{font-weight:600;margin-top:.5rem}dd{margin:0 0 0 1.2rem;font-size:13.5px}
@media(prefers-color-scheme:dark){body,thead th{background:#15191d;color:#e4e8ec}th,td{border-color:#343c44}
small{color:#9aa5b0}svg{background:#fff}}
"""

_ERROR = ("rmse", "rmse_centred", "rmse_face", "dtw", "r_aperture", "r_width", "r_protrusion", "r_jaw")
_REALISM = (
    "dynamic_range",
    "modulation_4_8hz",
    "modulation_8_12hz",
    "frechet",
    "bilabial_closure",
    "closure_depth",
    "vowel_false_closure",
    "acceleration_p95",
)
_JOINS = (
    "joins",
    "join_peak",
    "join_unnatural",
    "join_gap_position",
    "join_gap_velocity",
    "join_gap_acceleration",
)
_WORDS = ("word_rmse", "word_r_aperture")
_REST = tuple(m for m in METRICS if m not in (*_ERROR, *_REALISM, *_JOINS, *_WORDS))
_RATIOS = ("rmse", "dtw", "r_aperture", "dynamic_range", "frechet")

_READ = (
    "Read error and realism together. A mean of many instances lies nearer to a recording than the "
    "speaker's own repetition of the same words does (row <i>repetition</i>), and moves less than speech: "
    "a small error with a dynamic range below 1 and a large Fréchet distance is smoothness, not quality. "
    "The row <i>natural</i> is the recording itself, at the rate of the predictions. Intervals are 95 %, "
    "over sentences: percentiles of 1000 resamples within folds; for the Fréchet distance, which resampling "
    "makes larger, the jackknife (each sentence left out once, on a logarithmic scale). Ratios are resampled "
    "together, and bold where the interval leaves out 1. – stands where a metric says nothing, such as "
    "the correlation of a mean, which does not move."
)

_YARDSTICKS = (
    "<p><small>The row <i>natural</i> is the recordings, which have no joins, in the same windows around the "
    "same phones: where the methods have theirs. Peaks are divided by the 95th percentile of the "
    "<i>frames</i> of natural speech, and are unnatural above that of the peaks of its <i>stretches</i> of "
    "0.12 s (as in joins.csv and on the page).</small></p>"
)


def _cell(found: Estimate | None, clear: bool = False) -> str:
    """Return a value over its interval; `clear` values stand out: their interval does not hold 1."""
    if found is None:
        return f"<td>{MISSING}</td>"
    interval = interval_text(found)
    spread = f"<br><small>{interval}</small>" if interval else ""
    value = f"<b>{value_text(found)}</b>" if clear else value_text(found)
    return f"<td>{value}{spread}</td>"


def _ratio_cell(found: Estimate | None) -> str:
    return _cell(found, clear=found is not None and not found.low <= 1.0 <= found.high)


def _arrow(name: str) -> str:
    return {"low": " ↓", "high": " ↑", "one": " → 1", "": ""}[METRICS[name].better]


def _table(table: Table, metrics: Sequence[str], methods: Sequence[str]) -> str:
    shown = [m for m in metrics if any((method, m) in table.values for method in methods)]
    head = "".join(
        f'<th scope="col" title="{escape(METRICS[m].summary)}">{escape(m)}'
        f"{_arrow(m)}{f'<br><small>{METRICS[m].unit}</small>' if METRICS[m].unit else ''}</th>"
        for m in shown
    )
    rows = []
    for method in methods:
        if any((method, m) in table.values for m in shown):
            cells = "".join(_cell(table.values.get((method, m))) for m in shown)
            rows.append(f'<tr><th scope="row">{escape(method)}</th>{cells}</tr>')
    return (
        f'<div class="wide"><table><thead><tr><th scope="col">method</th>{head}</tr></thead>'
        f"<tbody>{''.join(rows)}</tbody></table></div>"
    )


def _ratios(table: Table, metric: str, methods: Sequence[str]) -> str:
    head = "".join(f'<th scope="col">{escape(b)}</th>' for b in methods)
    rows = "".join(
        f'<tr><th scope="row">{escape(a)}</th>'
        + "".join(_ratio_cell(table.ratios.get((a, b, metric))) for b in methods)
        + "</tr>"
        for a in methods
    )
    return (
        f"<h3>{escape(metric)}{_arrow(metric)}, row over column</h3>"
        f'<div class="wide"><table><thead><tr><th scope="col"></th>{head}</tr></thead>'
        f"<tbody>{rows}</tbody></table></div>"
    )


def _figure(table: Table, name: str, methods: Sequence[str]) -> str:
    """Return one metric of all methods, natural speech as a line where it is not simply perfect."""
    metric = METRICS[name]
    rows = [(m, table.values[m, name]) for m in methods if (m, name) in table.values]
    if not rows:
        return ""
    natural = table.values[NATURAL, name].value if name in _REALISM else None
    unit = f" ({metric.unit})" if metric.unit else ""
    line = " Dashed: natural speech." if natural is not None else ""
    return (
        f"<figure>{interval_plot(rows, f'{name}{unit}{_arrow(name)}', natural)}"
        f"<figcaption>{escape(metric.summary)}{line}</figcaption></figure>"
    )


def _figures(table: Table, methods: Sequence[str]) -> str:
    plots = [_figure(table, name, methods) for name in ("rmse", "r_aperture", "dynamic_range", "frechet")]
    values = table.values
    points = [
        (m, values[m, "rmse"].value, values[m, "frechet"].value)
        for m in methods
        if (m, "rmse") in values and (m, "frechet") in values
    ]
    if points:
        natural = values[NATURAL, "frechet"].value
        drawn = scatter_plot(points, "error: rmse (mm)", "distance from natural speech: frechet", natural)
        plots.append(
            f"<figure>{drawn}<figcaption>Accuracy against realism: both are good at the lower left. "
            "Dashed: natural speech.</figcaption></figure>"
        )
    return "".join(plots)


def _settings(about: Mapping[str, Any]) -> str:
    """Return the methods with all their settings."""
    rows = "".join(
        f"<dt>{escape(label)}</dt><dd>"
        f"{escape(', '.join(f'{k} = {_word(v)}' for k, v in settings.items()) or 'no settings')}</dd>"
        for label, settings in about.get("methods", {}).items()
    )
    return f"<dl>{rows}</dl>" if rows else ""


def _word(value: Any) -> str:
    return {True: "on", False: "off"}[value] if isinstance(value, bool) else str(value)


def _about(about: Mapping[str, Any], table: Table) -> str:
    parts = [f"{table.n_sentences} sentences"]
    parts += [
        f"{key.replace('_', ' ')}: {value}" for key, value in about.items() if isinstance(value, str | int)
    ]
    return escape(" · ".join(parts))


def report_html(table: Table, about: Mapping[str, Any], failures: Sequence[tuple[str, str, str]]) -> str:
    """Return the report as one HTML page that needs nothing else; it embeds no motion and no sound."""
    made = [m for m in table.methods if m not in (NATURAL, REPETITION)]
    sections = [
        ("Error", _table(table, _ERROR, table.methods)),
        ("Realism", _table(table, _REALISM, table.methods)),
        ("Joins", _YARDSTICKS + _table(table, _JOINS, [m for m in table.methods if m != REPETITION])),
        ("The same words said again", _table(table, _WORDS, table.methods)),
        ("Other metrics", _table(table, _REST, table.methods)),
        (
            "Methods against each other",
            "".join(_ratios(table, m, made) for m in _RATIOS) if len(made) > 1 else "",
        ),
    ]
    failed = "".join(
        f"<li>{escape(method)}, {escape(sentence)}: {escape(reason)}</li>"
        for method, sentence, reason in failures
    )
    if failed:
        sections.append(("Sentences that could not be spoken", f"<ul>{failed}</ul>"))
    terms = "".join(
        f"<dt>{escape(m.name)}</dt><dd>{escape(m.summary)} <small>{escape(m.mask)}</small></dd>"
        for m in METRICS.values()
    )
    sections.append(("Settings of the methods", _settings(about)))
    sections.append(("What the metrics are", f"<dl>{terms}</dl>"))
    body = "".join(f"<h2>{title}</h2>{content}" for title, content in sections if content)
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        f"<title>Evaluation on held-out sentences</title>"
        f'<meta name="viewport" content="width=device-width"><style>{_STYLE}</style></head><body>'
        f"<h1>Evaluation on held-out sentences</h1><p><small>{_about(about, table)}</small></p>"
        f"<p>{_READ}</p>{_figures(table, made)}{body}</body></html>\n"
    )
