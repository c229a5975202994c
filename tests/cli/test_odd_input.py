"""Input that is odd, damaged or wrong: good oddities work, the rest costs one sentence and leaves nothing."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from corpus_tools.core import Audio, MeshError, OutputError, atomic_folder
from corpus_tools.core.files import _move_all
from corpus_tools.io import find_recordings, read_description, read_labels, write_wav
from corpus_tools.mesh import bundled_head, write_mesh
from tests.cli.answers import START, last_json, refused

LONG = "x" * 5000


@pytest.fixture
def corpus(simulated_corpus, tmp_path):
    """Return a corpus of our own to damage: the first four simulated recordings."""
    description = read_description(simulated_corpus)
    for files in find_recordings(description)[:4]:
        for path in (files.motion, files.audio, files.labels):
            copy = tmp_path / "c" / path.relative_to(simulated_corpus)
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, copy)
    shutil.copy(simulated_corpus / "corpus.toml", tmp_path / "c")
    return tmp_path / "c"


def files_of(corpus):
    return find_recordings(read_description(corpus))


def change(path, **arrays):
    with np.load(path) as data:
        np.savez(path, **({k: data[k] for k in data.files} | arrays))


def positions(path):
    with np.load(path) as data:
        return data["xyz"].copy()


def textgrid(path, rows):
    end = rows[-1][1]
    lines = ['File type = "ooTextFile"', 'Object class = "TextGrid"', "", 0, end, "<exists>", 1]
    lines += ['"IntervalTier"', '"phones"', 0, end, len(rows)]
    for start, stop, text in rows:
        lines += [start, stop, f'"{text}"']
    path.write_text("\n".join(map(str, lines)) + "\n")
    return path


@pytest.mark.parametrize(
    ("words", "args"),
    [
        (["--mehtod", "--help"], ["synth", "C", "--mehtod", "greedy"]),
        (["sinth", "synth"], ["sinth", "C"]),
        (["--seed"], ["synth", "C", "--utterance", "a", "--seed", "x"]),
        (["xxx"], ["synth", LONG, "--utterance", "a", "--out", "OUT"]),
        (["xxx", "too long"], ["synth", "C", "--utterance", "a", "--out", f"OUT/{LONG}"]),
        (["xxx"], ["synth", "C", "--utterance", "a", "--out", "OUT", "--mesh", LONG]),
        (["xxx"], ["synth", "C", "--utterance", "a", "--out", "OUT", "--mesh", LONG + ".npz"]),
        (["xxx"], ["synth", "C", "--labels", LONG + ".TextGrid", "--out", "OUT"]),
        (["xxx"], ["init", f"OUT/{LONG}", "--motion", "C/markers/{id}.npz"]),
        (["xxx"], ["demo", f"OUT/{LONG}"]),
        (
            ["klingon", "arpabet"],
            ["init", "OUT", "--motion", "C/markers/{id}.npz", "--set", "phones=klingon"],
        ),
        (
            ["reference_markers"],
            ["init", "OUT", "--motion", "C/markers/{id}.npz", "--set", "reference_markers="],
        ),
    ],
    ids=lambda value: value[0][:12] if isinstance(value, list) else None,
)
def test_wrong_words_on_the_line_cost_one_sentence(tool, corpus, tmp_path, words, args):
    out = tmp_path / "out"
    refused(
        tool(
            *[
                a.replace("OUT", str(out))
                if "OUT" in a
                else a.replace("C", str(corpus), 1)
                if a == "C" or a.startswith("C/")
                else a
                for a in args
            ]
        ),
        *words,
    )
    assert not out.exists()


@pytest.mark.parametrize("fps", ["0.001", "0.5", "5"])
def test_too_few_frames_per_second_are_refused(tool, corpus, tmp_path, fps):
    name = files_of(corpus)[0].id
    refused(tool("synth", corpus, "--utterance", name, "--fps", fps, "--out", tmp_path / "o"), "--fps", "10")
    assert not (tmp_path / "o").exists()


@pytest.mark.parametrize(("end_s", "word"), [(1e9, "seconds"), (3000.0, "--fps")])
def test_labels_that_would_fill_the_memory_are_refused_at_once(tool, corpus, tmp_path, end_s, word):
    path = textgrid(tmp_path / "long.TextGrid", [(0, 1, "N"), (1, end_s, "AY")])
    start = time.perf_counter()
    refused(tool("synth", corpus, "--labels", path, "--out", tmp_path / "o"), "long", word)
    assert time.perf_counter() - start < 10
    assert not (tmp_path / "o").exists()


def test_one_damaged_recording_is_left_out_and_named(tool, corpus, tmp_path):
    first, *others = files_of(corpus)
    whole = positions(first.motion)
    damages = (
        {"xyz": whole * 0},
        {"xyz": whole.astype(np.float64) * 1e300},
        {"xyz": whole, "fps": np.float64(1e-9)},
    )
    args = ("synth", corpus, "--utterance", others[0].id, "--out", tmp_path / "o", "--json")
    for damage in damages:
        change(first.motion, **({"fps": np.float64(120.0)} | damage))
        code, out, err = tool(*args)
        assert (code, err) == (0, "")
        assert list(last_json(out)["left_out"]) == [first.id]
        assert f"1 recording was left out ({first.id})" in out
        code, out, _ = tool("check", corpus, "--json")
        row = next(r for r in last_json(out)["recordings"] if r["id"] == first.id)
        assert code == 0
        assert row["problems"]


@pytest.mark.parametrize("length_s", [0.01, 60.0])
def test_sound_of_another_recording_is_told_and_lengthens_no_motion(tool, corpus, tmp_path, length_s):
    first = files_of(corpus)[0]
    write_wav(first.audio, Audio(np.zeros(round(16000 * length_s), np.float32), 16000))
    end_s = read_labels(first.labels).end_s
    code, out, err = tool("synth", corpus, "--utterance", first.id, "--out", tmp_path / "o", "--json")
    assert (code, err) == (0, "")
    sentence = next(line for line in out.splitlines() if line.startswith("▲ The sound lasts"))
    assert f"{length_s:.2f} s" in sentence
    assert last_json(out)["sound_problem"] in sentence
    with np.load(tmp_path / "o/motion.npz") as made:
        assert abs(made["times_s"][-1] - end_s) < 0.3


def test_a_missing_unit_says_that_recordings_were_left_out(tool, corpus, tmp_path):
    first, *others = files_of(corpus)
    for files in others:
        files.audio.write_bytes(b"no sound")
    answer = tool("synth", corpus, "--utterance", first.id, "--out", tmp_path / "o")
    refused(answer, "No unit", "are held out", "3 recordings were left out", "corpus-tools check")


def test_a_marker_that_no_recording_shows_is_left_out(tool, corpus, tmp_path):
    for files in files_of(corpus):
        xyz = positions(files.motion)
        xyz[:, 3] = np.nan
        change(files.motion, xyz=xyz)
    code, _, err = tool("synth", corpus, "--utterance", files.id, "--out", tmp_path / "o")
    assert (code, err) == (0, "")
    with np.load(files.motion) as given, np.load(tmp_path / "o/motion.npz") as made:
        assert set(given["names"]) - set(made["names"]) == {
            given["names"][3],
            *(n for n in given["names"] if n.startswith("head")),
        }
        assert np.isfinite(made["markers_mm"]).all()
    _, out, _ = tool("check", corpus)
    assert f"no frame shows {'brow3'}." in out


def test_a_corpus_of_head_markers_alone_is_refused(tool, corpus, tmp_path):
    for files in files_of(corpus):
        with np.load(files.motion) as data:
            keep = [i for i, n in enumerate(data["names"]) if n.startswith("head")]
            arrays = {"xyz": data["xyz"][:, keep], "names": data["names"][keep]}
        change(files.motion, **arrays)
    refused(tool("synth", corpus, "--utterance", files.id, "--out", tmp_path / "o"), "head markers only")


def test_excluded_recordings_are_called_excluded(tool, corpus, tmp_path):
    toml, names = corpus / "corpus.toml", [f.id for f in files_of(corpus)]
    text = toml.read_text()
    args = ("synth", corpus, "--utterance", names[0], "--out", tmp_path / "o")
    toml.write_text(text.replace("exclude = []", f"exclude = {json.dumps(names[:1])}"))
    refused(tool(*args), names[0], "exclude")
    toml.write_text(text.replace("exclude = []", f"exclude = {json.dumps(names)}"))
    refused(tool(*args), "every recording", "exclude")


@pytest.mark.parametrize("place", ["", "wav", "markers", "textgrid"])
def test_a_folder_of_the_corpus_is_no_output_folder(tool, corpus, place):
    before = sorted(p.relative_to(corpus) for p in corpus.rglob("*"))
    name = files_of(corpus)[0].id
    refused(tool("synth", corpus, "--utterance", name, "--out", corpus / place), "belongs to the corpus")
    assert sorted(p.relative_to(corpus) for p in corpus.rglob("*")) == before


BAD_MESHES = {
    "part": {"part": np.zeros(10, np.int8)},
    "parts": {"part": np.full(4777, 99, np.int8)},
    "real": {"vertices_mm": np.full((4777, 3), "a")},
    "triangles": {"faces": np.full((4, 3), np.nan)},
    "triangle": {"faces": np.full((4, 3), "1")},
    "brow0": {"marker_vertices": np.full(66, np.nan)},
    "lip pairs": {"lip_pairs": np.full((3, 2), 0.5)},
    "bound": {"lip_pairs": np.zeros((7, 2), np.int64)},
    "scale it to mm": {"vertices_mm": np.zeros((4777, 3)) + 1e-3},
}


@pytest.mark.parametrize("word", BAD_MESHES)
def test_a_mesh_of_the_wrong_kind_is_refused(tool, corpus, tmp_path, word):
    path = tmp_path / "odd.npz"
    write_mesh(path, bundled_head("base"))
    with np.load(path) as data:
        assert len(data["vertices_mm"]) == 4777
        assert len(data["marker_names"]) == 66
    change(path, **BAD_MESHES[word])
    name = files_of(corpus)[0].id
    answer = tool("synth", corpus, "--utterance", name, "--mesh", path, "--out", tmp_path / "o")
    refused(answer, "odd", word.removesuffix("s"))
    assert not (tmp_path / "o").exists()


def test_faces_that_are_no_whole_numbers_make_no_mesh():
    head = bundled_head("base")
    with pytest.raises(MeshError, match="triangles"):
        type(head)("m", head.vertices_mm, head.faces + 0.5, head.part, head.part_names)


def test_a_folder_that_cannot_be_filled_stays_as_it_was(tmp_path):
    (tmp_path / "o/motion.npz").mkdir(parents=True)
    (tmp_path / "o/a.txt").write_text("old")
    with pytest.raises(OutputError, match="motion"), atomic_folder(tmp_path / "o") as new:
        (new / "a.txt").write_text("new")
        (new / "motion.npz").write_text("new")
    assert (tmp_path / "o/a.txt").read_text() == "old"
    assert sorted(p.name for p in tmp_path.rglob("*")) == ["a.txt", "motion.npz", "o"]


@pytest.mark.parametrize("existed", [True, False])
@pytest.mark.parametrize("moves", range(4))
def test_files_are_moved_all_or_none(tmp_path, monkeypatch, moves, existed):
    source, target = tmp_path / "s", tmp_path / "t"
    source.mkdir()
    for name in "abc":
        (source / name).write_text("new")
    if existed:
        target.mkdir()
        (target / "b").write_text("old")
    move, done = type(source).replace, []

    def stop_once(path, to):
        done.append(path)
        if len(done) == moves + 1:
            raise KeyboardInterrupt
        return move(path, to)

    monkeypatch.setattr(type(source), "replace", stop_once)
    n_moves = 4 if existed else 3
    if moves < n_moves:
        with pytest.raises(KeyboardInterrupt):
            _move_all(source, target, lambda folder: False)
        assert {p.name: p.read_text() for p in target.glob("*")} == ({"b": "old"} if existed else {})
        assert target.exists() == existed
    else:
        _move_all(source, target, lambda folder: False)
        assert {p.name: p.read_text() for p in target.glob("*")} == dict.fromkeys("abc", "new")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("delay_s", [0.0, 0.15, 0.4])
def test_stopped_while_the_program_still_starts(corpus, tmp_path, number, delay_s):
    waiting = "import sys; from corpus_tools.cli import start; print(1, flush=True); start.run()"
    args = ["synth", corpus, "--utterance", files_of(corpus)[0].id, "--out", tmp_path / "o"]
    process = subprocess.Popen(
        [sys.executable, "-c", waiting, *map(str, args)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout.readline() == "1\n"
    time.sleep(0.02 + delay_s)
    process.send_signal(number)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 2, err
    assert err == "Stopped before the end: nothing was written.\n"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["c"]


@pytest.mark.parametrize("args", [["--help"], ["config", "schema"]])
def test_a_reader_that_leaves_early_is_no_fault(args):
    reading, writing = os.pipe()
    os.close(reading)
    run = subprocess.run([*START, *args], stdout=writing, stderr=subprocess.PIPE, text=True, timeout=60)
    os.close(writing)
    assert (run.returncode, run.stderr) == (0, "")


def test_closed_and_full_streams_are_no_fault_of_the_program(corpus, tmp_path):
    line = " ".join(START[:2]) + f" '{START[2]}' "
    shell = ["sh", "-c"]
    closed = subprocess.run([*shell, line + "config show >&-"], capture_output=True, text=True, timeout=60)
    assert (closed.returncode, closed.stderr) == (0, "")
    silent = subprocess.run([*shell, line + f"check {tmp_path / 'no'} 2>&-"], check=False, timeout=60)
    assert silent.returncode == 2
    full = subprocess.run(
        [*shell, line + "config show >/dev/full"], capture_output=True, text=True, timeout=60
    )
    assert full.returncode == 2
    assert "No space left" in full.stderr
    assert len(full.stderr.splitlines()) == 1


def test_a_name_that_is_no_text_is_shown_escaped(corpus):
    motion = files_of(corpus)[0].motion
    motion.rename(motion.with_name(os.fsdecode(b"b\xff.npz")))
    run = subprocess.run(
        [*START, "check", str(corpus), "--json"], capture_output=True, timeout=60, check=False
    )
    assert run.returncode == 0, run.stderr
    names = [r["id"] for r in json.loads(run.stdout.decode().splitlines()[-1])["recordings"]]
    assert os.fsdecode(b"b\xff") in names
