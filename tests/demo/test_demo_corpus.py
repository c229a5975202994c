"""The simulated corpus on disk: the same bytes again, whole or not at all, and good enough to work with."""

import hashlib

import numpy as np
import pytest

from corpus_tools.core import OutputError
from corpus_tools.demo import VERSION, demo_folder, simulate_corpus, simulate_sentence
from corpus_tools.demo.sentences import pronounce
from corpus_tools.fragments import coverage
from corpus_tools.io import find_recordings, load_capture, load_labels, read_description
from corpus_tools.pipeline import check_corpus


def contents(folder):
    return {
        p.relative_to(folder).as_posix(): hashlib.sha256(p.read_bytes()).hexdigest()
        for p in folder.rglob("*")
        if p.is_file()
    }


class StoppedError(Exception):
    """Raised by a progress callback."""


def stop_at(fraction, error):
    def progress(done, what):
        if done >= fraction:
            raise error

    return progress


def test_equal_arguments_give_equal_bytes_and_another_seed_another_corpus(tmp_path):
    for name, seed in (("one", 3), ("two", 3), ("other", 4)):
        simulate_corpus(tmp_path / name, n_sentences=2, seed=seed)
    one, two, other = (contents(tmp_path / n) for n in ("one", "two", "other"))
    assert one == two
    assert set(one) == {
        "NOTE.txt",
        "corpus.toml",
        *(
            f"{f}/time0{i}.{e}"
            for f, e in (("markers", "npz"), ("wav", "wav"), ("textgrid", "TextGrid"))
            for i in (1, 2)
        ),
    }
    assert set(one) == set(other)
    for name in one:
        assert (one[name] == other[name]) == (name == "corpus.toml"), name


def test_the_corpus_says_that_it_is_simulated(simulated_corpus):
    description = read_description(simulated_corpus)
    assert "simulated" in description.name
    assert (description.frame_time, description.head_scale) == ("start", False)
    assert (simulated_corpus / "NOTE.txt").read_text().startswith("Simulated, not recorded")


def test_recordings_fit_together(simulated_corpus):
    description = read_description(simulated_corpus)
    files = find_recordings(description)
    assert len(files) == 14
    for item in files:
        capture, labels = load_capture(description, item), load_labels(description, item)
        assert capture.rate_hz == 120.0
        assert len(capture.names) == 73
        assert abs(capture.audio.duration_s - capture.duration_s) <= 1 / 120
        assert labels.end_s == pytest.approx(capture.audio.duration_s, abs=1e-3)
        assert labels.names == ("phones", "words")


def test_it_opens_whole_and_check_finds_its_gaps_and_nothing_else(opened_corpus, simulated_corpus):
    assert opened_corpus.skipped == {}
    assert len(opened_corpus.names) == 14
    assert np.isfinite(opened_corpus.neutral_mm).all()
    report = check_corpus(simulated_corpus)
    assert report["summary"]["with_gaps"] == 14
    assert report["advice"] == []
    for row in report["recordings"]:
        assert 1 <= len(row["gaps"]) <= 3
        assert len(row["problems"]) == 1
        assert "missing in frames" in row["problems"][0]


def test_a_sentence_held_out_is_covered_by_the_others(opened_corpus):
    utterances = [opened_corpus.utterance(n) for n in opened_corpus.names]
    report = coverage(opened_corpus.inventory, utterances, leave_one_out=True)
    shares = [u.share for u in report.utterances]
    assert np.mean(shares) >= 0.85
    assert min(shares) >= 0.6


def test_capture_is_the_truth_disturbed():
    made = simulate_sentence(pronounce("ten to five"), np.random.default_rng(0))
    assert made.truth_mm.shape == (made.capture.n_frames, 66, 3)
    assert np.isfinite(made.truth_mm).all()
    assert np.isnan(made.capture.positions_mm).any()
    assert made.capture.history[0].name == "simulated"
    assert dict(made.capture.history[0].settings)["version"] == VERSION


@pytest.mark.parametrize("error", [StoppedError(), KeyboardInterrupt()], ids=["cancelled", "ctrl-c"])
def test_nothing_is_left_when_it_is_interrupted(tmp_path, error):
    with pytest.raises(type(error)):
        simulate_corpus(tmp_path / "corpus", n_sentences=3, progress=stop_at(0.6, error))
    assert list(tmp_path.iterdir()) == []


def test_an_occupied_place_is_an_output_error_and_stays_as_it_was(tmp_path):
    place = tmp_path / "corpus"
    place.write_text("mine")
    with pytest.raises(OutputError, match="corpus"):
        simulate_corpus(place, n_sentences=1)
    assert place.read_text() == "mine"
    assert len(list(tmp_path.iterdir())) == 1


def test_demo_folder_is_made_once_and_made_anew_for_another_version(tmp_path):
    reports = []
    place = tmp_path / "cache" / "demo"
    assert demo_folder(place, lambda f, w: reports.append(f)) == place
    assert reports == sorted(reports)
    assert reports[-1] == 1.0
    before = contents(place)
    assert demo_folder(place, stop_at(0.0, StoppedError())) == place, "the second call does no work"
    note = place / "NOTE.txt"
    note.write_text(note.read_text().replace(f"Version {VERSION}", "Version 0"))
    (place / "markers" / "time99.npz").write_bytes(b"left over")
    demo_folder(place)
    assert contents(place) == before
