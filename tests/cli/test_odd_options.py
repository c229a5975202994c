"""Options and patterns that are wrong: the sentence names them as they were typed, and nothing is written."""

from __future__ import annotations

import json

import pytest

from corpus_tools.config import Config, config_with, write_config
from corpus_tools.io import find_recordings, read_description
from corpus_tools.pipeline import banned_pins
from tests.cli.answers import last_json, refused


@pytest.fixture
def one(simulated_corpus):
    return find_recordings(read_description(simulated_corpus))[0].id


@pytest.fixture
def elsewhere(tmp_path, monkeypatch):
    """Return an empty folder that one happens to be in."""
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    return tmp_path / "here"


PATHS = [
    ["synth", "C", "--utterance", "U", "--out", ""],
    ["synth", "C", "--utterance", "U", "--out", "  "],
    ["synth", "C", "--utterance", "U", "--out", "o", "--config", ""],
    ["synth", "", "--utterance", "U", "--out", "o"],
    ["bench", "--only", "resampling", "--out", ""],
    ["demo", ""],
    ["init", "", "--motion", "C/markers/{id}.npz"],
    ["check", ""],
    ["config", "check", ""],
]


@pytest.mark.parametrize("args", PATHS, ids=lambda args: " ".join(args)[:40])
def test_a_blank_path_does_not_stand_for_the_present_folder(tool, simulated_corpus, one, elsewhere, args):
    named = [a.replace("C", str(simulated_corpus), 1) if a[:1] == "C" else a for a in args]
    refused(tool(*[one if a == "U" else a for a in named]), "is empty")
    assert list(elsewhere.iterdir()) == []


@pytest.mark.parametrize(
    ("option", "value", "told"),
    [
        ("--fps", "0", "--fps 0: it should be greater than 0"),
        ("--fps", "nan", "--fps nan"),
        ("--fps", "inf", "--fps inf"),
        ("--fps", "1e9", "--fps 1e+09"),
        ("--seed", "-1", "--seed -1: it should be greater than or equal to 0"),
        ("--film-fps", "-3", "--film-fps -3"),
        ("--rate", "99", "--rate 99"),
        ("--method", "veterbi", "veterbi"),
    ],
)
def test_a_wrong_value_names_the_option_as_it_was_typed(
    tool, simulated_corpus, tmp_path, option, value, told
):
    answer = tool("synth", simulated_corpus, "--text", "now", option, value, "--out", tmp_path / "o")
    refused(answer, told)
    assert "_hz" not in answer[2]
    assert "output." not in answer[2]
    assert not (tmp_path / "o").exists()


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--export", ""], "--export '' names nothing"),
        (["--export", ",,"], "--export ',,' names nothing"),
        (["--film-fps", "20"], "--film-fps goes with --export mp4 or frames"),
        (["--film-fps", "20", "--export", "strip,csv"], "--film-fps goes with --export mp4 or frames"),
    ],
)
def test_options_that_would_do_nothing_are_refused(tool, simulated_corpus, one, tmp_path, options, told):
    args = ("synth", simulated_corpus, "--utterance", one, *options, "--out", tmp_path / "o")
    refused(tool(*args), told)
    assert not (tmp_path / "o").exists()


def test_a_wrong_value_of_a_file_names_the_file_and_the_key(tool, simulated_corpus, one, tmp_path):
    (tmp_path / "c.toml").write_text("[alignment]\nrate_hz = 0\n")
    args = ("synth", simulated_corpus, "--utterance", one, "--config", tmp_path / "c.toml")
    refused(tool(*args, "--out", tmp_path / "o"), "c.toml", "'alignment.rate_hz' is 0")


def test_a_folder_is_no_mesh(tool, simulated_corpus, one, tmp_path):
    args = ("synth", simulated_corpus, "--utterance", one, "--out", tmp_path / "o")
    refused(tool(*args, "--mesh", tmp_path), str(tmp_path), "is a folder")


INIT = ("--motion", "C/markers/{id}.npz", "--audio", "C/wav/{id}.wav", "--labels", "C/textgrid/{id}.TextGrid")


def init(tool, corpus, folder, *more, **other):
    args = list(INIT)
    for option, value in other.items():
        args[args.index(f"--{option}") + 1] = value
    return tool("init", folder, *[a.replace("C", str(corpus), 1) if a[0] == "C" else a for a in args], *more)


@pytest.mark.parametrize(
    ("other", "words"),
    [
        ({"motion": "C/markers/{id}.nix"}, ["--motion", "markers/{id}.nix"]),
        ({"audio": "C/wav/{id}.flac"}, ["--audio", "{id}.flac", "001.flac", "leave --audio out"]),
        ({"labels": "C/wav/{id}.TextGrid"}, ["--labels", "wav/time001.TextGrid", "14 recordings"]),
    ],
)
def test_a_pattern_that_matches_nothing_makes_no_corpus(tool, simulated_corpus, tmp_path, other, words):
    first = find_recordings(read_description(simulated_corpus))[0].id
    words = [w.replace("time001", first).replace("001.flac", f"{first}.flac") for w in words]
    refused(init(tool, simulated_corpus, tmp_path / "w", **other), *words)
    assert not (tmp_path / "w").exists()


@pytest.mark.parametrize(
    ("other", "words"),
    [
        ({"motion": "C/wav/{id}.wav"}, ["--motion finds", "suffix '.wav'", ".c3d"]),
        ({"audio": "C/markers/{id}.npz"}, ["--audio finds", "suffix '.npz'", ".wav"]),
        ({"labels": "C/wav/{id}.wav"}, ["--labels finds", "suffix '.wav'", ".textgrid"]),
    ],
)
def test_files_that_cannot_be_read_make_no_corpus(tool, simulated_corpus, tmp_path, other, words):
    refused(init(tool, simulated_corpus, tmp_path / "w", **other), *words)
    assert not (tmp_path / "w").exists()


def test_a_file_is_no_corpus_folder_and_no_topic_no_benchmark(tool, simulated_corpus, tmp_path):
    file = simulated_corpus / "corpus.toml"
    refused(tool("check", file), str(file), "is a file", "folder that holds corpus.toml")
    refused(tool("bench", "--only", " ,", "--out", tmp_path / "b.json"), "--only names no topic", "kalman")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("key", ["word_tier", "phone_tier"])
def test_a_tier_that_no_labels_have_is_refused_with_those_that_are_there(
    tool, simulated_corpus, tmp_path, key
):
    answer = init(tool, simulated_corpus, tmp_path / "w", "--set", f"{key}=nope")
    refused(answer, "'nope'", "'phones'", "'words'", key)
    assert not (tmp_path / "w").exists()
    code, _, _ = init(tool, simulated_corpus, tmp_path / "w", "--set", "word_tier=")
    assert code == 0
    file = tmp_path / "w/corpus.toml"
    file.write_text(file.read_text().replace('word_tier = ""', 'word_tier = "nope"'))
    for command in (["check"], ["units"]):
        refused(tool(*command, tmp_path / "w"), str(file), "word_tier = 'nope'", "'words'")


def test_recordings_without_a_sound_are_counted(tool, simulated_corpus, tmp_path):
    files = find_recordings(read_description(simulated_corpus))
    (tmp_path / files[0].audio.name).symlink_to(files[0].audio)
    code, out, _ = init(tool, simulated_corpus, tmp_path / "w", audio=f"{tmp_path}/{{id}}.wav")
    assert code == 0
    assert "14 recordings, 1 with audio." in out


def overridden(path, **overrides):
    data = {f"overrides__{key}": value for key, value in overrides.items()}
    write_config(path, config_with(Config(), **data))
    return path


def test_a_pin_against_a_ban_is_told_and_holds(tool, simulated_corpus, tmp_path):
    args = ("synth", simulated_corpus, "--text", "the time is now two", "--json")
    _, out, _ = tool(*args, "--out", tmp_path / "a")
    unit = last_json(out)["fragments"][0]
    recording, _, span = unit.rpartition(":")
    first, last = map(int, span.split("-"))
    pin = f"0-{last - first}={unit}"
    for ban in (unit, recording):
        config = overridden(tmp_path / "c.toml", pins=[pin], bans=[ban])
        code, out, err = tool(*args, "--config", config, "--out", tmp_path / "b")
        assert (code, err) == (0, "")
        assert last_json(out)["fragments"][0].startswith(f"{recording}:{first}-")
        assert last_json(out)["banned_pins"] == [[pin, ban]]
        assert out.count(f"The pin '{pin}' speaks what the ban '{ban}' forbids; the pin holds") == 1


@pytest.mark.parametrize(
    ("ban", "against"),
    [("a:2-4", True), ("a:0-3", True), ("a:0-2", False), ("a:4-9", False), ("b:2-4", False), ("a", True)],
)
def test_a_ban_is_against_a_pin_where_they_share_a_diphone(ban, against):
    config = Config.model_validate({"overrides": {"pins": ["0-2=a:2-4"], "bans": [ban]}})
    assert banned_pins(config) == ((("0-2=a:2-4", ban),) if against else ())


def test_when_everything_is_banned_the_advice_is_to_lift_a_ban(tool, simulated_corpus, tmp_path):
    names = [f.id for f in find_recordings(read_description(simulated_corpus))]
    config = overridden(tmp_path / "c.toml", bans=names)
    args = ("synth", simulated_corpus, "--out", tmp_path / "o", "--config", config)
    answer = tool(*args, "--text", "now")
    refused(answer, "those that could are banned; lift a ban")
    assert "record a sentence" not in answer[2]
    data = json.loads(json.dumps(Config().values())) | {"overrides": {"bans": names[1:]}}
    write_config(config, Config.model_validate(data))
    refused(tool(*args, "--utterance", names[0]), "those that could are banned; lift a ban")
