"""An opened corpus: what is in it, what was left out and why, and that nothing in the folder changes."""

import dataclasses
import hashlib

import numpy as np
import pytest

from corpus_tools.config import Config, config_with
from corpus_tools.core import CorpusError, FrameFlag, InputError
from corpus_tools.io import read_description, write_description
from corpus_tools.pipeline import open_corpus
from corpus_tools.speech import lip_aperture_mm


def changed(capture, **values):
    return dataclasses.replace(capture, flags=None, regions=(), **values)


def without_head(capture):
    positions = np.array(capture.positions_mm)
    positions[:, 66:] = np.nan
    return changed(capture, positions_mm=positions)


def test_recordings_hold_clean_face_markers_only(opened_corpus):
    assert len(opened_corpus.markers) == 66
    assert not any(n.startswith("head") for n in opened_corpus.markers)
    for recording in opened_corpus.recordings:
        assert np.isfinite(recording.capture.positions_mm).all()
        at_times = ("fill_gaps", "without_outliers", "with_slips_marked")
        steps = [s.name for s in recording.capture.history if s.name not in at_times]
        assert steps[-3:] == ["remove_head_motion", "kalman_smooth", "remove_bias"]
        assert recording.capture.history[-1].name == "remove_bias"
    assert any(s.name == "fill_gaps" for r in opened_corpus.recordings for s in r.capture.history)
    filled = [(r.capture.flags & FrameFlag.FILLED).any() for r in opened_corpus.recordings]
    assert all(filled), "every simulated recording has gaps, and they stay flagged"


def test_inventory_and_utterances_are_those_of_the_recordings(opened_corpus):
    assert tuple(r.name for r in opened_corpus.inventory.recordings) == opened_corpus.names
    for name in opened_corpus.names:
        utterance = opened_corpus.utterance(name)
        assert utterance.name == name
        assert utterance.text.startswith("the time is now")
        assert utterance.labels[0] == utterance.labels[-1] == "SIL"
        assert utterance.audio is not None


def test_the_neutral_pose_is_a_closed_mouth(opened_corpus):
    neutral = opened_corpus.neutral_mm
    aperture = lip_aperture_mm(neutral[None], opened_corpus.markers)[0]
    assert aperture <= opened_corpus.lips.threshold_mm + 0.3
    assert abs(aperture) < 0.5
    assert not neutral.flags.writeable


def test_lips_pressed_in_speech_or_parted_at_rest_leave_a_neutral_pose(spoiled, alter):
    """Even where no silent frame reaches the closures of the bilabials."""

    def parted(capture):
        positions = np.array(capture.positions_mm)
        lower = [i for i, n in enumerate(capture.names) if n in ("lip_in5", "lip_in6", "lip_in7")]
        still = np.arange(len(positions)) / 120 < 0.3
        positions[np.ix_(still, lower, [1])] -= 4.0
        positions[-20:, lower, 1] -= 4.0
        return changed(capture, positions_mm=positions)

    for i in (1, 2, 3, 4):
        alter(f"time0{i}", parted)
    corpus = open_corpus(spoiled)
    aperture = lip_aperture_mm(corpus.neutral_mm[None], corpus.markers)[0]
    assert corpus.lips.threshold_mm < aperture < 4.5


def test_a_mouth_that_is_open_in_most_silences_is_neutral_when_closed(spoiled, alter):
    def parted(capture):
        positions = np.array(capture.positions_mm)
        lower = [i for i, n in enumerate(capture.names) if n in ("lip_in5", "lip_in6", "lip_in7")]
        positions[-60:, lower, 1] -= 4.0
        positions[np.ix_(np.arange(15, 30), lower, [1])] -= 4.0
        return changed(capture, positions_mm=positions)

    for i in (1, 2, 3, 4):
        alter(f"time0{i}", parted)
    corpus = open_corpus(spoiled)
    assert abs(lip_aperture_mm(corpus.neutral_mm[None], corpus.markers)[0]) < 0.5


def test_the_lips_of_the_corpus_close(opened_corpus):
    lips = opened_corpus.lips
    assert abs(lips.target_mm) < 0.6
    assert lips.target_mm < lips.threshold_mm < 1.0
    assert np.einsum("mk,mk", lips.functional, lips.direction) == pytest.approx(1.0)


def test_scale_is_left_alone_unless_corpus_toml_allows_it(opened_corpus, spoiled):
    assert opened_corpus.scale_sd == 0.0
    write_description(dataclasses.replace(read_description(spoiled), head_scale=True))
    assert 0.0 < open_corpus(spoiled).scale_sd < 0.003


def test_cleaning_settings_of_the_config_are_used(small_corpus):
    smooth = open_corpus(small_corpus, config_with(Config(), cleaning__cutoff_hz=3.0))
    sharp = open_corpus(small_corpus, config_with(Config(), cleaning__cutoff_hz=20.0))
    rough = [
        np.mean([np.abs(np.diff(r.capture.positions_mm, 3, axis=0)).mean() for r in c.recordings])
        for c in (smooth, sharp)
    ]
    assert rough[0] < 0.3 * rough[1]


def test_an_excluded_recording_is_not_there(spoiled):
    write_description(dataclasses.replace(read_description(spoiled), exclude=("time02",)))
    corpus = open_corpus(spoiled)
    assert corpus.names == ("time01", "time03", "time04")
    assert corpus.skipped == {}


def test_unknown_recordings_are_refused_with_a_suggestion(opened_corpus):
    with pytest.raises(InputError, match=r"'time1'.*the nearest of its \d+ are 'time\d+', 'time\d+', 'time"):
        opened_corpus.utterance("time1")


def test_a_recording_without_labels_is_left_out_with_a_reason(spoiled):
    (spoiled / "textgrid" / "time03.TextGrid").unlink()
    corpus = open_corpus(spoiled)
    assert corpus.names == ("time01", "time02", "time04")
    assert "has no labels" in corpus.skipped["time03"]
    with pytest.raises(InputError, match=r"'time03' cannot be used: .*no labels"):
        corpus.utterance("time03")


@pytest.mark.parametrize(
    ("how", "reason"),
    [
        (without_head, "reference markers"),
        (lambda c: changed(c, positions_mm=c.positions_mm[:1]), "its labels speak"),
        (lambda c: changed(c, positions_mm=c.positions_mm[:150]), "its labels speak"),
        (lambda c: changed(c, names=("left_brow", *c.names[1:])), "markers differ from those of"),
    ],
    ids=["no head", "one frame", "cut short", "other names"],
)
@pytest.mark.parametrize("odd", ["time01", "time03"])
def test_a_recording_that_cannot_give_units_is_left_out_with_a_reason(spoiled, alter, how, reason, odd):
    alter(odd, how)
    corpus = open_corpus(spoiled)
    assert list(corpus.skipped) == [odd]
    assert reason in corpus.skipped[odd]
    assert len(corpus.names) == 3


def test_motion_that_ends_just_after_the_speech_is_enough(spoiled, alter):
    spoken_s = open_corpus(spoiled).utterance("time02").phones.intervals[-1].start_s
    alter("time02", lambda c: changed(c, positions_mm=c.positions_mm[: int(120 * spoken_s)]))
    assert open_corpus(spoiled).skipped == {}


def test_a_corpus_without_one_usable_recording_says_why(spoiled, alter):
    for i in (1, 2, 3, 4):
        (spoiled / "textgrid" / f"time0{i}.TextGrid").unlink()
    with pytest.raises(CorpusError, match=r"No recording .* can be used; the first, 'time01': .*no labels"):
        open_corpus(spoiled)


def test_nothing_in_the_folder_is_altered(spoiled):
    def contents():
        files = [p for p in sorted(spoiled.rglob("*")) if p.is_file()]
        return {p: (hashlib.sha256(p.read_bytes()).hexdigest(), p.stat().st_mtime_ns) for p in files}

    before = contents()
    open_corpus(spoiled)
    assert contents() == before


def test_progress_rises_to_one_and_may_stop_the_work(small_corpus):
    told = []
    open_corpus(small_corpus, progress=lambda fraction, what: told.append(fraction))
    assert told == sorted(told)
    assert told[-1] == 1.0

    def stop(fraction, what):
        if fraction > 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        open_corpus(small_corpus, progress=stop)
