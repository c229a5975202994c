"""The batch command on a simulated corpus: outputs, equal bytes, one sentence for every mistake."""

from __future__ import annotations

import csv
import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest

from corpus_tools.config import Config, config_with, write_config
from corpus_tools.io import find_recordings, read_description, read_labels
from corpus_tools.pipeline.outputs import JOIN_COLUMNS
from tests.cli.answers import START, last_json

FILES = {
    "motion.npz",
    "mesh.npz",
    "speech.wav",
    "labels.TextGrid",
    "joins.csv",
    "contacts.csv",
    "manifest.json",
    "run.json",
}


def digest(folder):
    found = hashlib.sha256()
    for path in sorted(p for p in folder.rglob("*") if p.is_file()):
        found.update(path.relative_to(folder).as_posix().encode() + path.read_bytes())
    return found.hexdigest()


@pytest.fixture(scope="module")
def sentence(simulated_corpus):
    return find_recordings(read_description(simulated_corpus))[0].id


def test_synth_writes_the_whole_folder_and_leaves_the_corpus_alone(
    tool, simulated_corpus, sentence, tmp_path
):
    before = digest(simulated_corpus)
    code, out, err = tool(
        "synth", simulated_corpus, "--utterance", sentence, "--out", tmp_path / "o", "--json"
    )
    assert (code, err) == (0, "")
    summary = last_json(out)
    assert {p.name for p in (tmp_path / "o").iterdir()} == FILES
    motion, mesh = np.load(tmp_path / "o/motion.npz"), np.load(tmp_path / "o/mesh.npz")
    assert motion["markers_mm"].shape == (summary["frames"], 66, 3)
    assert motion["markers_mm"].dtype == np.float64
    assert mesh["vertices_mm"].dtype == np.float32
    assert len(mesh["vertices_mm"]) == summary["frames"]
    assert np.isfinite(mesh["vertices_mm"]).all()
    assert mesh["faces"].shape[1] == 3
    np.testing.assert_allclose(np.diff(motion["times_s"]), 1 / 120)
    assert re.search(r"^\d+ of \d+ joins? above the 95th percentile of natural stretches", out, re.MULTILINE)
    rows = list(csv.DictReader((tmp_path / "o/joins.csv").read_text().splitlines()))
    assert tuple((tmp_path / "o/joins.csv").read_text().splitlines()[0].split(",")) == JOIN_COLUMNS
    assert len(rows) == summary["joins"] == summary["join_peaks"]["n"]
    contacts = list(csv.DictReader((tmp_path / "o/contacts.csv").read_text().splitlines()))
    assert summary["contacts"]["closed"]["n"] == sum(c["kind"] == "closed" for c in contacts) > 0
    assert summary["contacts"]["missed"] == []
    n = summary["contacts"]["closed"]["n"]
    assert f"{n} of {n} closure" in out
    ratios = [float(r["peak_ratio"]) for r in rows]
    assert summary["join_peaks"]["above_p95"] == sum(r > 1 for r in ratios)
    assert summary["join_peaks"]["worst"]["ratio"] == max(ratios)
    assert all(
        (r > 1) == (float(row["natural_percentile"]) > 95) for r, row in zip(ratios, rows, strict=True)
    )
    manifest = json.loads((tmp_path / "o/manifest.json").read_text())
    assert manifest["request"] == {"utterance": sentence, "held_out": [sentence]}
    assert all(not s["unit"].startswith(f"{sentence}:") for s in manifest["selection"])
    for name, value in manifest["files"].items():
        assert hashlib.sha256((tmp_path / "o" / name).read_bytes()).hexdigest() == value
    assert digest(simulated_corpus) == before


def test_what_an_earlier_result_left_is_removed_and_told(tool, simulated_corpus, sentence, tmp_path):
    base = ("synth", simulated_corpus, "--utterance", sentence, "--out", tmp_path / "o")
    code, out, _ = tool(*base, "--export", "csv,trc")
    assert code == 0
    assert "Removed" not in out
    (tmp_path / "o/notes.txt").write_text("mine")
    code, out, err = tool(*base)
    assert (code, err) == (0, "")
    assert f"Removed what an earlier result left in {tmp_path / 'o'}: motion.csv, motion.trc." in out
    assert {p.name for p in (tmp_path / "o").iterdir()} == FILES | {"notes.txt"}


def test_equal_runs_give_equal_bytes(tool, simulated_corpus, sentence, tmp_path):
    for name in ("a", "b"):
        assert tool("synth", simulated_corpus, "--utterance", sentence, "--out", tmp_path / name)[0] == 0
    for name in FILES - {"run.json"}:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes(), name


def test_labels_speak_like_the_recording_they_come_from(tool, simulated_corpus, sentence, tmp_path):
    files = find_recordings(read_description(simulated_corpus))[0]
    tool("synth", simulated_corpus, "--utterance", sentence, "--out", tmp_path / "a")
    code, out, err = tool(
        "synth", simulated_corpus, "--labels", files.labels, "--audio", files.audio, "--out", tmp_path / "b"
    )
    assert (code, err) == (0, "")
    assert f"The labels are those of the recording {sentence}: it is held out (--include-self" in out
    assert json.loads((tmp_path / "b/manifest.json").read_text())["request"]["held_out"] == [sentence]
    assert (tmp_path / "a/motion.npz").read_bytes() == (tmp_path / "b/motion.npz").read_bytes()
    assert (tmp_path / "a/speech.wav").read_bytes() == (tmp_path / "b/speech.wav").read_bytes()
    own = ("--labels", files.labels, "--include-self")
    code, out, _ = tool("synth", simulated_corpus, *own, "--out", tmp_path / "c", "--json")
    assert code == 0
    assert "held out (" not in out
    assert all(f.startswith(f"{sentence}:") for f in last_json(out)["fragments"])
    phones = read_labels(tmp_path / "c/labels.TextGrid").tier("phones")
    assert [p.text for p in phones] == [
        p.text for p in read_labels(tmp_path / "a/labels.TextGrid").tier("phones")
    ]


def test_a_config_changes_the_motion_and_flags_override_it(tool, simulated_corpus, sentence, tmp_path):
    write_config(
        tmp_path / "tuned.toml", config_with(Config(), blend__weighting="linear", blend__overlap_s=0.04)
    )
    base = ("synth", simulated_corpus, "--utterance", sentence)
    tool(*base, "--out", tmp_path / "a")
    assert tool(*base, "--config", tmp_path / "tuned.toml", "--out", tmp_path / "b")[0] == 0
    assert (tmp_path / "a/motion.npz").read_bytes() != (tmp_path / "b/motion.npz").read_bytes()
    tool(
        *base,
        "--config",
        tmp_path / "tuned.toml",
        "--method",
        "greedy",
        "--fps",
        "60",
        "--out",
        tmp_path / "c",
    )
    config = json.loads((tmp_path / "c/manifest.json").read_text())["config"]
    assert config["selection"]["method"] == "greedy"
    assert config["blend"]["weighting"] == "linear"
    np.testing.assert_allclose(np.diff(np.load(tmp_path / "c/motion.npz")["times_s"]), 1 / 60)


def test_check_units_coverage_print_json(tool, simulated_corpus):
    code, out, _ = tool("check", simulated_corpus, "--json")
    report = last_json(out)
    assert code == 0
    assert report["summary"]["recordings"] == len(report["recordings"]) > 5
    assert report["summary"]["with_gaps"] == sum(bool(r["gaps"]) for r in report["recordings"]) > 0
    assert {"id", "n_frames", "rate_hz", "duration_s", "gaps", "problems"} <= set(report["recordings"][0])
    code, out, _ = tool("units", simulated_corpus, "--json")
    assert code == 0
    assert last_json(out)["recordings"] == report["summary"]["recordings"]
    code, out, _ = tool("coverage", simulated_corpus, "--json")
    assert code == 0
    report = last_json(out)
    assert 0 < report["mean"] <= 1
    told = " ".join(out.splitlines()[:-1])
    assert report["diphones"]
    assert all(f"{diphone} {n}" in told for diphone, n in report["diphones"].items())
    least = min(report["utterances"], key=lambda u: u["coverage"])
    assert f"{least['id']}  {least['coverage']:.3f}  lacks {', '.join(least['missing'])}" in told


def test_config_commands(tool, tmp_path):
    code, out, _ = tool("config", "show")
    assert code == 0
    (tmp_path / "a.toml").write_text(out)
    assert tool("config", "check", tmp_path / "a.toml")[0] == 0
    write_config(tmp_path / "b.toml", config_with(Config(), blend__shape=0.5))
    code, out, _ = tool("config", "diff", tmp_path / "a.toml", tmp_path / "b.toml", "--json")
    assert last_json(out) == {"changes": [{"key": "blend.shape", "before": 0.0, "after": 0.5}]}
    code, out, _ = tool("config", "show", "--json")
    assert json.loads(out)["blend"]["weighting"] == "smootherstep"
    code, out, _ = tool("config", "schema")
    assert "properties" in json.loads(out)


@pytest.fixture
def bad(simulated_corpus, sentence, tmp_path):
    """Return the folder of things that are wrong in one way each."""
    (tmp_path / "emptyfolder").mkdir()
    shutil.copytree(simulated_corpus, tmp_path / "wrongkey")
    toml = tmp_path / "wrongkey/corpus.toml"
    toml.write_text(toml.read_text().replace("frame_time", "fraem_time"))
    shutil.copytree(simulated_corpus, tmp_path / "unlabelled")
    files = find_recordings(read_description(tmp_path / "unlabelled"))
    labels = files[0].labels
    text = labels.read_bytes()
    (tmp_path / "halved.TextGrid").write_bytes(text[: len(text) // 3])
    outside = text.decode().replace('"AH"', '"QX"').replace('"IH"', '"QX"')
    (tmp_path / "outside.TextGrid").write_text(outside)
    labels.unlink()
    (tmp_path / "notamesh.obj").write_text("nonsense\n")
    (tmp_path / "misspelt.toml").write_text("corpsu = 1\n")
    (tmp_path / "file").write_text("x")
    return tmp_path


CASES = [
    ("nowhere", ["synth", "{bad}/nowhere", "--utterance", "{s}"]),
    ("emptyfolder", ["synth", "{bad}/emptyfolder", "--utterance", "{s}"]),
    ("fraem_time", ["synth", "{bad}/wrongkey", "--utterance", "{s}"]),
    ("{s}", ["synth", "{bad}/unlabelled", "--utterance", "{s}"]),
    ("nosuchsentence", ["synth", "{c}", "--utterance", "nosuchsentence"]),
    ("halved.TextGrid", ["synth", "{c}", "--labels", "{bad}/halved.TextGrid"]),
    ("nothere.TextGrid", ["synth", "{c}", "--labels", "{bad}/nothere.TextGrid"]),
    ("QX", ["synth", "{c}", "--labels", "{bad}/outside.TextGrid"]),
    ("nothere.wav", ["synth", "{c}", "--labels", "{lab}", "--audio", "{bad}/nothere.wav"]),
    ("notamesh.obj", ["synth", "{c}", "--utterance", "{s}", "--mesh", "{bad}/notamesh.obj"]),
    ("nosuchmesh", ["synth", "{c}", "--utterance", "{s}", "--mesh", "nosuchmesh"]),
    ("nosuchmethod", ["synth", "{c}", "--utterance", "{s}", "--method", "nosuchmethod"]),
    ("corpsu", ["synth", "{c}", "--utterance", "{s}", "--config", "{bad}/misspelt.toml"]),
    ("fps", ["synth", "{c}", "--utterance", "{s}", "--fps", "fast"]),
    ("--fps -3", ["synth", "{c}", "--utterance", "{s}", "--fps", "-3"]),
    ("--utterance", ["synth", "{c}"]),
    ("--audio", ["synth", "{c}", "--utterance", "{s}", "--audio", "{bad}/file"]),
]


@pytest.mark.parametrize(("word", "args"), CASES, ids=[c[0] for c in CASES])
def test_a_mistake_costs_one_sentence_and_leaves_nothing(tool, bad, simulated_corpus, sentence, word, args):
    lab = find_recordings(read_description(simulated_corpus))[0].labels
    names = {"bad": bad, "c": simulated_corpus, "s": sentence, "lab": lab}
    before = digest(bad)
    code, out, err = tool(*[a.format(**names) for a in args], "--out", bad / "out")
    assert code == 2
    assert word.format(**names) in err
    assert "Traceback" not in out + err
    assert len([line for line in err.splitlines() if line.strip()]) <= 4
    assert digest(bad) == before
    assert not (bad / "out").exists()


@pytest.mark.parametrize("place", ["{bad}/file", "{bad}/file/below", "/proc/nowhere"])
def test_unwritable_output_is_refused_before_the_work(tool, bad, simulated_corpus, sentence, place):
    out = place.format(bad=bad)
    code, _, err = tool("synth", simulated_corpus, "--utterance", sentence, "--out", out)
    assert code == 2
    assert out in err
    assert (bad / "file").read_text() == "x"


def test_interrupted_in_the_middle_nothing_remains(simulated_corpus, sentence, tmp_path):
    command = START
    args = ["synth", str(simulated_corpus), "--utterance", sentence, "--out", str(tmp_path / "out")]
    process = subprocess.Popen(
        command + args, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env={**os.environ}
    )
    deadline = time.monotonic() + 60
    # the command installs its handlers once it reads the corpus: the files it opens show that
    while (
        time.monotonic() < deadline and process.poll() is None and not _reads(process.pid, simulated_corpus)
    ):
        time.sleep(0.005)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 2, err
    assert "Traceback" not in err
    assert len(err.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


def _reads(pid, folder):
    try:
        return any(str(f.readlink()).startswith(str(folder)) for f in Path(f"/proc/{pid}/fd").iterdir())
    except OSError:
        return False
