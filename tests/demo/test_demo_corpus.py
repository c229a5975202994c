"""The simulated corpus on disk: the same bytes again, whole or not at all, with the truth beside it."""

import hashlib

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from corpus_tools.cleaning import clean_captures
from corpus_tools.core import InputError, OutputError
from corpus_tools.demo import (
    DIMENSIONS,
    UNDISTURBED,
    VERSION,
    VOICES,
    Disturbances,
    disturb,
    marker_names,
    read_truth,
    simulate_corpus,
    simulate_sentence,
    time_grammar,
    true_markers,
)
from corpus_tools.fragments import coverage
from corpus_tools.io import find_recordings, load_capture, load_labels, read_description
from corpus_tools.pipeline import check_corpus, health_lines

KINDS = (("markers", "npz"), ("wav", "wav"), ("textgrid", "TextGrid"), ("truth", "npz"))


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
        simulate_corpus(tmp_path / name, n_sentences=3, seed=seed)
    one, two, other = (contents(tmp_path / n) for n in ("one", "two", "other"))
    assert one == two
    files = {f"{folder}/time0{i}.{end}" for folder, end in KINDS for i in (1, 2, 3)}
    assert set(one) == set(other) == {"README.txt", "corpus.toml", *files}
    for name in one:
        assert (one[name] == other[name]) == (name == "corpus.toml"), name


def test_a_smaller_corpus_is_the_beginning_of_a_larger_one(tmp_path):
    for n in (2, 3):
        simulate_corpus(tmp_path / str(n), n_sentences=n)
    small, large = (contents(tmp_path / n) for n in "23")
    shared = set(small) - {"README.txt"}
    assert {name: small[name] for name in shared} == {name: large[name] for name in shared}


@pytest.fixture(scope="module")
def checked(simulated_corpus):
    return check_corpus(simulated_corpus)


def test_the_corpus_says_that_it_is_simulated_wherever_it_is_shown(simulated_corpus, checked):
    description = read_description(simulated_corpus)
    assert "simulated" in description.name
    assert (description.frame_time, description.head_scale) == ("start", False)
    readme = (simulated_corpus / "README.txt").read_text()
    assert readme.startswith("Simulated, not recorded")
    assert f"Version {VERSION} of the simulator, voice espeak" in readme
    assert "simulated" in health_lines(checked)[0]


def test_the_readme_lists_what_went_wrong_in_each_recording(tmp_path):
    how = Disturbances(swap_chance=0.5, slip_chance=0.5)
    simulate_corpus(tmp_path / "c", n_sentences=8, voice=VOICES["formants"], how=how)
    told = (tmp_path / "c" / "README.txt").read_text().splitlines()
    slips, swaps = set(), set()
    for path in (tmp_path / "c" / "truth").iterdir():
        truth = read_truth(path)
        if np.isfinite(truth.slip_s):
            slips.add(f"  {path.stem}: the jig slips at {truth.slip_s:.2f} s")
        if truth.swapped.any():
            pair = " and ".join(np.array(truth.names)[truth.swapped.any(axis=0)])
            frames = np.flatnonzero(truth.swapped.any(axis=1))
            swaps.add(f"  {path.stem}: {pair} exchanged in frames {frames[0]}-{frames[-1]}")
    assert slips == {line for line in told if "slips" in line and ": the jig" in line}
    assert swaps == {line for line in told if "exchanged" in line}
    assert 0 < len(slips) < 8
    assert 0 < len(swaps) < 8


def test_the_demo_has_a_few_recordings_with_a_swap_and_a_few_with_a_slip():
    """Which they are does not depend on what is said, only on how many frames there are."""
    face = true_markers(np.zeros((400, len(DIMENSIONS))))
    seen = [disturb(face, 120.0, np.random.default_rng([0, i]).spawn(3)[2]) for i in range(55)]
    assert 1 <= sum(s.swapped.any() for s in seen) <= 5
    assert 5 <= sum(np.isfinite(s.slip_s) for s in seen) <= 12
    share = np.mean([s.spiked.mean() for s in seen])
    assert share == pytest.approx(Disturbances().spike_share, rel=0.2)


def test_recordings_fit_together(simulated_corpus):
    description = read_description(simulated_corpus)
    files = find_recordings(description)
    assert len(files) == 14
    for item in files:
        capture, labels = load_capture(description, item), load_labels(description, item)
        assert capture.rate_hz == 120.0
        assert capture.names == marker_names()
        assert abs(capture.audio.duration_s - capture.duration_s) <= 1 / 120
        assert labels.end_s == pytest.approx(capture.audio.duration_s, abs=1e-3)
        assert labels.names == ("phones", "words")


def test_it_opens_whole_and_check_finds_its_gaps_and_the_slips_of_its_jig_and_nothing_else(
    opened_corpus, simulated_corpus, checked
):
    assert opened_corpus.skipped == {}
    assert len(opened_corpus.names) == 14
    assert np.isfinite(opened_corpus.neutral_mm).all()
    assert checked["advice"] == []
    for row in checked["recordings"]:
        truth = read_truth(simulated_corpus / "truth" / f"{row['id']}.npz")
        hidden = truth.occluded.any(axis=1)
        edges = np.flatnonzero(np.diff(np.r_[0, hidden, 0])).reshape(-1, 2) - [0, 1]
        assert row["gaps"] == edges.tolist()
        slips = [p for p in row["problems"] if "slipped" in p]
        assert len(row["problems"]) - len(slips) == bool(row["gaps"])
        assert not slips or np.isfinite(truth.slip_s)
    assert 10 <= checked["summary"]["with_gaps"] <= 14


def test_a_sentence_held_out_is_covered_by_the_others(opened_corpus):
    utterances = [opened_corpus.utterance(n) for n in opened_corpus.names]
    report = coverage(opened_corpus.inventory, utterances, leave_one_out=True)
    shares = [u.share for u in report.utterances]
    assert np.mean(shares) >= 0.85
    assert min(shares) >= 0.6


def test_the_truth_and_what_was_done_to_it_give_the_capture(simulated_corpus):
    description = read_description(simulated_corpus)
    for item in find_recordings(description):
        truth = read_truth(simulated_corpus / "truth" / f"{item.id}.npz")
        capture = load_capture(description, item)
        assert truth.names == capture.names
        assert truth.rate_hz == capture.rate_hz
        still = np.concatenate([truth.face_mm + truth.skin_mm, truth.jig_mm], axis=1)
        seen = np.einsum("fij,fmj->fmi", truth.rotation, still) + truth.translation_mm[:, None]
        left = np.linalg.norm(capture.positions_mm - seen, axis=2)
        assert (np.isnan(left) == truth.occluded).all()
        assert left[~(truth.occluded | truth.spiked | truth.swapped)].max() < 0.4, "sensor noise and rounding"


@pytest.mark.parametrize(("head_support", "within_mm"), [(False, 0.05), (True, 0.15)])
def test_cleaning_brings_an_undisturbed_capture_back_to_the_truth(head_support, within_mm):
    """An exact jig knows the head better than skin does; help from the cheeks costs a tenth of a mm."""
    made = simulate_sentence(time_grammar().pronounce("ten to five"), np.random.default_rng(0), UNDISTURBED)
    cleaned = clean_captures(
        [made.capture], range(66, 73), allow_scale=False, cutoff_hz=60.0, head_support=head_support
    ).captures[0]
    found = np.asarray(cleaned.positions_mm)[:, :66].reshape(-1, 3)
    true = made.truth_mm.reshape(-1, 3)
    turn, _ = Rotation.align_vectors(true - true.mean(0), found - found.mean(0))
    assert np.abs(turn.apply(found - found.mean(0)) - (true - true.mean(0))).max() < within_mm


def test_a_sentence_tells_how_it_was_made():
    made = simulate_sentence(time_grammar().pronounce("ten to five"), np.random.default_rng(0))
    assert made.truth_mm.shape == (made.capture.n_frames, 66, 3)
    assert made.capture.history[0].name == "simulated"
    assert dict(made.capture.history[0].settings)["version"] == VERSION


def test_another_voice_and_another_layout_can_be_asked_for_and_unknown_ones_are_refused(tmp_path):
    simulate_corpus(tmp_path / "c", n_sentences=1, voice=VOICES["formants"], layout="outer-lips")
    readme = (tmp_path / "c" / "README.txt").read_text()
    assert "voice formants" in readme
    assert "the extra 'voice' is not installed" in readme
    description = read_description(tmp_path / "c")
    capture = load_capture(description, find_recordings(description)[0])
    assert len(capture.names) == 65
    assert capture.audio.rate_hz == 16000
    with pytest.raises(InputError, match="outer-lips"):
        simulate_corpus(tmp_path / "d", n_sentences=1, layout="inner")
    assert not (tmp_path / "d").exists()


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


def test_progress_runs_from_nothing_to_all_in_words(tmp_path):
    reports = []
    simulate_corpus(tmp_path / "c", n_sentences=3, progress=lambda f, w: reports.append((f, w)))
    fractions = [f for f, _ in reports]
    assert fractions == sorted(fractions)
    assert (fractions[0], fractions[-1]) == (0.0, 1.0)
    assert reports[1][1] == "simulating sentence 2 of 3"
