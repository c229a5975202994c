"""What an evaluation writes: table.csv, table.json, sentences.csv, report.html, and run.json with timings."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from corpus_tools.core import atomic_folder
from corpus_tools.evaluate.bootstrap import Estimate
from corpus_tools.evaluate.metrics import METRICS
from corpus_tools.evaluate.numbers import NOTHING
from corpus_tools.evaluate.report import report_html
from corpus_tools.evaluate.runner import Evaluation
from corpus_tools.evaluate.table import Table, sentence_rows

__all__ = ["SENTENCE_COLUMNS", "TABLE_COLUMNS", "table_json", "write_evaluation"]

TABLE_COLUMNS = ("method", "metric", "value", "low", "high", "n")
SENTENCE_COLUMNS = ("sentence", "fold", "method", "metric", "value")


def _number(value: float) -> str:
    return f"{value:.6g}" if abs(value) > NOTHING else "0"


def _plain(value: float) -> float | None:
    return float(_number(value)) if math.isfinite(value) else None


def _estimate(found: Estimate) -> dict[str, Any]:
    return {
        "value": _plain(found.value),
        "low": _plain(found.low),
        "high": _plain(found.high),
        "n": found.n,
    }


def table_json(evaluation: Evaluation, table: Table, about: Mapping[str, Any]) -> dict[str, Any]:
    """Return the whole result as plain data: settings, metrics, values, ratios, tuned weights, failures."""
    return {
        **about,
        "sentences": table.n_sentences,
        "metrics": {
            m.name: {"unit": m.unit, "better": m.better, "mask": m.mask, "formula": m.summary}
            for m in METRICS.values()
        },
        "values": [
            {"method": method, "metric": metric, **_estimate(found)}
            for (method, metric), found in table.values.items()
        ],
        "ratios": [
            {"method": a, "against": b, "metric": metric, **_estimate(found)}
            for (a, b, metric), found in table.ratios.items()
        ],
        "tuned": {method: list(found) for method, found in evaluation.tuned.items()},
        "failures": [
            {"method": method, "sentence": sentence, "reason": reason}
            for method, sentence, reason in evaluation.failures
        ],
    }


def _rows(path: Path, header: tuple[str, ...], rows: Any) -> None:
    with path.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(header)
        for row in rows:
            writer.writerow([_number(v) if isinstance(v, float) else v for v in row])


def _json(path: Path, data: Mapping[str, Any]) -> None:
    path.write_text(json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8")


def write_evaluation(
    out: Path,
    evaluation: Evaluation,
    table: Table,
    about: Mapping[str, Any],
    run: Mapping[str, Any],
) -> None:
    """Write the folder of an evaluation, whole or not at all.

    Parameters
    ----------
    out : path
    evaluation : Evaluation
    table : Table
    about : mapping
        Corpus, folds, methods, seed, versions: what makes the result repeatable.
    run : mapping
        Date and host; with the timings the only content that differs between equal runs (run.json).
    """
    timings = {"fit_s": evaluation.fit_s, "predict_ms_per_sentence": evaluation.predict_ms}
    with atomic_folder(out) as folder:
        values = ((*key, e.value, e.low, e.high, e.n) for key, e in table.values.items())
        _rows(folder / "table.csv", TABLE_COLUMNS, values)
        _rows(folder / "sentences.csv", SENTENCE_COLUMNS, sentence_rows(evaluation))
        _json(folder / "table.json", table_json(evaluation, table, about))
        _json(folder / "run.json", {**run, **timings})
        (folder / "report.html").write_text(report_html(table, about, evaluation.failures), encoding="utf-8")
