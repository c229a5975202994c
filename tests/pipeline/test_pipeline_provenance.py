"""Hashes that say what a result was made of: they change with the content and with nothing else."""

import shutil
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest

import corpus_tools
from corpus_tools.core import Audio
from corpus_tools.io import read_audio, write_wav
from corpus_tools.pipeline import code_hash, corpus_provenance, library_versions, open_corpus

HASHES = ("motion_sha256", "labels_sha256", "audio_sha256")


@pytest.fixture(scope="module")
def before(small_corpus):
    return corpus_provenance(open_corpus(small_corpus))


def changed_hashes(before, folder):
    after = corpus_provenance(open_corpus(folder))
    return {key for key in HASHES if after[key] != before[key]}


def test_it_names_and_counts(before):
    assert before["name"] == "simulated time sentences"
    assert (before["recordings"], before["skipped"]) == (4, 0)
    assert len({before[key] for key in HASHES}) == 3
    assert all(len(before[key]) == 64 for key in HASHES)


def test_a_copy_elsewhere_has_the_same_hashes(before, spoiled):
    assert corpus_provenance(open_corpus(spoiled)) == before


def test_one_sample_of_sound_changes_the_hash_of_the_sound_only(before, spoiled):
    path = spoiled / "wav" / "time02.wav"
    sound = read_audio(path)
    samples = np.array(sound.samples)
    samples[100] += 0.01
    write_wav(path, Audio(samples, sound.rate_hz))
    assert changed_hashes(before, spoiled) == {"audio_sha256"}


def test_one_marker_changes_the_hash_of_the_motion_only(before, spoiled, alter):
    def nudge(capture):
        positions = np.array(capture.positions_mm)
        positions[3, 4, 1] += 0.01
        return type(capture)(positions, capture.rate_hz, capture.names)

    alter("time03", nudge)
    assert changed_hashes(before, spoiled) == {"motion_sha256"}


def test_a_label_changes_the_hash_of_the_labels_only(before, spoiled):
    path = spoiled / "textgrid" / "time01.TextGrid"
    text = path.read_text()
    assert '"DH"' in text
    path.write_text(text.replace('"DH"', '"TH"', 1))
    assert changed_hashes(before, spoiled) == {"labels_sha256"}


def test_a_recording_more_or_less_changes_the_counts_and_all_hashes(before, spoiled):
    for file in ("markers/time04.npz", "wav/time04.wav", "textgrid/time04.TextGrid"):
        (spoiled / file).unlink()
    assert changed_hashes(before, spoiled) == set(HASHES)
    assert corpus_provenance(open_corpus(spoiled))["recordings"] == 3


def test_a_recording_that_is_left_out_is_counted(spoiled):
    (spoiled / "textgrid" / "time04.TextGrid").unlink()
    found = corpus_provenance(open_corpus(spoiled))
    assert (found["recordings"], found["skipped"]) == (3, 1)


def test_the_hash_of_the_code_follows_its_content_and_not_its_place(tmp_path, monkeypatch):
    original = code_hash()
    copy = shutil.copytree(
        Path(corpus_tools.__file__).parent, tmp_path / "copy", ignore=shutil.ignore_patterns("__pycache__")
    )
    monkeypatch.setattr(corpus_tools, "__file__", str(copy / "__init__.py"))
    assert code_hash() == original
    (copy / "notes.md").write_text("not part of it")
    assert code_hash() == original
    data = copy / "speech" / "data" / "arpabet.toml"
    data.write_text(data.read_text() + "# one remark\n")
    with_data = code_hash()
    assert with_data != original
    module = copy / "pipeline" / "stages.py"
    module.rename(module.with_name("steps.py"))
    assert code_hash() not in (original, with_data)


def test_versions_are_those_of_the_libraries_that_compute():
    found = library_versions()
    assert found["numpy"] == np.__version__
    assert found["scipy"] == version("scipy")
    assert "absent" not in [v for k, v in found.items() if k != "numba"]
