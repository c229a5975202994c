"""Captures without speech are cleaned and reported too: nothing is spoken by them, and they have gaps."""

import json

import numpy as np
import pytest

from corpus_tools.core import CorpusError
from corpus_tools.io import init_corpus
from corpus_tools.pipeline import clean_corpus, cleaning_lines, cleaning_report, open_corpus, read_corpus
from corpus_tools.pipeline.cleaning_report import write_cleaning

# corpus -> (pattern, settings, gaps that are there)
WITHOUT_SPEECH = {
    "animface_mocap": ("{id}.npz", {"reference_markers": "ForeHead*"}, False),
    "blenderface": (
        "{id}.csv",
        {"reference_markers": "*", "rate_hz": "25", "marker_units": "250 mm"},
        True,
    ),
    "pyomeca_c3d": ("{id}.c3d", {"reference_markers": "boite*"}, True),
}


@pytest.mark.parametrize("name", WITHOUT_SPEECH)
def test_a_capture_without_speech_is_cleaned_and_told(corpora, name, tmp_path):
    pattern, settings, has_gaps = WITHOUT_SPEECH[name]
    init_corpus(tmp_path / "c", motion=str(corpora / name / pattern), settings=settings)
    raw = read_corpus(tmp_path / "c", unlabelled=True)
    cleaned = clean_corpus(raw)
    for capture in cleaned.captures:
        assert np.isfinite(capture.positions_mm).all()
    report = cleaning_report(raw, cleaned)
    assert (report["summary"]["gaps"] > 0) == has_gaps
    assert (report["summary"]["doubtful_samples"] > 0) == has_gaps
    assert report["audio_offset_s"] is None
    assert all(line.strip() for line in cleaning_lines(report))
    write_cleaning(tmp_path / "o", report)
    assert json.loads((tmp_path / "o/cleaning.json").read_text())["summary"] == report["summary"]
    assert (tmp_path / "o/report.html").read_text().count("<svg") >= len(raw.names)
    with pytest.raises(CorpusError, match="no labels"):
        open_corpus(tmp_path / "c")
