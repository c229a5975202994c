"""Who is what: hashes of corpus, code and data that make a result repeatable."""

from __future__ import annotations

import hashlib
import platform
import sys
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import corpus_tools
from corpus_tools.io import content_hash, find_recordings
from corpus_tools.pipeline.opened import OpenCorpus

__all__ = ["code_hash", "corpus_provenance", "library_versions"]

_LIBRARIES = ("numpy", "scipy", "pandas", "praatio", "pydantic", "soundfile")


def code_hash() -> str:
    """Return the SHA-256 of all Python sources and data files of the library, independent of their place."""
    root = Path(corpus_tools.__file__).parent
    digest = hashlib.sha256()
    for path in sorted(root.rglob("*")):
        if path.is_file() and path.suffix in {".py", ".toml", ".json", ".npz"}:
            digest.update(path.relative_to(root).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()


def library_versions() -> dict[str, str]:
    """Return the versions of Python and of the libraries that compute."""
    found = {"python": platform.python_version(), "implementation": sys.implementation.name}
    for name in _LIBRARIES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "absent"
    return found


def corpus_provenance(corpus: OpenCorpus) -> dict[str, Any]:
    """Return name and content hashes of a corpus: the motion, labels and audio of every recording."""
    files = find_recordings(corpus.description)
    kinds = {
        "motion": [f.motion for f in files],
        "labels": [f.labels for f in files if f.labels],
        "audio": [f.audio for f in files if f.audio],
    }
    return {
        "name": corpus.description.name,
        "recordings": len(corpus.recordings),
        "skipped": len(corpus.skipped),
        **{f"{kind}_sha256": content_hash(paths) for kind, paths in kinds.items()},
    }
