"""``corpus-tools evaluate``: its files, equal bytes, mistakes told in a sentence, nothing half-written."""

from __future__ import annotations

import csv
import gc
import json
import os
import re
import signal
import subprocess
import sys
import weakref
from dataclasses import replace

import numpy as np
import pytest
from strategies.talking import talking_corpus

from corpus_tools.core import InputError
from corpus_tools.evaluate import METRICS
from corpus_tools.pipeline import CorpusSource, read_corpus

FILES = {"table.csv", "sentences.csv", "table.json", "report.html", "run.json"}


@pytest.fixture(scope="module")
def corpus(tmp_path_factory):
    return talking_corpus(tmp_path_factory.mktemp("talk"), n=9)


def rows(path):
    return list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))


def test_the_folder_holds_every_method_and_metric_and_twice_the_same(tool, corpus, tmp_path):
    methods = "mean,viseme-linear,greedy,viterbi:mode=inertial+closure=off"
    for name in ("a", "b"):
        code, out, err = tool(
            *("evaluate", corpus, "--folds", 3, "--methods", methods, "--out", tmp_path / name, "--json")
        )
        assert code == 0
        told = [line.partition(",")[0] for line in err.splitlines()]
        assert told == ["fold 1 of 3", "fold 2 of 3", "fold 3 of 3"], "a line a fold, where there is no bar"
    assert {p.name for p in (tmp_path / "a").iterdir()} == FILES
    for name in FILES - {"run.json"}:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    table = rows(tmp_path / "a/table.csv")
    assert list(table[0]) == ["method", "metric", "value", "low", "high", "n"]
    assert {r["method"] for r in table} == {"natural", "repetition", *methods.split(",")}
    assert {r["metric"] for r in table if r["method"] == "greedy"} == set(METRICS)
    for row in table:
        assert float(row["low"]) <= float(row["high"])
        assert 0 < int(row["n"]) <= 9
    values = {(r["method"], r["metric"]): float(r["value"]) for r in table}
    assert values["mean", "dynamic_range"] == pytest.approx(0, abs=1e-6)
    assert ("mean", "r_aperture") not in values  # a constant has no correlation
    assert ("mean", "word_r_aperture") not in values
    assert values["natural", "rmse_face"] == 0 or values["natural", "rmse_face"] > 1e-9
    header, *lines = [line.rstrip() for line in out.splitlines() if not line.startswith("{")]
    assert "rmse mm" in header
    assert "word_rmse mm" in header
    lines = {line.split()[0]: line.split()[1:] for line in lines[:6]}
    assert {len(cells) for cells in lines.values()} == {8}
    assert lines["repetition"][:7] == ["–"] * 7
    assert float(lines["repetition"][7]) > 0
    assert lines["mean"][1] == "–"
    assert values["natural", "rmse"] < 0.01
    assert values["greedy", "rmse"] < values["viseme-linear", "rmse"] < values["mean", "rmse"]
    assert json.loads(out.splitlines()[-1])["sentences"] == 9
    data = json.loads((tmp_path / "a/table.json").read_text(encoding="utf-8"))
    assert data["methods"]["viterbi:mode=inertial+closure=off"]["closure"] is False
    pair = next(
        r for r in data["ratios"] if (r["method"], r["against"], r["metric"]) == ("greedy", "mean", "rmse")
    )
    assert pair["value"] == pytest.approx(values["greedy", "rmse"] / values["mean", "rmse"], rel=1e-4)
    by_sentence = [
        float(r["value"])
        for r in rows(tmp_path / "a/sentences.csv")
        if (r["method"], r["metric"]) == ("greedy", "rmse")
    ]
    assert sum(by_sentence) / 9 == pytest.approx(values["greedy", "rmse"], rel=1e-4)


def test_tuned_weights_are_told_for_each_training_part(tool, corpus, tmp_path):
    method = "viterbi:weights=tuned"
    code, out, _ = tool("evaluate", corpus, "--folds", 2, "--methods", method, "--out", tmp_path / "o")
    assert code == 0
    (found,) = json.loads((tmp_path / "o/table.json").read_text(encoding="utf-8"))["tuned"].values()
    assert [set(w) >= {"duration", "join", "aperture"} for w in found] == [True, True]
    for number, weights in enumerate(found, 1):
        (line,) = (x for x in out.splitlines() if x.startswith(f"{method} found on training part {number}: "))
        assert f"join {weights['join']:g}" in line


def test_the_report_needs_nothing_else(tool, corpus, tmp_path):
    code, _, _ = tool("evaluate", corpus, "--folds", 2, "--methods", "mean,greedy", "--out", tmp_path / "o")
    assert code == 0
    page = (tmp_path / "o/report.html").read_text(encoding="utf-8")
    assert page.count("<svg") == 5
    for word in ("<script", "<link", "http:", "https:", "url("):
        assert word not in page.replace("http://www.w3.org/2000/svg", "")
    assert "NaN" not in page
    assert ">nan" not in page
    assert "e-" not in re.sub(r"<[^>]*>", " ", page.split("</style>")[1].split("<h2>Settings")[0]).replace(
        "viseme-", ""
    )
    assert "over the all" not in page
    assert "<td></td>" not in page
    for low, high in re.findall(r"<small>(-?[\d.]+) – (-?[\d.]+)</small>", page):
        assert float(low) < float(high)
    for name in METRICS:
        assert f"<dt>{name}</dt>" in page


def test_leave_one_out_and_a_test_corpus(tool, corpus, tmp_path):
    code, out, _ = tool(
        *("evaluate", corpus, "--leave-one-out", "--methods", "mean", "--out", tmp_path / "o", "--json")
    )
    assert code == 0
    assert json.loads(out.splitlines()[-1])["split"] == "leave-one-out"
    other = talking_corpus(tmp_path / "other", n=3, seed=5)
    code, out, _ = tool(
        *(
            "evaluate",
            corpus,
            "--test-corpus",
            other,
            "--methods",
            "greedy",
            "--out",
            tmp_path / "t",
            "--json",
        )
    )
    assert code == 0
    assert json.loads(out.splitlines()[-1])["sentences"] == 3
    assert {r["sentence"] for r in rows(tmp_path / "t/sentences.csv")} == {f"work/s{i:02d}" for i in range(3)}


def test_recordings_as_captured_are_let_go_once_they_are_cleaned(corpus):
    captured = []

    def read():
        raw = read_corpus(corpus, keep_sound=False)
        captured.extend(weakref.ref(c.positions_mm) for c in raw.captures)
        return raw

    source = CorpusSource(read)
    first = source.cleaned(source.names[2:], lambda f, w: None)
    gc.collect()
    assert len(captured) == 9
    assert sum(known() is not None for known in captured) == 0
    again = source.cleaned(source.names[2:], lambda f, w: None)
    assert len(captured) == 18
    for a, b in zip(first, again, strict=True):
        np.testing.assert_array_equal(a.capture.positions_mm, b.capture.positions_mm)


def test_a_corpus_that_changes_on_the_way_is_refused(corpus):
    raw = read_corpus(corpus, keep_sound=False)
    fewer = replace(raw, captures=raw.captures[1:], utterances=raw.utterances[1:])
    given = iter([raw, fewer])
    source = CorpusSource(lambda: next(given))
    source.cleaned(source.names, lambda f, w: None)
    with pytest.raises(InputError, match="8 recordings are usable and 9 were at the start"):
        source.cleaned(source.names, lambda f, w: None)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--folds", "1"), "from 2 to 9"),
        (("--folds", "10"), "from 2 to 9"),
        (("--folds", "3", "--leave-one-out"), "exclude each other"),
        (("--methods", "greedy,dominance-fone"), "did you mean 'dominance-phone'"),
        (("--methods", "greedy:joins=on"), "no setting 'joins'"),
        (("--methods", "mean,mean"), "names 'mean' twice"),
        (("--methods", ","), "names no method"),
        (("--test-corpus", "nowhere"), "nowhere"),
    ],
)
def test_mistakes_cost_a_sentence_and_write_nothing(tool, corpus, tmp_path, options, says):
    code, _out, err = tool("evaluate", corpus, *options, "--out", tmp_path / "o")
    assert code == 2
    assert says in err
    assert err.count("\n") == 1
    assert not (tmp_path / "o").exists()


def test_recordings_are_never_written_over(tool, corpus):
    code, _, err = tool("evaluate", corpus, "--out", corpus.parent / "t", "--methods", "mean")
    assert code == 2
    assert "belongs to the corpus" in err


def test_ctrl_c_leaves_nothing_behind(corpus, tmp_path):
    methods = ",".join(f"dominance-phone:components={n}" for n in range(20, 36))  # a minute and more
    command = [sys.executable, "-c", "from corpus_tools.cli.start import run; run()"]
    process = subprocess.Popen(
        [
            *command,
            "evaluate",
            str(corpus),
            "--leave-one-out",
            "--methods",
            methods,
            "--out",
            str(tmp_path / "o"),
        ],
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
    )
    first = process.stderr.readline()
    assert first.startswith("fold 1 of 4")
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=30)
    assert process.returncode == 2
    *told, last = err.splitlines()
    assert last == "Stopped before the end: nothing was written."
    assert all(line.startswith("fold ") for line in told)
    assert list(tmp_path.iterdir()) == []
