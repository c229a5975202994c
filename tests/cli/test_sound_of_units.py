import json
import shutil

import numpy as np

from corpus_tools.io import find_recordings, read_audio, read_description, read_labels
from tests.cli.answers import last_json, refused


def test_units_speak_with_their_own_sound_in_their_own_times(tool, simulated_corpus, tmp_path):
    one = find_recordings(read_description(simulated_corpus))[0].id
    out = tmp_path / "out"
    code, told, err = tool(
        "synth", simulated_corpus, "--utterance", one, "--sound", "units", "--out", out, "--json"
    )
    assert code == 0, err
    assert last_json(told)["speech"]["engine"] == "units"
    phones = read_labels(out / "labels.TextGrid").tier("phones")
    sound, motion = read_audio(out / "speech.wav"), np.load(out / "motion.npz")
    end_s = phones.intervals[-1].end_s
    assert abs(sound.duration_s - end_s) < 0.01
    assert abs(motion["times_s"][-1] - end_s) < 0.01
    settings = json.loads((out / "manifest.json").read_text())["config"]
    assert (settings["speech"]["sound"], settings["selection"]["sound"]) == ("units", 1.0)
    recorded = read_audio(find_recordings(read_description(simulated_corpus))[0].audio)
    n = min(len(recorded.samples), len(sound.samples))
    assert np.abs(sound.samples[:n] - recorded.samples[:n]).max() > 0.05  # not the held-out recording's
    assert np.abs(sound.samples).max() > 0.05


def test_without_sound_it_says_so_and_writes_nothing(tool, simulated_corpus, tmp_path):
    one = find_recordings(read_description(simulated_corpus))[0].id
    mute = tmp_path / "mute"
    shutil.copytree(simulated_corpus, mute, ignore=shutil.ignore_patterns("*.wav"))
    answer = tool("synth", mute, "--utterance", one, "--sound", "units", "--out", tmp_path / "o")
    refused(answer, "no sound", "speech.sound")
    assert not (tmp_path / "o").exists()
    refused(
        tool("synth", mute, "--utterance", one, "--sound", "song", "--out", tmp_path / "o"),
        "--sound",
        "units",
    )
