"""What an earlier result left in a folder is removed, and nothing else."""

from __future__ import annotations

import json

import pytest

from corpus_tools.io import file_hash
from corpus_tools.pipeline import listed_files, remove_stale


def result(folder, **texts):
    """Write files and a manifest that lists them, as a synthesis does."""
    names = []
    for key, text in texts.items():
        name = key.replace("__", "/").replace("_", ".")
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
        names.append(name)
    files = {n: file_hash(folder / n) for n in names}
    manifest(folder, files)
    return files


def manifest(folder, files, program="corpus-tools"):
    (folder / "manifest.json").write_text(json.dumps({"program": {"name": program}, "files": files}))


OTHERS = '{"program": {"name": "x"}, "files": {"a": "b"}}'


def left(folder):
    return {p.relative_to(folder).as_posix() for p in folder.rglob("*")} - {"manifest.json"}


def test_only_what_the_earlier_manifest_listed_goes(tmp_path):
    result(tmp_path, motion_npz="1", film_mp4="f", frames__0_png="p", frames__1_png="q")
    (tmp_path / "mine.txt").write_text("mine")
    (tmp_path / "strip.png").write_text("not listed")
    before = listed_files(tmp_path)
    result(tmp_path, motion_npz="2")
    assert remove_stale(tmp_path, before) == ("film.mp4", "frames/0.png", "frames/1.png")
    assert left(tmp_path) == {"motion.npz", "mine.txt", "strip.png"}


def test_a_file_that_was_altered_or_added_to_its_folder_stays(tmp_path):
    result(tmp_path, film_mp4="f", frames__0_png="p")
    before = listed_files(tmp_path)
    (tmp_path / "film.mp4").write_text("cut by its owner")
    (tmp_path / "frames/notes.txt").write_text("mine")
    result(tmp_path, motion_npz="2")
    assert remove_stale(tmp_path, before) == ("frames/0.png",)
    assert left(tmp_path) == {"motion.npz", "film.mp4", "frames", "frames/notes.txt"}


def test_names_that_lead_out_of_the_folder_and_links_are_not_followed(tmp_path):
    out, other = tmp_path / "out", tmp_path / "other"
    out.mkdir()
    other.mkdir()
    (other / "a.txt").write_text("a")
    (out / "link").symlink_to(other)
    (out / "a.txt").symlink_to(other / "a.txt")
    value = file_hash(other / "a.txt")
    names = ("../other/a.txt", str(other / "a.txt"), "link/a.txt", "a.txt", "")
    manifest(out, dict.fromkeys(names, value))
    before = listed_files(out)
    manifest(out, {})
    assert remove_stale(out, before) == ()
    assert (other / "a.txt").read_text() == "a"
    assert (out / "a.txt").is_symlink()


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"program": 3}', OTHERS])
def test_a_manifest_of_somebody_else_lists_nothing(tmp_path, text):
    (tmp_path / "manifest.json").write_text(text)
    assert listed_files(tmp_path) == {}
    assert listed_files(tmp_path / "none") == {}
