"""Benchmarks by topic: each measures something, the bars are judged rightly, the command writes them."""

import json
import math

import pytest

from corpus_tools.cli.bench import BENCHMARKS, Ground, Row
from corpus_tools.cli.bench.command import table_lines
from tests.cli.answers import refused


@pytest.fixture(scope="module")
def ground(opened_corpus):
    return Ground(opened_corpus, repeats=1, scale=0.01)


DRAWN = {"film"}
"""Topics that draw off screen: where that is impossible they are skipped, but not where it must work."""


@pytest.mark.parametrize(
    "topic", [pytest.param(t, marks=pytest.mark.render) if t in DRAWN else t for t in BENCHMARKS]
)
def test_every_topic_measures(ground, topic, request):
    if topic in DRAWN:
        request.getfixturevalue("offscreen")
    rows = BENCHMARKS[topic](ground)
    assert rows
    for row in rows:
        assert row.what
        assert row.unit
        assert math.isfinite(row.measured)
        assert row.measured >= 0
        assert (row.peer_measured is None) == (not row.peer)
    json.dumps([row.as_dict() for row in rows], allow_nan=False)
    assert len(table_lines(rows)) == len(rows)


def test_target_lasts_as_long_as_the_bars_say(ground):
    assert ground.target.duration_s == pytest.approx(2.5, abs=1e-9)
    assert (
        ground.target.phones.intervals[:-1]
        == ground.longest.phones.intervals[: len(ground.target.phones) - 1]
    )


@pytest.mark.parametrize(
    ("row", "met", "ratio"),
    [
        (Row("x", 5.0), None, None),
        (Row("x", 5.0, bar=5.0), True, None),
        (Row("x", 5.1, bar=5.0), False, None),
        (Row("x", 5.1, bar=5.0, at_least=True), True, None),
        (Row("x", 4.9, bar=5.0, at_least=True), False, None),
        (Row("x", 5.0, peer="p", peer_measured=10.0), None, 2.0),
        (Row("x", 5.0, peer="p", peer_measured=10.0, least_ratio=2.0), True, 2.0),
        (Row("x", 5.0, bar=6.0, peer="p", peer_measured=10.0, least_ratio=2.1), False, 2.0),
        (Row("x", 20.0, at_least=True, peer="p", peer_measured=10.0, least_ratio=2.0), True, 2.0),
        (Row("x", 5.0, bar=6.0, least_ratio=2.0), False, None),
    ],
)
def test_bars_and_ratios(row, met, ratio):
    assert row.met is met
    assert row.ratio == (pytest.approx(ratio) if ratio else None)
    line = table_lines([row])[0]
    assert ("NOT MET" in line) == (met is False)
    assert row.as_dict()["met"] is met


def test_command_writes_what_it_prints(tool, simulated_corpus, tmp_path):
    out = tmp_path / "figures.json"
    answer = tool("bench", "--corpus", simulated_corpus, "--only", "resampling", "--out", out, "--json")
    code, printed, _ = answer
    said = printed.splitlines()
    assert code == 0
    report = json.loads(out.read_text())
    assert json.loads(said[-1]) == report
    assert [row["topic"] for row in report["rows"]] == ["resampling"]
    assert said[0] == "resampling"


def test_unknown_topic_names_the_known_and_writes_nothing(tool, tmp_path):
    answer = tool("bench", "--only", "deformm", "--out", tmp_path / "figures.json")
    refused(answer, "deformm", "did you mean 'deform'")
    assert list(tmp_path.iterdir()) == []
