"""Cleaned motion kept between runs, by content: what was cleaned once is not cleaned again.

The name of a file is a hash of the captured motion, of the settings, of the program and of its libraries, so
that a file is right or is not found. Files lie in the user's cache folder; deleting them costs only time.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import zipfile
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import platformdirs

from corpus_tools.core import Capture, OutputError, Step, atomic_file
from corpus_tools.pipeline.code import code_hash, library_versions

__all__ = ["APP", "KEPT_BYTES", "KEPT_FILES", "cache_folder", "keep", "kept_folder", "kept_name", "read_kept"]

APP = "visual-speech-workbench"
"""Name of the folders of the project among those of the user."""

KEPT_FILES, KEPT_BYTES = 16, 256_000_000
"""Cleaned corpora that are kept, and the largest of which one is kept (our choice: 4 GB at most)."""

_PLAIN = (str, int, float, bool, type(None))
Kept = tuple[tuple[Capture, ...], float]


def cache_folder() -> Path:
    """Return the user's cache folder of the project: what lies in it can be made again at any time."""
    return Path(platformdirs.user_cache_dir(APP, appauthor=False))


def kept_folder() -> Path:
    """Return the folder of cleaned motion in the user's cache."""
    return cache_folder() / "cleaned"


def kept_name(captures: Iterable[Capture], settings: Any) -> str:
    """Return the name of the cleaned motion of captures, cleaned with settings that JSON can tell."""
    digest = hashlib.sha256()
    digest.update(json.dumps([code_hash(), library_versions(), settings], sort_keys=True).encode())
    for capture in captures:
        assert capture.flags is not None
        facts = [capture.positions_mm.shape, capture.rate_hz, capture.start_s, capture.names, capture.regions]
        digest.update(json.dumps(facts).encode())
        digest.update(np.ascontiguousarray(capture.positions_mm).data)
        digest.update(np.ascontiguousarray(capture.flags).data)
    return f"{digest.hexdigest()}.npz"


def keep(name: str, raw: Sequence[Capture], cleaned: Sequence[Capture], scale_sd: float) -> None:
    """Keep what came of captures; where that cannot be done, or would take too much room, nothing happens."""
    size = sum(c.positions_mm.nbytes for c in cleaned)
    steps = [_steps_after(r, c) for r, c in zip(raw, cleaned, strict=True)]
    if size > KEPT_BYTES or not all(_same_but_motion(r, c) for r, c in zip(raw, cleaned, strict=True)):
        return
    if any(s is None for s in steps):
        return
    arrays: dict[str, Any] = {"steps": json.dumps(steps), "scale_sd": float(scale_sd)}
    for i, capture in enumerate(cleaned):
        arrays[f"positions_mm_{i}"], arrays[f"flags_{i}"] = capture.positions_mm, capture.flags
    with contextlib.suppress(OSError, OutputError):
        with atomic_file(kept_folder() / name) as part, part.open("wb") as stream:
            np.savez(stream, **arrays)
        _let_go(kept_folder())


def read_kept(name: str, raw: Sequence[Capture]) -> Kept | None:
    """Return the cleaned captures of that name and the spread of the head scale; None when there are none.

    A file that cannot be read counts as none.
    """
    path = kept_folder() / name
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as found:
            steps, scale_sd = json.loads(str(found["steps"])), float(found["scale_sd"])
            motion = [(found[f"positions_mm_{i}"], found[f"flags_{i}"]) for i in range(len(raw))]
        os.utime(path)
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return None
    captures = []
    for capture, (positions_mm, flags), done in zip(raw, motion, steps, strict=True):
        history = tuple(Step(name, tuple((k, v) for k, v in settings)) for name, settings in done)
        captures.append(
            replace(capture, positions_mm=positions_mm, flags=flags, history=capture.history + history)
        )
    return tuple(captures), scale_sd


def _same_but_motion(raw: Capture, cleaned: Capture) -> bool:
    return all(
        getattr(raw, key) == getattr(cleaned, key) for key in ("rate_hz", "start_s", "names", "regions")
    )


def _steps_after(raw: Capture, cleaned: Capture) -> list[Any] | None:
    """Return the steps of cleaning as JSON can tell them; None when it cannot."""
    n = len(raw.history)
    values = [v for s in cleaned.history[n:] for _, v in s.settings]
    if cleaned.history[:n] != raw.history or not all(type(v) in _PLAIN for v in values):
        return None
    return [[s.name, [list(pair) for pair in s.settings]] for s in cleaned.history[n:]]


def _let_go(folder: Path) -> None:
    """Remove what was not used for longest, as far as there are too many."""
    found = sorted(folder.glob("*.npz"), key=lambda p: p.stat().st_mtime, reverse=True)
    for path in found[KEPT_FILES:]:
        path.unlink(missing_ok=True)
