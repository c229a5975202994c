"""The folder of a synthesis: every file, the same bytes again, whole or not at all."""

import csv
import dataclasses
import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.config import Config
from corpus_tools.core import OutputError
from corpus_tools.io import file_hash, read_audio, read_labels
from corpus_tools.pipeline import corpus_provenance, outputs, prepare_head, synthesise, write_synthesis

FILES = {
    "motion.npz",
    "mesh.npz",
    "speech.wav",
    "labels.TextGrid",
    "contacts.csv",
    "joins.csv",
    "manifest.json",
    "run.json",
}
REQUEST = {"utterance": "time03", "held_out": True}


@pytest.fixture(scope="module")
def made(opened_corpus):
    head = prepare_head(opened_corpus, "base", Config())
    return head, synthesise(opened_corpus, opened_corpus.utterance("time03"), Config(), head, ["time03"])


@pytest.fixture(scope="module")
def provenance(opened_corpus):
    return corpus_provenance(opened_corpus)


@pytest.fixture(scope="module")
def written(made, provenance, tmp_path_factory):
    head, synthesis = made
    folder = tmp_path_factory.mktemp("out") / "synthesis"
    assert write_synthesis(folder, synthesis, head, Config(), provenance, REQUEST) == folder
    return folder


def test_every_file_is_there_and_nothing_else(written):
    assert {p.name for p in written.iterdir()} == FILES
    assert [p.name for p in written.parent.iterdir()] == ["synthesis"]


def test_motion_is_what_was_synthesised(written, made):
    trajectory = made[1].trajectory
    with np.load(written / "motion.npz", allow_pickle=False) as data:
        assert data["markers_mm"].dtype == np.float64
        np.testing.assert_array_equal(data["markers_mm"], trajectory.values_mm)
        np.testing.assert_array_equal(data["times_s"], trajectory.times_s)
        np.testing.assert_array_equal(data["flags"], trajectory.flags)
        assert tuple(data["names"]) == trajectory.names


def test_the_mesh_is_complete(written, made):
    head, synthesis = made
    with np.load(written / "mesh.npz", allow_pickle=False) as data:
        np.testing.assert_array_equal(data["vertices_mm"], synthesis.vertices_mm)
        assert data["vertices_mm"].dtype == np.float32
        assert data["faces"].dtype == np.int32
        assert data["faces"].shape[1] == 3
        assert data["faces"].max() < data["vertices_mm"].shape[1] == len(data["part"])
        assert data["part"].max() < len(data["names"])
        np.testing.assert_allclose(data["rest_mm"], head.mesh.vertices_mm, atol=1e-4)
        assert dict(zip(data["marker_names"], data["marker_vertices"], strict=True)) == head.mesh.markers


def test_sound_and_labels_are_those_of_the_utterance(written, made):
    utterance = made[1].utterance
    assert read_audio(written / "speech.wav").duration_s == pytest.approx(utterance.audio.duration_s)
    labels = read_labels(written / "labels.TextGrid")
    assert [i.text for i in labels.tier("phones")] == list(utterance.labels)
    assert " ".join(i.text for i in labels.tier("words") if i.text) == utterance.text


def test_contacts_are_rows_too(written, made):
    with (written / "contacts.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert ",".join(rows[0]) == "phone,start_s,end_s,kind,time_s,nearest_mm,held_s,made"
    assert [(r["phone"], r["kind"]) for r in rows] == [(c.phone, c.kind) for c in made[1].contacts]
    for row, contact in zip(rows, made[1].contacts, strict=True):
        assert row["made"] == str(contact.made)
        assert float(row["nearest_mm"]) == pytest.approx(contact.nearest_mm, rel=5.1e-4)


def test_joins_are_rows_with_the_columns_that_scripts_read(written, made):
    with (written / "joins.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    names = "join time_s phone left_source right_source overlap_s gap_mm gap_mm_s gap_mm_s2"
    assert tuple(rows[0]) == (*names.split(), "natural_percentile", "flagged", "peak_ratio")
    joins = made[1].trajectory.joins
    assert len(rows) == len(joins) == made[1].selection.n_joins
    for row, join in zip(rows, joins, strict=True):
        assert (row["left_source"], row["right_source"]) == (join.left_source, join.right_source)
        assert float(row["time_s"]) == pytest.approx(join.time_s, abs=5.1e-5)
        assert float(row["natural_percentile"]) == pytest.approx(join.natural_percentile, abs=0.051)
        for name in ("gap_mm", "gap_mm_s", "gap_mm_s2"):
            assert float(row[name]) == pytest.approx(getattr(join, name), rel=5.1e-4)
            assert len(row[name].replace(".", "").lstrip("0")) <= max(4, len(row[name].split(".")[0]))


@given(st.floats(1e-3, 1e7))
def test_a_gap_is_written_with_four_significant_digits(value):
    text = outputs._number("gap_mm", value)
    assert "e" not in text
    assert float(text) == pytest.approx(value, rel=5.1e-4)
    assert float(text) == float(f"{float(text):.4g}")


def test_an_unknown_number_is_blank_and_zero_is_zero():
    assert outputs._number("natural_percentile", float("nan")) == ""
    assert outputs._number("gap_mm", 0.0) == "0"


def test_the_manifest_accounts_for_everything(written, made, provenance):
    manifest = json.loads((written / "manifest.json").read_text())
    assert manifest["corpus"] == provenance
    assert manifest["request"] == REQUEST
    assert manifest["config"] == json.loads(json.dumps(Config().values()))
    assert set(manifest["files"]) == FILES - {"manifest.json", "run.json"}
    for name, digest in manifest["files"].items():
        assert file_hash(written / name) == digest
    spoken = [row["phones"] for row in manifest["selection"]]
    assert sum(len(p) - 1 for p in spoken) + 1 == len(made[1].utterance.labels)
    assert manifest["selection_cost"] == pytest.approx(made[1].selection.total_cost)
    assert [s["step"] for s in manifest["history"]] == [s.name for s in made[1].trajectory.history]
    assert manifest["history"]


def test_only_run_json_may_differ_between_equal_runs(written, opened_corpus, provenance, tmp_path):
    head = prepare_head(opened_corpus, "base", Config())
    again = synthesise(opened_corpus, opened_corpus.utterance("time03"), Config(), head, ["time03"])
    folder = write_synthesis(tmp_path / "elsewhere", again, head, Config(), provenance, REQUEST)
    for name in sorted(FILES - {"run.json"}):
        assert (folder / name).read_bytes() == (written / name).read_bytes(), name
    run = json.loads((folder / "run.json").read_text())
    assert set(run) == {"timings_ms", "host", "system", "date"}


def test_nothing_remains_when_it_is_interrupted(made, provenance, tmp_path, monkeypatch):
    def interrupted(*args):
        raise KeyboardInterrupt

    monkeypatch.setattr(outputs, "_write_rows", interrupted)
    head, synthesis = made
    with pytest.raises(KeyboardInterrupt):
        write_synthesis(tmp_path / "out", synthesis, head, Config(), provenance, REQUEST)
    assert list(tmp_path.iterdir()) == []


def test_a_place_that_cannot_be_written_is_an_output_error(made, provenance, tmp_path):
    (tmp_path / "taken").write_text("a file")
    head, synthesis = made
    with pytest.raises(OutputError, match="taken"):
        write_synthesis(tmp_path / "taken" / "out", synthesis, head, Config(), provenance, REQUEST)
    assert (tmp_path / "taken").read_text() == "a file"


def test_other_files_in_the_folder_are_left_alone(made, provenance, tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    (tmp_path / "joins.csv").write_text("old")
    head, synthesis = made
    write_synthesis(tmp_path, synthesis, head, Config(), provenance, REQUEST)
    assert (tmp_path / "mine.txt").read_text() == "mine"
    assert (tmp_path / "joins.csv").read_text().startswith("join,time_s")


def test_an_utterance_without_sound_is_written_in_silence(opened_corpus, made, provenance, tmp_path):
    head, synthesis = made
    mute = dataclasses.replace(synthesis, utterance=dataclasses.replace(synthesis.utterance, audio=None))
    write_synthesis(tmp_path / "out", mute, head, Config(), provenance, REQUEST)
    sound = read_audio(tmp_path / "out" / "speech.wav")
    assert sound.duration_s == pytest.approx(synthesis.utterance.duration_s, abs=1e-3)
    assert not np.asarray(sound.samples).any()
