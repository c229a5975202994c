"""``corpus-tools clean``: told, drawn, as JSON; the corpus is left as it is."""

import json
import shutil

from tests.cli.answers import last_json


def test_clean_tells_and_writes_beside_the_corpus(tool, simulated_corpus, tmp_path):
    before = {p: p.stat().st_mtime_ns for p in simulated_corpus.rglob("*")}
    code, out, err = tool("clean", simulated_corpus, "--out", tmp_path / "o", "--json")
    assert (code, err) == (0, "")
    assert {p.name for p in (tmp_path / "o").iterdir()} == {"cleaning.json", "report.html"}
    written = json.loads((tmp_path / "o/cleaning.json").read_text())
    told = last_json(out)
    assert told["summary"] == written["summary"]
    assert "residual_mm" in written["recordings"][0]["head"]
    assert "residual_mm" not in told["recordings"][0]["head"]
    assert {p: p.stat().st_mtime_ns for p in simulated_corpus.rglob("*")} == before


def test_a_corpus_that_is_none_and_an_out_that_is_one_are_refused(tool, simulated_corpus, tmp_path):
    code, out, err = tool("clean", tmp_path / "nothing")
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    code, _, err = tool("clean", simulated_corpus, "--out", simulated_corpus)
    assert code == 2
    assert "choose a folder of its own" in err


def test_recordings_without_labels_are_cleaned_too(tool, simulated_corpus, tmp_path):
    bare = tmp_path / "bare"
    shutil.copytree(simulated_corpus, bare, ignore=shutil.ignore_patterns("*.TextGrid", "*.wav", "truth"))
    code, out, err = tool("clean", bare, "--json")
    assert (code, err) == (0, "")
    found = last_json(out)
    assert found["summary"]["recordings"] > 0
    assert (found["audio_offset_s"], found["skipped"]) == (None, {})
