"""Which program computes: hashes of its sources, versions of its libraries."""

from __future__ import annotations

import hashlib
import platform
import sys
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import corpus_tools

__all__ = ["code_hash", "library_versions"]

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
