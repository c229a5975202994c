"""The readers on real recordings: GRID, praatio's samples, marker capture, and TextGrids nobody can read."""

from __future__ import annotations

import json
import wave

import numpy as np
import pytest

from corpus_tools.core import LabelError, PointTier, Tier
from corpus_tools.io import (
    find_recordings,
    init_corpus,
    load_capture,
    load_labels,
    read_audio,
    read_labels,
    read_markers,
    write_textgrid,
    write_wav,
)


@pytest.fixture(scope="module")
def grid(corpora, tmp_path_factory):
    source = corpora / "grid_s1"
    description = init_corpus(
        tmp_path_factory.mktemp("io") / "work",
        motion=str(source / "markers73" / "{id}.npz"),
        audio=str(source / "wav" / "{id}.wav"),
        labels=str(source / "textgrid" / "{id}.TextGrid"),
        settings={"frame_time": "centre"},
    )
    return description, find_recordings(description)


def test_all_of_grid_loads(grid, corpora):
    description, found = grid
    assert len(found) == 203
    names = tuple(json.loads((corpora / "grid_s1/markers73/markers.json").read_text())["names"])
    gaps = {}
    for files in found:
        capture = load_capture(description, files)
        assert capture.positions_mm.shape == (74 if files.id == "srbb4n" else 75, 73, 3), files.id
        assert capture.names == names
        assert (capture.rate_hz, capture.start_s) == (25.0, 0.02)
        assert capture.audio is not None
        assert (capture.audio.rate_hz, len(capture.audio.samples)) == (16000, 47648)
        missing = np.flatnonzero((np.asarray(capture.flags) == 0).any(axis=1))
        if len(missing):
            gaps[files.id] = missing.tolist()
    assert gaps == {"lgbf8n": list(range(12)), "pbwx1s": list(range(12))}


def test_all_grid_labels_load_whole_and_survive_a_round_trip(grid, tmp_path):
    description, found = grid
    for files in found:
        labels = load_labels(description, files)
        assert labels.names == ("phones", "words", "words_grid")
        for tier in labels.tiers:
            assert isinstance(tier, Tier)
            edges = [tier.intervals[0].start_s, *(i.end_s for i in tier)]
            assert (edges[0], edges[-1]) == (labels.start_s, labels.end_s)
            assert edges[:-1] == [i.start_s for i in tier]
        form = ("long", "short", "json")[len(labels.tiers[0]) % 3]
        path = tmp_path / ("a.json" if form == "json" else "a.TextGrid")
        write_textgrid(path, labels, form)
        assert read_labels(path) == labels, files.id
    blank = [i for i in labels.tier("phones") if not i.text]
    assert blank


def test_grid_sound_is_written_as_it_was_recorded(grid, tmp_path):
    _, found = grid
    for files in found[::20]:
        write_wav(tmp_path / "a.wav", read_audio(files.audio))
        with wave.open(str(files.audio)) as source, wave.open(str(tmp_path / "a.wav")) as copy:
            assert source.readframes(10**6) == copy.readframes(10**6)


def test_praatio_samples_read(corpora):
    folder = corpora / "praatio_samples"
    expected = {
        "bobby_phones": {"phone": 13},
        "bobby_words": {"word": 4},
        "mary": {"phone": 14, "word": 4},
        "damon_set_test": {"phons": 16, "syllable": 6, "words": 4},
    }
    for name, counts in expected.items():
        labels = read_labels(folder / f"{name}.TextGrid")
        for tier, count in counts.items():
            assert sum(bool(i.text) for i in labels.tier(tier)) == count, (name, tier)
            assert len(labels.tier(tier)) == count + 2, "silence before and after is kept"
    pitch = read_labels(folder / "mary.TextGrid").tiers[2]
    assert isinstance(pitch, PointTier)
    assert len(pitch.points) == 4
    assert read_audio(folder / "mary.wav").duration_s == pytest.approx(1.87, abs=0.01)


@pytest.mark.parametrize("name", ["msajc003", "msajc003_new"])
def test_textgrids_that_praat_cannot_read_either_are_refused(corpora, name):
    path = corpora / "emu_ae" / f"{name}.TextGrid"
    before = path.read_bytes()
    with pytest.raises(LabelError) as caught:
        read_labels(path)
    assert str(path) in str(caught.value)
    assert "TextGrid was expected" in str(caught.value)
    assert "\n" not in str(caught.value)
    assert path.read_bytes() == before


def test_marker_capture_reads(corpora):
    frames = {"Jaw": 1590, "Cheeks": 1499, "Eyebrows": 902, "Nose": 962}
    for take, n_frames in frames.items():
        capture = read_markers(corpora / "animface_mocap" / f"{take}MoCap.npz")
        assert capture.positions_mm.shape == (n_frames, 41, 3)
        assert capture.rate_hz == pytest.approx(60.0, abs=1e-9)
        assert np.isfinite(capture.positions_mm).all()
        assert {"ForeHead_M", "Chin", "Mouth_Up"} <= set(capture.names)


def test_a_real_textgrid_cut_in_half_is_refused(grid, tmp_path):
    _, found = grid
    for files in found[::40]:
        data = files.labels.read_bytes()
        (tmp_path / "half.TextGrid").write_bytes(data[: len(data) // 2])
        with pytest.raises(LabelError, match=r"half\.TextGrid"):
            read_labels(tmp_path / "half.TextGrid")
