"""Files of an earlier result in a folder that a new one was written into: found, and taken away."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path, PurePosixPath

from corpus_tools.core import InputError
from corpus_tools.io import file_hash

__all__ = ["listed_files", "remove_stale"]


def _inside(name: str) -> bool:
    """Say whether a name of a manifest stays in its folder."""
    parts = PurePosixPath(name).parts
    return bool(parts) and not PurePosixPath(name).is_absolute() and ".." not in parts and "\\" not in name


def listed_files(folder: str | Path) -> dict[str, str]:
    """Return the files that a folder's manifest lists, with SHA-256; nothing without one of ours."""
    try:
        data = json.loads((Path(folder) / "manifest.json").read_text(encoding="utf-8"))
        ours = data["program"]["name"] == "corpus-tools"
        files = dict(data["files"]) if ours else {}
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return {}
    return {name: str(value) for name, value in files.items() if isinstance(name, str) and _inside(name)}


def _as_written(folder: Path, name: str, value: str) -> bool:
    """Say whether a file lies in the folder itself, no link leads out of it, and it is as it was written."""
    path = folder / name
    if path.is_symlink() or not path.is_file() or not path.resolve().is_relative_to(folder.resolve()):
        return False
    try:
        return file_hash(path) == value
    except InputError:
        return False


def remove_stale(folder: str | Path, before: dict[str, str]) -> tuple[str, ...]:
    """Remove what an earlier result left in a folder and the present one did not write.

    Only files that the earlier manifest listed, and that are byte for byte what it listed, are touched: one
    that somebody altered since is theirs. Folders that become empty go too.

    Parameters
    ----------
    folder : path
        With the new result in it.
    before : dict of name -> SHA-256
        As of :func:`listed_files`, asked before the new result was written.

    Returns
    -------
    tuple of str
        Names of the removed files, sorted.
    """
    root, now = Path(folder), listed_files(folder)
    stale = [n for n, value in sorted(before.items()) if n not in now and _as_written(root, n, value)]
    removed = []
    for name in stale:
        with contextlib.suppress(OSError):
            (root / name).unlink()
            removed.append(name)
            for parent in PurePosixPath(name).parents[:-1]:
                (root / parent).rmdir()  # refused where something is left in it
    return tuple(removed)
