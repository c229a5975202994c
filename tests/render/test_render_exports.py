"""Exports by name: each writes what the manifest lists, twice the same; mistakes are told before the work."""

import hashlib
import json
import sys

import numpy as np
import pytest

from corpus_tools.cli.common import guarded
from corpus_tools.cli.main import app
from corpus_tools.config import Config, config_with
from corpus_tools.core import InputError, OutputError
from corpus_tools.io import MOTION_WRITERS, read_markers
from corpus_tools.pipeline import prepare_head, synthesise, write_synthesis
from corpus_tools.render import (
    EXPORTERS,
    check_exports,
    export_all,
    export_names,
    is_export_folder,
    probe,
    probe_offscreen,
)
from corpus_tools.render.exports import MOTION_FILES

SMALL = config_with(Config(), film__width=128, film__height=96, film__rate_hz=5.0, film__strip_frames=3)


@pytest.fixture(scope="module")
def made(offscreen, opened_corpus):
    head = prepare_head(opened_corpus, "base", SMALL)
    target = min((r.utterance for r in opened_corpus.recordings), key=lambda u: u.duration_s)
    return synthesise(opened_corpus, target, SMALL, head, (target.name,)), head


def write(folder, made, names):
    synthesis, head = made
    seen = []

    def exports(out):
        return export_all(names, out, synthesis, head, SMALL, lambda f, w: seen.append(f))

    write_synthesis(folder, synthesis, head, SMALL, {}, {}, exports)
    return seen


@pytest.mark.skipif(sys.platform == "win32", reason="there are no limits on the size of files")
@pytest.mark.parametrize("name", list(EXPORTERS))
def test_a_disk_that_takes_no_more_in_the_middle_of_an_export_leaves_nothing(made, tmp_path, name):
    """Files may grow to 600 bytes once the export begins: a real error of the system."""
    import resource

    synthesis, head = made
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)

    def exports(out):
        assert (out / "speech.wav").exists()
        resource.setrlimit(resource.RLIMIT_FSIZE, (600, hard))
        return export_all([name], out, synthesis, head, SMALL)

    (tmp_path / "o").mkdir()
    (tmp_path / "o/motion.npz").write_text("old")
    try:
        with pytest.raises(OutputError, match=r"File too large; .*limit on the size of files") as caught:
            write_synthesis(tmp_path / "o", synthesis, head, SMALL, {}, {}, exports)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert len(str(caught.value).splitlines()) == 1
    assert [p.relative_to(tmp_path).as_posix() for p in sorted(tmp_path.rglob("*"))] == ["o", "o/motion.npz"]
    assert (tmp_path / "o/motion.npz").read_text() == "old"


@pytest.mark.parametrize("name", list(EXPORTERS))
def test_every_export_is_listed_and_twice_the_same(made, tmp_path, name):
    plain = {"motion.npz", "mesh.npz", "speech.wav", "labels.TextGrid", "joins.csv", "contacts.csv"}
    found = []
    for run in ("a", "b"):
        shares = write(tmp_path / run, made, [name])
        manifest = json.loads((tmp_path / run / "manifest.json").read_text())
        assert set(manifest["exports"]) == {name}
        assert (tmp_path / run / manifest["exports"][name]["file"]).exists()
        assert json.loads((tmp_path / run / "run.json").read_text())["timings_ms"]["export"] > 0
        assert all(0 <= share <= 1 for share in shares)
        assert shares == sorted(shares)
        files = {p.relative_to(tmp_path / run).as_posix() for p in (tmp_path / run).rglob("*") if p.is_file()}
        assert files - {"manifest.json", "run.json"} == set(manifest["files"])
        assert set(manifest["files"]) > plain
        for file, value in manifest["files"].items():
            assert hashlib.sha256((tmp_path / run / file).read_bytes()).hexdigest() == value
        found.append(manifest["files"])
    assert found[0] == found[1]
    assert EXPORTERS[name].summary.endswith(".")


@pytest.mark.parametrize("name", list(MOTION_FILES))
def test_motion_comes_back_as_it_was(made, tmp_path, name):
    synthesis, head = made
    facts = export_all([name], tmp_path, synthesis, head, SMALL)[name]
    found = read_markers(tmp_path / facts["file"])
    assert found.names == synthesis.trajectory.names
    assert found.rate_hz == pytest.approx(synthesis.trajectory.rate_hz)
    np.testing.assert_allclose(found.positions_mm, synthesis.trajectory.values_mm, atol=2e-3)


def test_every_motion_format_that_is_written_is_an_export():
    assert set(MOTION_WRITERS) - {"npz"} == set(MOTION_FILES)


def test_stopped_in_the_middle_nothing_remains(made, tmp_path):
    synthesis, head = made

    def stop(fraction, what):
        if fraction > 0.2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_synthesis(
            tmp_path / "o",
            synthesis,
            head,
            SMALL,
            {},
            {},
            lambda out: export_all(["mp4"], out, synthesis, head, SMALL, stop),
        )
    assert list(tmp_path.iterdir()) == []


def test_names_are_a_list_and_unknown_ones_are_refused_with_the_known():
    assert export_names("mp4, frames,mp4,") == ("mp4", "frames")
    assert export_names(None) == ()
    for nothing in ("", ",,", " , "):
        with pytest.raises(InputError, match="names nothing; known, by comma: mp4, frames"):
            export_names(nothing)
    with pytest.raises(InputError, match=r"export called 'mp5'; did you mean 'mp4'\?.*mp4.*frames"):
        export_names("frames,mp5")


def synth(capsys, *args):
    code = guarded(lambda: app([str(a) for a in ("synth", *args)], standalone_mode=True))
    return code, capsys.readouterr().err


@pytest.mark.parametrize(
    ("word", "args"),
    [
        ("Known: mp4, frames", ["--export", "hologram"]),
        ("--film-fps 0", ["--export", "mp4", "--film-fps", "0"]),
        ("is there already", ["--export", "frames"]),
    ],
)
def test_a_mistake_is_told_before_the_work(capsys, simulated_corpus, tmp_path, word, args):
    (tmp_path / "o/frames").mkdir(parents=True)
    (tmp_path / "o/frames/notes.txt").write_text("mine")
    code, error = synth(capsys, simulated_corpus, "--utterance", "x", "--out", tmp_path / "o", *args)
    assert code == 2
    assert word in error
    assert len(error.splitlines()) == 1
    assert sorted(p.name for p in tmp_path.rglob("*")) == ["frames", "notes.txt", "o"]


def test_frames_of_an_earlier_run_are_replaced_as_a_whole_and_nothing_else_is(made, tmp_path):
    synthesis, head = made
    frames = tmp_path / "frames"

    def again():
        def exports(out):
            return export_all(["frames"], out, synthesis, head, SMALL)

        check_exports(["frames"], tmp_path)
        write_synthesis(tmp_path, synthesis, head, SMALL, {}, {}, exports, is_export_folder)
        return {p.name: p.read_bytes() for p in frames.iterdir()}

    first = again()
    (frames / "frame-99999.png").write_text("of a longer sentence")
    (frames / "frame-00000.png").write_text("of another sentence")
    assert again() == first
    for other in ("notes.txt", "frame-1.png", "frame-00000.png.txt"):
        (frames / other).write_text("mine")
        with pytest.raises(OutputError, match="frames' is there already"):
            again()
        with pytest.raises(OutputError, match="frames': it is there already"):
            write(tmp_path, made, ["frames"])
        assert (frames / other).read_text() == "mine"
        (frames / other).unlink()
    assert not is_export_folder(tmp_path)
    assert not list(tmp_path.glob(".*"))


def test_a_missing_extra_and_a_machine_that_cannot_draw_are_told_before_the_work(
    capsys, simulated_corpus, tmp_path, monkeypatch
):
    base = (simulated_corpus, "--utterance", "x", "--out", tmp_path / "o", "--export")
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    code, error = synth(capsys, *base, "mp4")
    assert (code, "extra 'video'" in error) == (2, True)
    probe_offscreen.cache_clear()
    monkeypatch.setattr(probe, "DRAW", "import os; os.abort()")
    code, error = synth(capsys, *base, "frames")
    probe_offscreen.cache_clear()
    assert (code, "libegl1" in error) == (2, True)
    assert list(tmp_path.iterdir()) == []


def test_the_command_films(capsys, opened_corpus, simulated_corpus, tmp_path):
    config = tmp_path / "small.toml"
    config.write_text("schema = 1\n[film]\nwidth = 64\nheight = 64\n")
    name = min((r.utterance for r in opened_corpus.recordings), key=lambda u: u.duration_s).name
    args = ("--utterance", name, "--config", config, "--export", "mp4", "--film-fps", "4")
    code, error = synth(capsys, simulated_corpus, *args, "--out", tmp_path / "o")
    assert (code, error) == (0, "")
    facts = json.loads((tmp_path / "o/manifest.json").read_text())
    assert facts["exports"]["mp4"]["rate_hz"] == 4.0
    assert facts["config"]["film"]["width"] == 64
    assert (tmp_path / "o/film.mp4").stat().st_size > 1000
