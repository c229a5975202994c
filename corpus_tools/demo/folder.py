"""The simulated corpus that a first start shows: kept in the user's cache, made anew when it changes."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from corpus_tools.core import WorkbenchError
from corpus_tools.core.files import called
from corpus_tools.demo.corpus import N_SENTENCES, README, Progress, corpus_stamp, simulate_corpus
from corpus_tools.demo.voices import usual_voice
from corpus_tools.io import find_recordings, read_description

__all__ = ["demo_folder"]


def _is_whole(place: Path) -> bool:
    """Return whether the corpus of this version and voice is there with every recording."""
    readme = place / README
    if not readme.is_file() or corpus_stamp(usual_voice(), 0) not in readme.read_text("utf-8", "replace"):
        return False
    try:
        files = find_recordings(read_description(place))
    except WorkbenchError:
        return False
    return len(files) == N_SENTENCES and all(f.audio and f.labels for f in files)


def demo_folder(folder: str | Path, progress: Progress | None = None) -> Path:
    """Return a folder with the simulated starter corpus, made there on first use.

    The old copy stays until the new one is complete; of two processes that make it at once the first wins.

    Parameters
    ----------
    folder : path
        Where it is kept; a copy of another version or voice, or one with files missing, is replaced.
    progress : callable, optional
        ``progress(fraction, what)``; may raise to cancel.

    Raises
    ------
    OutputError
        The folder cannot be written.
    """
    place = Path(folder)
    if _is_whole(place):
        return place
    fresh = place.with_name(f".{place.name}.{os.getpid()}.new")
    old = place.with_name(f".{place.name}.{os.getpid()}.old")
    try:
        with called(fresh, place):
            simulate_corpus(fresh, progress=progress)
        if not _is_whole(place):
            if place.exists():
                place.replace(old)
            fresh.replace(place)
    finally:
        for leftover in (fresh, old):
            shutil.rmtree(leftover, ignore_errors=True)
    return place
