"""Files and folders appear whole or not at all."""

import errno
import os
import sys
import threading
import time
from pathlib import Path

import pytest

from corpus_tools.core import OutputError, atomic_file, atomic_folder, check_writable


class BoomError(Exception):
    pass


def test_a_file_appears_only_when_complete(tmp_path):
    path = tmp_path / "below" / "a.txt"
    with atomic_file(path) as temporary:
        temporary.write_text("new")
        assert not path.exists()
    assert path.read_text() == "new"
    with pytest.raises(BoomError), atomic_file(path) as temporary:
        temporary.write_text("half")
        raise BoomError
    assert path.read_text() == "new"
    assert [p.name for p in path.parent.iterdir()] == ["a.txt"]


@pytest.mark.parametrize("error", [BoomError, KeyboardInterrupt])
def test_a_folder_appears_only_when_complete(tmp_path, error):
    folder = tmp_path / "out"
    with pytest.raises(error), atomic_folder(folder) as temporary:
        (temporary / "half.npz").write_text("x")
        raise error
    assert not list(tmp_path.iterdir())
    with atomic_folder(folder) as temporary:
        (temporary / "whole.npz").write_text("y")
    assert [p.name for p in folder.iterdir()] == ["whole.npz"]


def test_an_existing_folder_keeps_its_other_files(tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / "notes.txt").write_text("mine")
    (folder / "a").write_text("old")
    with atomic_folder(folder) as temporary:
        (temporary / "a").write_text("new")
    assert (folder / "notes.txt").read_text() == "mine"
    assert (folder / "a").read_text() == "new"


def test_a_full_disk_is_told_of_the_place_that_was_given_and_of_no_hidden_one(tmp_path):
    with (
        pytest.raises(OutputError) as caught,
        atomic_folder(tmp_path / "out") as hidden,
        atomic_file(hidden / "markers" / "a.npz"),
    ):
        raise OSError(errno.ENOSPC, "No space left on device")
    assert f"'{tmp_path / 'out/markers/a.npz'}': No space left" in str(caught.value)
    assert ".part" not in str(caught.value)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("place", ["file", "file/below", "/proc/nowhere"])
def test_unwritable_places_are_named(tmp_path, place):
    (tmp_path / "file").write_text("x")
    target = tmp_path / place if not place.startswith("/") else place
    with pytest.raises(OutputError) as caught, atomic_folder(target):
        pass
    assert str(target) in str(caught.value)
    assert (tmp_path / "file").read_text() == "x"


def test_check_writable_leaves_nothing(tmp_path):
    check_writable(tmp_path / "a" / "b")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("atomic", [atomic_file, atomic_folder])
def test_a_full_disk_is_told_to_be_emptied(tmp_path, atomic):
    with (
        pytest.raises(OutputError, match="No space left on device; free space there"),
        atomic(tmp_path / "o"),
    ):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(sys.platform == "win32", reason="there are no locks on folders")
def test_two_that_write_one_folder_do_not_mix(tmp_path, monkeypatch):
    move = Path.replace

    def slowly(path, to):
        time.sleep(0.002)
        return move(path, to)

    monkeypatch.setattr(Path, "replace", slowly)
    names, met = "abcd", threading.Barrier(4)

    def write(who):
        with atomic_folder(tmp_path / "o") as folder:
            for name in names:
                (folder / name).write_text(who)
            met.wait(timeout=30)

    writers = [threading.Thread(target=write, args=(who,)) for who in "1234"]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
    assert len({(tmp_path / "o" / name).read_text() for name in names}) == 1
    assert [p.name for p in tmp_path.iterdir()] == ["o"]
