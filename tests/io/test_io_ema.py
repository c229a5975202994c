"""Articulography in MATLAB files: sensors, sound and labels, and files that are something else."""

from __future__ import annotations

import struct
import tracemalloc
import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.io import savemat

from corpus_tools.core import InputError
from corpus_tools.io import read_audio, read_labels, read_markers
from corpus_tools.io.mat_layout import MatLayoutError, struct_names

LABELS = [("sp", (0.0, 0.1)), ("AA1", (0.1, 0.25))]


def channel(name, rate_hz, signal, labels=()):
    rows = np.array([(n, np.array(t)) for n, t in labels], dtype=[("LABEL", object), ("OFFS", object)])
    return name, float(rate_hz), signal, rows, rows[:1]


def struct_array(channels):
    return np.array(channels, dtype=[(n, object) for n in ("NAME", "SRATE", "SIGNAL", "PHONES", "WORDS")])


def saved(path, channels, key="take"):
    savemat(path, {key: struct_array(channels)})
    return path


def channels():
    rng = np.random.default_rng(0)
    sound = np.sin(np.arange(4000) / 10)[:, None]
    return [
        channel("AUDIO", 16000, sound, LABELS),
        channel("UL", 100, rng.normal(size=(25, 6))),
        channel("JAW", 100, rng.normal(size=(25, 6))),
    ]


def refusal(read, path):
    with pytest.raises(InputError) as caught:
        read(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_sensors_sound_and_labels_come_from_one_file(tmp_path):
    held = channels()
    path = saved(tmp_path / "a.mat", held)
    capture = read_markers(path)
    assert (capture.names, capture.rate_hz) == (("UL", "JAW"), 100.0)
    np.testing.assert_allclose(capture.positions_mm[:, 1], held[2][2][:, :3])
    np.testing.assert_allclose(read_markers(path, units="cm").positions_mm[:, 1], 10 * held[2][2][:, :3])
    audio = read_audio(path)
    assert audio.rate_hz == 16000
    np.testing.assert_allclose(audio.samples, held[0][2][:, 0], atol=1e-6)
    labels = read_labels(path)
    assert [(i.start_s, i.end_s, i.text) for i in labels.tier("phones")] == [(*t, n) for n, t in LABELS]
    assert labels.names == ("phones", "words")
    assert labels.end_s == 0.25


def test_sound_that_is_too_loud_is_scaled(tmp_path):
    held = channels()
    held[0] = channel("AUDIO", 16000, np.array([[100.0], [-200.0]]))
    np.testing.assert_allclose(read_audio(saved(tmp_path / "a.mat", held)).samples, [0.5, -1.0])


WRONG = {
    "other rates": (1, channel("UL", 200, np.zeros((25, 6))), read_markers, "'JAW' has 25 samples at 100 Hz"),
    "other lengths": (1, channel("UL", 100, np.zeros((24, 6))), read_markers, "24"),
    "no rate": (1, channel("UL", np.nan, np.zeros((25, 6))), read_markers, "one clock"),
    "words for numbers": (1, channel("UL", 100, "none"), read_markers, "no numbers"),
    "no sound": (0, channel("FORCE", 100, np.zeros((25, 1))), read_audio, "no channel AUDIO"),
    "sound that is none": (0, channel("AUDIO", 100, np.full((25, 1), np.nan)), read_audio, "no numbers"),
    "no labels": (0, channel("AUDIO", 100, np.zeros((25, 1))), read_labels, "neither PHONES nor WORDS"),
    "labels without end": (
        0,
        channel("AUDIO", 100, np.zeros((25, 1)), [("a", (1.0, 1.0))]),
        read_labels,
        "'a'",
    ),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_wrong_costs_one_sentence(tmp_path, what):
    index, wrong, read, words = WRONG[what]
    held = channels()
    held[index] = wrong
    assert words in refusal(read, saved(tmp_path / "a.mat", held))


def test_other_matlab_files_are_refused_with_what_they_hold(tmp_path):
    savemat(tmp_path / "a.mat", {"xyz": np.zeros((3, 3)), "fs": 100})
    for read in (read_markers, read_audio, read_labels):
        assert "holds xyz, fs" in refusal(read, tmp_path / "a.mat")
    savemat(tmp_path / "b.mat", {"x": np.zeros(3)}, format="4")
    assert "version 5" in refusal(read_markers, tmp_path / "b.mat")
    saved(tmp_path / "c.mat", channels()[:1])
    assert "no channel with three coordinates" in refusal(read_markers, tmp_path / "c.mat")


ENDED_THE_PROCESS = {  # place -> byte that stands there instead; each made scipy alone end by SIGSEGV
    "a class that is none": {281: 167, 1558: 14, 1964: 8},
    "another kind of number": {377: 15, 556: 6, 1251: 255, 1414: 5},
    "longer than what holds it": {260: 14, 2057: 8},
    "a part of no known kind": {345: 255},
}


@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("what", ENDED_THE_PROCESS)
def test_what_would_end_the_process_costs_one_sentence(tmp_path, what, packed):
    path = saved(tmp_path / "a.mat", channels())
    bad = bytearray(path.read_bytes())
    for place, value in ENDED_THE_PROCESS[what].items():
        bad[place] = value
    if packed:
        body = zlib.compress(bytes(bad[128:]))
        bad[128:] = struct.pack("<II", 15, len(body)) + body
    path.write_bytes(bad)
    for read in (read_markers, read_audio, read_labels):
        assert "cannot be read as a MATLAB file" in refusal(read, path)


def test_packed_files_are_read_and_other_variables_do_not_matter(tmp_path):
    held = {"take": struct_array(channels()), "notes": "by hand", "x": np.zeros((2, 2)), "c": {"a": 1.0}}
    savemat(tmp_path / "a.mat", held, do_compression=True)
    plain = read_markers(saved(tmp_path / "b.mat", channels()))
    np.testing.assert_array_equal(read_markers(tmp_path / "a.mat").positions_mm, plain.positions_mm)


def test_what_unpacks_to_too_much_is_refused_and_not_unpacked():
    bomb = zlib.compress(struct.pack("<II", 14, 50_000_000) + bytes(50_000_000))
    data = bytes(126) + b"IM" + struct.pack("<II", 15, len(bomb)) + bomb
    tracemalloc.start()
    with pytest.raises(MatLayoutError, match="more than is unpacked at once"):
        struct_names(data, most_bytes=1_000_000)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 5_000_000


def test_a_packed_variable_that_breaks_off_and_a_crowd_of_arrays_are_refused(tmp_path, monkeypatch):
    data = saved(tmp_path / "a.mat", channels()).read_bytes()
    body = zlib.compress(data[128:])[:-5]
    with pytest.raises(MatLayoutError, match="cut short"):
        struct_names(data[:128] + struct.pack("<II", 15, len(body)) + body)
    n_fields = 3 * 5
    monkeypatch.setattr("corpus_tools.io.mat_layout._MOST_ARRAYS", n_fields)
    assert struct_names(data) == {"take": True}
    monkeypatch.setattr("corpus_tools.io.mat_layout._MOST_ARRAYS", n_fields - 1)
    with pytest.raises(MatLayoutError, match="15 arrays"):
        struct_names(data)


@pytest.mark.parametrize("packed", [False, True])
def test_numbers_that_take_more_than_they_are_written_in_are_counted(tmp_path, packed):
    held = [*channels()[:1], channel("UL", 100, np.zeros((1000, 6), np.int8))]
    savemat(tmp_path / "a.mat", {"take": struct_array(held)}, do_compression=packed)
    data = (tmp_path / "a.mat").read_bytes()
    n_numbers = 4000 + 6000
    assert struct_names(data, most_bytes=8 * n_numbers + 4000) == {"take": True}
    with pytest.raises(MatLayoutError, match="numbers take more"):
        struct_names(data, most_bytes=8 * n_numbers - 1)


@given(data=st.data())
def test_damage_gives_motion_or_a_sentence(tmp_path_factory, data):
    path = saved(tmp_path_factory.mktemp("mat") / "a.mat", channels())
    bad = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(0, 4))):
        bad[data.draw(st.integers(0, min(len(bad), 3000) - 1))] = data.draw(st.integers(0, 255))
    if data.draw(st.booleans()):
        del bad[data.draw(st.integers(1, len(bad) - 1)) :]
    path.write_bytes(bad)
    for read in (read_markers, read_audio, read_labels):
        try:
            read(path)
        except InputError as error:
            assert str(path) in str(error)  # noqa: PT017  either outcome is right
