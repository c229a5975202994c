"""The cleaning report: what was put into the capture is told, drawn in one file, and nothing is applied."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from corpus_tools.core import FrameFlag
from corpus_tools.demo import read_truth
from corpus_tools.pipeline import (
    clean_corpus,
    cleaning_lines,
    cleaning_report,
    read_corpus,
    write_cleaning,
)


@pytest.fixture(scope="module")
def cleaned(simulated_corpus):
    raw = read_corpus(simulated_corpus)
    return raw, clean_corpus(raw)


@pytest.fixture(scope="module")
def report(cleaned):
    told = []
    made = cleaning_report(*cleaned, progress=lambda fraction, what: told.append(fraction))
    assert told == sorted(told)
    assert 0 <= told[0] <= told[-1] <= 1
    return made


def test_what_the_simulation_put_in_is_found(simulated_corpus, report):
    rows = {row["id"]: row for row in report["recordings"]}
    put, found = 0, 0
    for name, row in rows.items():
        truth = read_truth(simulated_corpus / "truth" / f"{name}.npz")
        put, found = put + int(truth.spiked.sum()), found + row["spikes"]
        assert bool(truth.swapped.any()) == bool(row["swaps"])
        slipped = [s["time_s"] for s in row["slips"] if s["marker"] == "head"]
        assert len(slipped) == int(np.isfinite(truth.slip_s))
        assert all(abs(s - truth.slip_s) < 0.1 for s in slipped)
        assert [s for s in row["slips"] if s["marker"] != "head"] == []
    assert 0.9 * put <= found <= put + 1


def test_the_sums_are_those_of_the_recordings(cleaned, report):
    raw, clean = cleaned
    rows = report["recordings"]
    for key in ("gaps", "filled_samples", "doubtful_samples", "spikes"):
        assert report["summary"][key] == sum(row[key] for row in rows)
    flags = np.concatenate([c.flags.ravel() for c in clean.captures])
    assert report["summary"]["filled_samples"] == ((flags & FrameFlag.FILLED) > 0).sum()
    assert report["summary"]["frames"] == sum(c.n_frames for c in raw.captures)
    assert all(len(row["head"]["residual_mm"]) == row["n_frames"] for row in rows)


def test_an_offset_is_shown_and_not_applied(cleaned, report):
    raw, clean = cleaned
    late = replace(clean, captures=tuple(replace(c, start_s=c.start_s - 0.04) for c in clean.captures))
    shifted = cleaning_report(raw, late)
    assert report["advice"] == []
    assert shifted["audio_offset_s"] == pytest.approx(report["audio_offset_s"] + 0.04, abs=0.005)
    (line,) = shifted["advice"]
    assert line.startswith("audio_offset_s = 0.0")
    assert shifted["audio_offset_applied_s"] == 0.0
    assert any("not applied" in text for text in cleaning_lines(shifted))


def test_one_of_a_kind_is_told_in_the_singular(report):
    ones = {key: 1 for key in ("recordings", "frames", "gaps", "filled_samples", "spikes", "swaps", "slips")}
    summary = {**report["summary"], **ones}
    (line, *_) = cleaning_lines({**report, "summary": summary})
    assert "1 recording; 1 gap, 1 sample filled," in line
    assert line.endswith("1 spike, 1 exchanged pair, 1 slip.")


def test_the_page_opens_anywhere_and_equal_reports_give_equal_bytes(report, tmp_path):
    odd = {**report, "corpus": "<b>odd & named</b>"}
    for folder in ("one", "two"):
        write_cleaning(tmp_path / folder, odd)
    page = (tmp_path / "one/report.html").read_text(encoding="utf-8")
    assert (tmp_path / "two/report.html").read_text(encoding="utf-8") == page
    assert json.loads((tmp_path / "one/cleaning.json").read_text(encoding="utf-8")) == odd
    assert not re.search(r"<script|<link|src=|url\(|http(?!://www.w3.org/2000/svg)", page)
    assert "<b>odd" not in page
    assert page.count("<svg") == min(12, len(report["recordings"]))
    assert page.count("<tr>") == 1 + len(report["recordings"])
    slips = [s for row in report["recordings"][:12] for s in row["slips"]]
    assert page.count('stroke="#b3261e"') == len(slips)
