"""``synth --text``: a sentence that nobody recorded, from the command line; and what it refuses."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys

import numpy as np
import pytest

from corpus_tools.config import Config, config_with, write_config
from corpus_tools.io import find_recordings, read_audio, read_description, read_labels
from corpus_tools.pipeline import open_corpus
from corpus_tools.speech import MOST_CHARACTERS
from corpus_tools.speech.engines import espeak
from tests.cli.answers import last_json, refused

SENTENCE = "the time is now five past one in the morning"


@pytest.fixture(scope="module")
def corpus(simulated_corpus, tmp_path_factory):
    """Return a small corpus, quick to open: the first six simulated recordings."""
    folder = tmp_path_factory.mktemp("small") / "c"
    for files in find_recordings(read_description(simulated_corpus))[:6]:
        for path in (files.motion, files.audio, files.labels):
            copy = folder / path.relative_to(simulated_corpus)
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, copy)
    shutil.copy(simulated_corpus / "corpus.toml", folder)
    return folder


@pytest.fixture(scope="module")
def neutral_mm(corpus):
    return open_corpus(corpus).neutral_mm


@pytest.fixture(scope="module")
def spoken(corpus, tmp_path_factory):
    """Return the folder of a spoken sentence and what the command printed."""
    folder = tmp_path_factory.mktemp("spoken") / "o"
    code = "from corpus_tools.cli.start import run; run()"
    args = ["synth", corpus, "--text", SENTENCE, "--out", folder, "--json"]
    run = subprocess.run(
        [sys.executable, "-c", code, *map(str, args)], capture_output=True, text=True, check=False
    )
    assert (run.returncode, run.stderr) == (0, "")
    return folder, run.stdout


def test_a_text_gives_the_whole_folder(spoken):
    folder, out = spoken
    manifest = json.loads((folder / "manifest.json").read_text())
    assert manifest["request"] == {"text": SENTENCE, "language": "en", "held_out": []}
    speech = manifest["speech"]
    assert speech["engine"] == "espeak"
    assert speech["text"] == SENTENCE
    assert speech["silent"] is False
    assert speech["version"].startswith("eSpeak NG 1.")
    assert "espeakng-loader" in speech["version"]
    assert last_json(out)["speech"] == speech
    spoken = {"engine": "espeak", "language": "", "sound": "voice", "voice": "", "rate": 1.0}
    assert manifest["config"]["speech"] == spoken
    labels, sound = read_labels(folder / "labels.TextGrid"), read_audio(folder / "speech.wav")
    assert [w.text for w in labels.tier("words") if w.text] == SENTENCE.split()
    assert sound.rate_hz == 22050
    motion = np.load(folder / "motion.npz")
    assert motion["times_s"][-1] == pytest.approx(sound.duration_s, abs=1 / 120)
    assert motion["times_s"][-1] == pytest.approx(labels.end_s, abs=1 / 120)


def test_motion_starts_and_ends_at_rest(spoken, neutral_mm):
    folder, _ = spoken
    motion, mesh = np.load(folder / "motion.npz"), np.load(folder / "mesh.npz")
    for frame in (0, -1):
        np.testing.assert_allclose(motion["markers_mm"][frame], neutral_mm, atol=1e-6)
        np.testing.assert_allclose(mesh["vertices_mm"][frame], mesh["rest_mm"], atol=1e-3)
    speed = np.abs(np.diff(motion["markers_mm"], axis=0)).max(axis=(1, 2)) * 120
    assert max(speed[0], speed[-1]) < 0.05 * speed.max()


def test_equal_texts_give_equal_bytes_and_a_config_replays_them(tool, corpus, tmp_path):
    base = ("synth", corpus, "--text", "two past one")
    options = ("--voice", "f2", "--rate", "1.3", "--lang", "en-gb", "--engine", "espeak")
    settings = {"speech__voice": "f2", "speech__rate": 1.3, "speech__language": "en-gb"}
    write_config(tmp_path / "c.toml", config_with(Config(), **settings))
    assert tool(*base, *options, "--out", tmp_path / "a")[0] == 0
    assert tool(*base, "--config", tmp_path / "c.toml", "--out", tmp_path / "b")[0] == 0
    for name in {p.name for p in (tmp_path / "a").iterdir()} - {"run.json"}:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes(), name
    manifest = json.loads((tmp_path / "a/manifest.json").read_text())
    assert manifest["config"]["speech"] == {
        "engine": "espeak",
        "language": "en-gb",
        "voice": "f2",
        "rate": 1.3,
        "sound": "voice",
    }


def test_diphones_that_are_missing_are_told_with_what_stood_in(tool, corpus, tmp_path):
    answer = tool("synth", corpus, "--text", "boys enjoy joyful noise", "--out", tmp_path / "o", "--json")
    code, out, err = answer
    assert (code, err) == (0, "")
    missing = last_json(out)["missing_diphones"]
    assert {"B-OY", "JH-OY"} <= {m["diphone"] for m in missing}
    for row in missing:
        assert row["diphone"] != row["stood_in"]
        assert f"▲ No usable unit has {row['diphone']}: {row['stood_in']} stood in" in out
        assert row["unit"] in last_json(out)["fragments"]
    first = out.index("▲")
    assert out[first:].startswith(f"▲ {len(missing)} of ")  # most of them: how many is said first
    assert out.count("▲") == 1 + len({(m["diphone"], m["stood_in"]) for m in missing})


def test_without_backoff_every_missing_diphone_is_named_and_nothing_written(tool, corpus, tmp_path):
    write_config(tmp_path / "c.toml", config_with(Config(), selection__allow_backoff=False))
    answer = tool(
        *("synth", corpus, "--text", "boys enjoy noise"),
        *("--config", tmp_path / "c.toml", "--out", tmp_path / "o"),
    )
    refused(answer, "No unit", "B-OY", "N-OY")
    assert not (tmp_path / "o").exists()


def test_labels_without_sound_play_silence_say_so_and_rest_at_their_ends(tool, corpus, neutral_mm, tmp_path):
    files = find_recordings(read_description(corpus))[0]
    base = ("synth", corpus, "--labels", files.labels, "--json")
    code, out, err = tool(*base, "--out", tmp_path / "a")
    assert (code, err) == (0, "")
    assert "▲ There is no sound: speech.wav is silence" in out
    assert "--audio" in out
    assert last_json(out)["speech"]["silent"] is True
    assert not read_audio(tmp_path / "a/speech.wav").samples.any()
    assert json.loads((tmp_path / "a/manifest.json").read_text())["speech"]["silent"] is True
    with np.load(tmp_path / "a/motion.npz") as motion:
        for frame in (0, -1):
            np.testing.assert_allclose(motion["markers_mm"][frame], neutral_mm, atol=1e-6)


def test_a_recording_rests_at_its_ends_too(tool, corpus, neutral_mm, tmp_path):
    name = find_recordings(read_description(corpus))[0].id
    code, out, _ = tool("synth", corpus, "--utterance", name, "--out", tmp_path / "o", "--json")
    assert code == 0
    assert last_json(out)["speech"] == {
        "engine": "recorded",
        "version": "the file's own times",
        "text": last_json(out)["speech"]["text"],
        "silent": False,
    }
    with np.load(tmp_path / "o/motion.npz") as motion:
        for frame in (0, -1):
            np.testing.assert_allclose(motion["markers_mm"][frame], neutral_mm, atol=1e-6)


LABELS = ("--labels", "L.TextGrid")


@pytest.mark.parametrize(
    ("args", "words"),
    [
        ((), ("--text", "--utterance", "--labels")),
        (("--text", "now", "--utterance", "time01"), ("one of them",)),
        (("--text", "now", *LABELS), ("one of them",)),
        (("--text", "now", "--utterance", "time01", *LABELS), ("one of them",)),
        (("--text", "now", "--audio", "a.wav"), ("--audio goes with --labels",)),
        (("--utterance", "time01", "--voice", "f2"), ("--voice goes with --text",)),
        ((*LABELS, "--lang", "en"), ("--lang goes with --text",)),
        ((*LABELS, "--rate", "1"), ("--rate goes with --text",)),
        (("--utterance", "time01", "--engine", "espeak"), ("--engine goes with --text",)),
        (("--text", "now", "--engine", "espaek"), ("espaek", "did you mean 'espeak'")),
        (("--text", "now", "--engine", "labels"), ("speaks labels, not text", "espeak")),
        (("--text", "now", "--voice", "f22"), ("f22", "did you mean 'f2'")),
        (("--text", "now", "--lang", "xx"), ("'xx'", "phones of en")),
        (("--text", "hola", "--lang", "es-419"), ("es-419", "arpabet", "phones of en")),
        (("--text", "now", "--rate", "0"), ("--rate 0",)),
        (("--text", "now", "--rate", "nan"), ("--rate nan",)),
        (("--text", "now", "--rate", "99"), ("--rate 99", "2.5")),
        (("--text", ""), ("empty",)),
        (("--text", "..."), ("'...'", "no word")),
        (("--text", " ?! -- "), ("no word",)),
        (("--text", "bin\x01blue"), ("Character 4", "U+0001")),
        (("--text", "bin \x1b[31m"), ("U+001B",)),
        (("--text", os.fsdecode(b"bin \xff")), ("Character 5", "UTF-8")),
        (("--text", "now " * 25_000), (str(MOST_CHARACTERS), "100000")),
        (("--text", "на zeit"), ("U+043D",)),
        (("--text", "now ☕"), ("U+2615",)),
    ],
    ids=lambda value: " ".join(value)[:24].encode("ascii", "backslashreplace").decode(),
)
def test_what_cannot_be_spoken_costs_one_sentence(tool, corpus, tmp_path, args, words):
    refused(tool("synth", corpus, *args, "--out", tmp_path / "o"), *words)
    assert not (tmp_path / "o").exists()


def test_a_text_that_fills_the_memory_is_refused_before_the_work(tool, corpus, tmp_path):
    text = "the time is now one " * 30
    answer = tool("synth", corpus, "--text", text, "--rate", "0.5", "--fps", "1000", "--out", tmp_path / "o")
    refused(answer, "GB", "--fps")
    assert not (tmp_path / "o").exists()


def test_signs_and_phoneme_codes_are_text(tool, corpus, tmp_path):
    text = 'the time is now [[one]] & "two" $(touch x) `id`; \' \\ '
    code, _, err = tool("synth", corpus, "--text", text, "--out", tmp_path / "o")
    assert (code, err) == (0, "")
    words = [w.text for w in read_labels(tmp_path / "o/labels.TextGrid").tier("words") if w.text]
    assert words == "the time is now one and two dollars touch x id".split()  # noqa: SIM905


def test_a_voice_that_always_dies_costs_one_sentence(tool, corpus, tmp_path, monkeypatch):
    dying = espeak.Children((sys.executable, "-I", "-c", "import os; os.abort()"), "the voice eSpeak NG")
    monkeypatch.setattr(espeak, "_children", [dying])
    refused(tool("synth", corpus, "--text", "now", "--out", tmp_path / "o"), "ended twice")
    assert not (tmp_path / "o").exists()


def test_without_the_extra_a_text_says_at_once_what_to_install(tool, corpus, tmp_path, monkeypatch):
    monkeypatch.setattr(espeak, "_children", [])
    monkeypatch.setitem(sys.modules, "espeakng_loader", None)
    refused(tool("synth", corpus, "--text", "now", "--out", tmp_path / "o"), "pip install", "[voice]")


def test_a_corpus_in_another_language_says_so(tool, corpus, tmp_path):
    shutil.copytree(corpus, tmp_path / "c")
    toml = tmp_path / "c/corpus.toml"
    toml.write_text(toml.read_text().replace('language = "en"', 'language = "es-MX"'))
    assert 'language = "es-MX"' in toml.read_text()
    refused(tool("synth", tmp_path / "c", "--text", "now", "--out", tmp_path / "o"), "es-MX", "arpabet")
