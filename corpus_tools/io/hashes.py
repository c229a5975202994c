"""Content hashes: what data is, wherever it lies; for manifests and caches."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path

from corpus_tools.core import InputError

__all__ = ["content_hash", "file_hash"]


def file_hash(path: str | Path) -> str:
    """Return the SHA-256 of a file's bytes, in hex.

    Raises
    ------
    InputError
        The file cannot be read; the message names it.
    """
    try:
        with Path(path).open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise InputError(f"'{path}' cannot be read: {error.strerror or error}.") from None


def content_hash(paths: Iterable[str | Path]) -> str:
    """Return one SHA-256 over the names and bytes of files, independent of their folders and order.

    Raises
    ------
    InputError
        A file cannot be read.
    """
    digest = hashlib.sha256()
    # a name cannot hold NUL, so two sets of files never give the same text
    for name, content in sorted((Path(path).name, file_hash(path)) for path in paths):
        digest.update(f"{name}\0{content}\0".encode("utf-8", "surrogateescape"))
    return digest.hexdigest()
