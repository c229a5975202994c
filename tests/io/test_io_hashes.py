"""Hashes say what data is, wherever it lies and in whatever order it is listed."""

from __future__ import annotations

import hashlib

import pytest

from corpus_tools.core import InputError
from corpus_tools.io import content_hash, file_hash


def put(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def test_a_file_hash_is_its_sha256(tmp_path):
    path = put(tmp_path / "a", "spoken")
    assert file_hash(path) == file_hash(str(path)) == hashlib.sha256(b"spoken").hexdigest()


def test_content_is_independent_of_folder_and_order_even_when_names_repeat(tmp_path):
    here = [put(tmp_path / f"one/{k}/xyz.npz", k) for k in ("a", "b", "c")]
    there = [put(tmp_path / f"two/{k}/xyz.npz", k) for k in ("c", "a", "b")]
    assert content_hash(here) == content_hash(reversed(here)) == content_hash(there)


def test_content_names_and_number_of_files_count(tmp_path):
    a, b = put(tmp_path / "a", "1"), put(tmp_path / "b", "2")
    hashes = [content_hash(p) for p in ([a, b], [a], [b], [], [a, a])]
    hashes.append(content_hash([put(tmp_path / "x/a", "2"), put(tmp_path / "x/b", "1")]))
    hashes.append(content_hash([put(tmp_path / "y/c", "1"), b]))
    assert len(set(hashes)) == len(hashes)


def test_a_file_that_is_not_there_is_named(tmp_path):
    for make in (file_hash, lambda p: content_hash([p])):
        with pytest.raises(InputError, match="gone"):
            make(tmp_path / "gone")
