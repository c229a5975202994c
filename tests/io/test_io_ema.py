"""Articulography in MATLAB files: sensors, sound and labels, and files that are something else."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.io import savemat

from corpus_tools.core import InputError
from corpus_tools.io import read_audio, read_labels, read_markers

LABELS = [("sp", (0.0, 0.1)), ("AA1", (0.1, 0.25))]


def channel(name, rate_hz, signal, labels=()):
    rows = np.array([(n, np.array(t)) for n, t in labels], dtype=[("LABEL", object), ("OFFS", object)])
    return name, float(rate_hz), signal, rows, rows[:1]


def saved(path, channels, key="take"):
    fields = [(n, object) for n in ("NAME", "SRATE", "SIGNAL", "PHONES", "WORDS")]
    savemat(path, {key: np.array(channels, dtype=fields)})
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
