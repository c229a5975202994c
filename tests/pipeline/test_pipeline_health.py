"""The report of a corpus: constructed faults are found, each where it is, and the advice sets them right."""

import dataclasses
import re

import numpy as np
import pytest

from corpus_tools.core import Audio, Capture, CorpusError, Interval, Labels, Tier
from corpus_tools.demo import UNDISTURBED, covering_sentences, simulate_sentence
from corpus_tools.io import (
    init_corpus,
    read_audio,
    read_description,
    read_labels,
    write_description,
    write_markers_npz,
    write_textgrid,
    write_wav,
)
from corpus_tools.pipeline import check_corpus, clean_corpus, cleaning_report, health_lines, read_corpus


def changed(capture, **values):
    return dataclasses.replace(capture, flags=None, regions=(), **values)


def problems(report, name):
    return next(row["problems"] for row in report["recordings"] if row["id"] == name)


def only_problem(report, name):
    """Return the one problem of a recording beside its gaps; the others must have no more than gaps."""
    beside = {
        r["id"]: [p for p in r["problems"] if "missing in frames" not in p] for r in report["recordings"]
    }
    found = {key: said for key, said in beside.items() if said}
    assert list(found) == [name]
    (sentence,) = found[name]
    return sentence


def test_a_sound_corpus_has_gaps_and_no_other_problem(small_corpus):
    report = check_corpus(small_corpus)
    assert report["corpus"] == "simulated time sentences"
    assert report["summary"] == {
        "recordings": 4,
        "duration_s": pytest.approx(sum(r["n_frames"] for r in report["recordings"]) / 120, abs=0.01),
        "labelled": 4,
        "with_gaps": 4,
        "with_problems": 4,
    }
    assert report["head_scale_sd"] < 0.003
    posture = report["posture_offsets"]
    assert posture["rms_mm"] <= posture["largest_mm"] < 0.3
    assert posture["largest"] in {r["id"] for r in report["recordings"]}
    told = f"{posture['rms_mm']:.2f} mm rms, largest {posture['largest']} {posture['largest_mm']:.2f} mm"
    assert any(told in line for line in health_lines(report))
    assert abs(report["closure_offset_s"]) < 0.5 / 120
    assert report["advice"] == []
    for row in report["recordings"]:
        assert all("missing in frames" in problem for problem in row["problems"])


def test_every_recording_has_the_fields_that_scripts_read(small_corpus):
    for row in check_corpus(small_corpus)["recordings"]:
        assert set(row) == {"id", "n_frames", "rate_hz", "duration_s", "gaps", "problems"}
        assert row["rate_hz"] == 120.0
        assert row["duration_s"] == pytest.approx(row["n_frames"] / 120.0, abs=1e-6)


def test_gaps_are_frame_ranges_with_both_ends(spoiled, alter):
    def hide(capture):
        positions = np.nan_to_num(capture.positions_mm, nan=1.0)
        positions[5:8, 3] = np.nan
        positions[8:10, 4] = np.nan
        positions[20, 5] = np.nan
        return changed(capture, positions_mm=positions)

    alter("time02", hide)
    row = check_corpus(spoiled)["recordings"][1]
    assert row["gaps"] == [[5, 9], [20, 20]]
    assert row["problems"] == ["markers missing in frames 5-9, 20."]


def test_a_length_mismatch_is_found(spoiled):
    path = spoiled / "wav" / "time03.wav"
    sound = read_audio(path)
    longer = np.zeros(round(0.05 * sound.rate_hz), np.float32)
    write_wav(path, Audio(np.concatenate([sound.samples, longer]), sound.rate_hz))
    sentence = only_problem(check_corpus(spoiled), "time03")
    assert sentence.startswith("length mismatch")
    length_s = (len(sound.samples) + len(longer)) / sound.rate_hz
    assert f"audio {length_s:.3f} s" in sentence


def test_labels_beyond_the_audio_are_found(spoiled):
    path = spoiled / "textgrid" / "time01.TextGrid"
    labels = read_labels(path)
    phones = labels.tier("phones").intervals
    longer = Tier("phones", (*phones[:-1], Interval(phones[-1].start_s, phones[-1].end_s + 0.3, "SIL")))
    write_textgrid(path, Labels((longer, labels.tier("words")), 0.0, labels.end_s + 0.3))
    sentence = only_problem(check_corpus(spoiled), "time01")
    assert sentence.startswith(f"labels end at {labels.end_s + 0.3:.3f} s")


def test_a_recording_without_labels_is_found(spoiled):
    (spoiled / "textgrid" / "time04.TextGrid").unlink()
    report = check_corpus(spoiled)
    assert "no labels" in only_problem(report, "time04")
    assert report["summary"]["labelled"] == 3


def test_a_missing_sound_is_found(spoiled):
    (spoiled / "wav" / "time04.wav").unlink()
    report = check_corpus(spoiled)
    sentence = only_problem(report, "time04")
    assert "no audio file" in sentence
    assert "time04" in sentence
    assert report["summary"]["labelled"] == 4


@pytest.mark.parametrize(
    ("file", "words"),
    [
        ("markers/time02.npz", ["time02.npz"]),
        ("wav/time02.wav", ["time02.wav"]),
        ("textgrid/time02.TextGrid", ["time02.TextGrid"]),
    ],
)
def test_a_file_that_is_none_is_named_and_the_others_are_checked(spoiled, file, words):
    (spoiled / file).write_bytes(b"this is no such file")
    report = check_corpus(spoiled)
    sentence = only_problem(report, "time02")
    assert all(w in sentence for w in words)
    assert report["summary"]["labelled"] == 3
    assert report["closure_offset_s"] is not None


def test_a_phone_outside_the_set_is_named_with_its_time(spoiled):
    path = spoiled / "textgrid" / "time02.TextGrid"
    labels = read_labels(path)
    rows = list(labels.tier("phones"))
    rows[3] = Interval(rows[3].start_s, rows[3].end_s, "QQ")
    write_textgrid(path, Labels((Tier("phones", tuple(rows)), labels.tier("words")), 0.0, labels.end_s))
    sentence = only_problem(check_corpus(spoiled), "time02")
    assert "'QQ'" in sentence
    assert f"{rows[3].start_s:.3f} s" in sentence


def test_another_frame_rate_is_found(spoiled, alter):
    alter("time02", lambda c: changed(c, positions_mm=c.positions_mm[::2], rate_hz=60.0))
    assert only_problem(check_corpus(spoiled), "time02") == "frame rate 60 Hz; the others have 120 Hz."


@pytest.mark.parametrize("odd", ["time01", "time03"])
def test_other_markers_are_found_in_the_odd_one_be_it_the_first(spoiled, alter, odd):
    alter(odd, lambda c: changed(c, names=("left_brow", *c.names[1:])))
    report = check_corpus(spoiled)
    assert "named otherwise" in only_problem(report, odd)
    assert report["closure_offset_s"] is not None


def test_a_recording_without_its_head_markers_does_not_spoil_the_others(spoiled, alter):
    def bare(capture):
        positions = np.array(capture.positions_mm)
        positions[:, 66:] = np.nan
        return changed(capture, positions_mm=positions)

    alter("time02", bare)
    report = check_corpus(spoiled)
    assert "reference markers" in only_problem(report, "time02")
    assert report["head_scale_sd"] < 0.003


def test_a_jig_that_slips_is_found_where_it_does(spoiled, alter):
    def slip(capture):
        positions = np.array(capture.positions_mm)
        positions[200:, 66:] += [2.0, 0.0, 0.0]
        return changed(capture, positions_mm=positions)

    alter("time02", slip)
    report = check_corpus(spoiled)
    found = re.fullmatch(
        r"the head markers slipped by (\d\.\d) mm at (\d\.\d\d) s\.", only_problem(report, "time02")
    )
    assert float(found[1]) == pytest.approx(2.0, abs=0.3)
    assert float(found[2]) == pytest.approx(200 / 120, abs=0.05)
    assert any("time02: the head markers slipped" in line for line in health_lines(report))


def test_motion_that_ends_before_the_speech_is_found(spoiled, alter):
    alter("time02", lambda c: changed(c, positions_mm=c.positions_mm[:150]))
    found = [p for p in problems(check_corpus(spoiled), "time02") if "missing in frames" not in p]
    assert len(found) == 2
    assert found[0].startswith("length mismatch")
    assert "1.242 s but its labels speak" in found[1]


def test_reference_markers_that_match_nothing_are_an_error_of_corpus_toml(spoiled):
    description = read_description(spoiled)
    write_description(dataclasses.replace(description, reference_markers="jig*"))
    with pytest.raises(CorpusError, match=r"jig.*corpus\.toml.*at least 3"):
        check_corpus(spoiled)


def test_an_empty_folder_is_an_error(tmp_path):
    with pytest.raises(CorpusError, match="init"):
        check_corpus(tmp_path)


def set_key(folder, **values):
    write_description(dataclasses.replace(read_description(folder), **values))


@pytest.fixture
def video(tmp_path):
    """A corpus as a camera of 24 frames/s sees it: every frame shows the middle of its interval."""
    folder = tmp_path / "video"
    for index, sentence in enumerate(covering_sentences(6, np.random.default_rng(0))):
        made = simulate_sentence(sentence, np.random.default_rng([6, index]), UNDISTURBED)
        fine = np.asarray(made.capture.positions_mm)
        n = (len(fine) - 3) // 5
        frames = 0.5 * (fine[2 : 2 + 5 * n : 5] + fine[3 : 3 + 5 * n : 5])
        zoom = 1.0 + 0.02 * np.sin(index)
        write_markers_npz(folder / "m" / f"s{index}.npz", Capture(zoom * frames, 24.0, made.capture.names))
        write_wav(folder / "w" / f"s{index}.wav", made.audio)
        labels = Labels((made.phones,), 0.0, made.phones.intervals[-1].end_s)
        write_textgrid(folder / "t" / f"s{index}.TextGrid", labels)
    init_corpus(
        folder,
        motion=str(folder / "m/{id}.npz"),
        audio=str(folder / "w/{id}.wav"),
        labels=str(folder / "t/{id}.TextGrid"),
        settings={"frame_time": "centre", "head_scale": "true"},
    )
    return folder


def test_a_right_frame_time_needs_no_advice_and_a_wrong_one_is_set_right(video):
    right = check_corpus(video)
    assert abs(right["closure_offset_s"]) < 0.5 / 24
    assert right["advice"] == []
    set_key(video, frame_time="start")
    wrong = check_corpus(video)
    assert wrong["closure_offset_s"] == pytest.approx(right["closure_offset_s"] + 0.5 / 24, abs=2e-3)
    assert wrong["advice"] == ['frame_time = "centre"']
    raw = read_corpus(video)
    assert cleaning_report(raw, clean_corpus(raw))["advice"] == wrong["advice"]


@pytest.mark.parametrize("late_s", [-0.06, 0.07])
def test_the_advised_audio_offset_brings_the_closures_to_the_bilabials(video, late_s):
    set_key(video, audio_offset_s=late_s)
    (line,) = check_corpus(video)["advice"]
    key, value = line.split(" = ")
    assert key == "audio_offset_s"
    assert float(value) == pytest.approx(0.0, abs=0.015)
    set_key(video, audio_offset_s=float(value))
    assert check_corpus(video)["advice"] == []


def test_a_head_that_changes_size_asks_for_scaling(video):
    assert 0.01 < check_corpus(video)["head_scale_sd"] < 0.03
    set_key(video, head_scale=False)
    assert check_corpus(video)["advice"] == ["head_scale = true"]


def test_lines_for_people_hold_the_counts_the_advice_and_every_problem_worst_first(spoiled, alter):
    (spoiled / "textgrid" / "time03.TextGrid").unlink()
    set_key(spoiled, audio_offset_s=0.05)
    report = check_corpus(spoiled)
    lines = health_lines(report)
    assert lines[0].startswith("simulated time sentences: 4 recordings")
    assert "3 labelled" in lines[0]
    assert any(line.startswith("Advice: set 'audio_offset_s = ") for line in lines)
    told = [line for line in lines if line.startswith("  ")]
    assert told[0].startswith("  time03: no labels")
    assert len(told) == sum(len(row["problems"]) for row in report["recordings"])
    offset = [line for line in lines if "Lips close best" in line]
    assert f"{1000 * report['closure_offset_s']:+.0f} ms" in offset[0]


def test_progress_is_told_and_may_stop_the_work(small_corpus):
    told = []
    check_corpus(small_corpus, lambda fraction, what: told.append((fraction, what)))
    fractions = [f for f, _ in told]
    assert fractions == sorted(fractions)
    assert "reading time03" in [what for _, what in told]

    def stop(fraction, what):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        check_corpus(small_corpus, stop)
