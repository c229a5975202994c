"""The readers on real recordings: GRID, praatio's samples, marker capture, and TextGrids nobody can read."""

from __future__ import annotations

import json
import wave

import ezc3d
import numpy as np
import pytest

from corpus_tools.core import InputError, LabelError, MotionError, PointTier, Tier
from corpus_tools.io import (
    MOTION_READERS,
    find_recordings,
    init_corpus,
    load_capture,
    load_labels,
    read_audio,
    read_labels,
    read_markers,
    reading_notes,
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


@pytest.mark.parametrize(
    ("name", "line"), [("msajc003", 'File type= "ooTextFile"'), ("msajc003_new", "levels? <exists>")]
)
def test_textgrids_that_praat_cannot_read_either_are_refused(corpora, name, line):
    path = corpora / "emu_ae" / f"{name}.TextGrid"
    before = path.read_bytes()
    with pytest.raises(LabelError) as caught:
        read_labels(path)
    assert str(path) in str(caught.value)
    assert "TextGrid was expected" in str(caught.value)
    assert f"the line '{line}'" in str(caught.value)
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


def refused(path, **given_by_caller):
    before = path.read_bytes()
    with pytest.raises(MotionError) as caught:
        read_markers(path, **given_by_caller)
    message = str(caught.value)
    assert str(path) in message
    assert "\n" not in message
    assert path.read_bytes() == before
    return message


def test_c3d_with_gaps_reads_as_ezc3d_reads_it(corpora):
    path = corpora / "pyomeca_c3d" / "markers_analogs.c3d"
    capture = read_markers(path)
    oracle = ezc3d.c3d(str(path))
    np.testing.assert_array_equal(capture.positions_mm, oracle["data"]["points"][:3].transpose(2, 1, 0))
    assert list(capture.names) == oracle["parameters"]["POINT"]["LABELS"]["value"]
    assert capture.positions_mm.shape == (580, 51, 3)
    assert capture.rate_hz == 100.0
    missing = np.isnan(capture.positions_mm).any(axis=2)
    assert missing.mean() == pytest.approx(0.0103, abs=5e-5)
    assert missing.any(axis=0).sum() == 13
    assert sum(n.startswith("boite:") for n in capture.names) == 8
    assert not reading_notes(capture)


def test_a_vicon_export_holds_the_frames_of_its_c3d(corpora):
    exported = read_markers(corpora / "pyomeca_c3d" / "markers.csv")
    capture = read_markers(corpora / "pyomeca_c3d" / "markers_analogs.c3d")
    assert (exported.names, exported.rate_hz) == (capture.names, capture.rate_hz)
    np.testing.assert_allclose(exported.positions_mm, capture.positions_mm, atol=0.006)


def test_tables_of_marker_capture_hold_what_the_archives_hold(corpora):
    for take in ("Jaw", "Cheeks", "Eyebrows", "Nose"):
        table = read_markers(corpora / "animface_mocap" / f"{take}MoCap.csv", units="mm")
        archive = read_markers(corpora / "animface_mocap" / f"{take}MoCap.npz")
        assert table.names == archive.names
        assert table.rate_hz == 60.0
        assert not reading_notes(table)
        np.testing.assert_allclose(table.positions_mm, archive.positions_mm, atol=6e-4)


def test_a_trc_whose_header_lies_is_told_what_it_says_and_holds(corpora):
    message = refused(corpora / "pyomeca_c3d" / "markers.trc")
    assert "commas" in message
    assert "652 frames and 93 rows" in message


def test_tracked_faces_need_a_rate_and_are_read_by_name(corpora):
    paths = [corpora / "blenderface" / f"Subject_0{i}.csv" for i in (1, 2)]
    assert all("rate_hz" in refused(path) for path in paths)
    first, second = (read_markers(path, rate_hz=25.0, units="250 mm") for path in paths)
    assert (first.n_frames, second.n_frames) == (1714, 1692)
    assert first.names != second.names
    assert set(first.names) == set(second.names)
    for capture, share in ((first, 0.504), (second, 0.467)):
        blank = np.isnan(capture.positions_mm).all(axis=(1, 2))
        assert blank.mean() == pytest.approx(share, abs=6e-4)
    rows = paths[1].read_text().splitlines()
    header, row = rows[0].split(";"), rows[1000].split(";")
    column = second.names.index("CL7")
    expected = [250 * float(row[header.index(f"CL7_{a}")]) for a in "xyz"]
    np.testing.assert_allclose(second.positions_mm[999, column], expected)
    guessed = read_markers(paths[0], rate_hz=25.0)
    assert any("no face" in note for note in reading_notes(guessed))


def test_blendshape_coefficients_are_no_marker_positions(corpora):
    for name in ("S88-001", "apfel", "facial"):
        assert "blendshape" in refused(corpora / "livelink_csv" / f"{name}.csv")


def test_articulography_gives_sensors_sound_and_labels(corpora):
    path = corpora / "haskins_ieee_ema" / "F01_B01_S01_R01_N.mat"
    capture, audio, labels = read_markers(path), read_audio(path), read_labels(path)
    assert capture.names == ("TR", "TB", "TT", "UL", "LL", "ML", "JAW", "JAWL")
    assert (capture.n_frames, capture.rate_hz) == (262, 100.0)
    assert (len(audio.samples), audio.rate_hz) == (114881, 44100)
    phones = labels.tier("phones")
    assert (len(phones), len(labels.tier("words"))) == (29, 10)
    lips = np.linalg.norm(capture.positions_mm[:, 3] - capture.positions_mm[:, 4], axis=1)
    assert np.median(lips) == pytest.approx(27.0, abs=0.05)
    for phone, least_mm in (("B", 17.7), ("M", 18.3), ("P", 19.6)):
        span = next(i for i in phones if i.text == phone)
        inside = (capture.times_s >= span.start_s) & (capture.times_s <= span.end_s)
        assert lips[inside].min() == pytest.approx(least_mm, abs=0.1)


def test_every_file_of_the_recordings_is_read_or_refused_in_one_sentence(corpora):
    motion = [p for p in sorted(corpora.rglob("*")) if p.suffix.lower() in MOTION_READERS]
    assert len(motion) >= 203 + 17
    read = {}
    for path in [p for p in motion if "grid_s1" not in p.parts]:
        try:
            read[path.name] = read_markers(path, rate_hz=None).n_frames
        except InputError as error:
            assert str(path) in str(error)  # noqa: PT017  either outcome is right
            assert "\n" not in str(error)  # noqa: PT017
            read[path.name] = 0
    assert sum(n > 0 for n in read.values()) == 8 + 2 + 1
    assert sum(n == 0 for n in read.values()) == 1 + 2 + 3
