"""Opened corpora, shared read-only by every session of a server; and where a session may look for them."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from pathlib import Path

from corpus_tools.config import ConfigBase
from corpus_tools.core import CorpusError, InputError
from corpus_tools.pipeline import OpenCorpus, open_corpus
from workbench.state import default_config

__all__ = ["CorpusCache", "inside_root", "opened_by"]

Progress = Callable[[float, str], None]


def inside_root(path: str | Path, root: Path | None) -> Path:
    """Return the resolved path, refusing what lies outside `root` (links followed).

    Raises
    ------
    InputError
        The path is empty or leaves the root folder.
    """
    text = str(path).strip()
    if not text:
        raise InputError("No folder was given; type the path of a folder that holds corpus.toml.")
    try:
        resolved = Path(text).expanduser().resolve()
    except (OSError, RuntimeError, ValueError) as error:
        raise InputError(f"'{text}' is not a path: {error}.") from None
    if root is not None and not resolved.is_relative_to(root.resolve()):
        raise InputError(f"'{text}' lies outside the folder this server may read; choose a folder inside it.")
    return resolved


def opened_by(config: ConfigBase) -> Hashable:
    """Return what of a config a corpus is opened by: where it differs, the corpus is opened anew."""
    parts = (config.cleaning, config.selection.components, config.closure.components)
    return (config.alignment.rate_hz, repr(parts))


def _key(folder: Path, config: ConfigBase) -> Hashable:
    description = folder / "corpus.toml"
    try:
        stat = description.stat()
    except OSError:
        raise CorpusError(
            f"There is no corpus.toml in '{folder}': make one with "
            "'corpus-tools init FOLDER --motion PATTERN --audio PATTERN --labels PATTERN', "
            "or choose the folder that holds it."
        ) from None
    return (str(folder), stat.st_mtime_ns, stat.st_size, opened_by(config))


class CorpusCache:
    """Opens every corpus once per server and cleaning settings; sessions that ask together share the work.

    Parameters
    ----------
    root : path, optional
        Folder that corpora must lie in (remote use); anywhere when None.
    keep : int
        Opened corpora kept.
    """

    def __init__(self, root: Path | None = None, keep: int = 3) -> None:
        self.root = root
        self._keep = keep
        self._opened: OrderedDict[Hashable, OpenCorpus] = OrderedDict()
        self._locks: dict[Hashable, threading.Lock] = {}
        self._lock = threading.Lock()

    def open(
        self,
        folder: str | Path,
        progress: Progress,
        config: ConfigBase | None = None,
    ) -> OpenCorpus:
        """Return the opened corpus of a folder.

        Parameters
        ----------
        folder : path
        progress : callable
            ``progress(fraction, what)``; may raise to cancel, which leaves nothing half opened.
        config : config, optional

        Raises
        ------
        CorpusError, InputError
            The folder cannot be used; one sentence says why.
        """
        config = config or default_config()
        path = inside_root(folder, self.root)
        key = _key(path, config)
        with self._lock:
            lock = self._locks.setdefault(key, threading.Lock())
        while not lock.acquire(timeout=0.2):
            progress(0.0, "another tab is opening it")
        try:
            with self._lock:
                if key in self._opened:
                    self._opened.move_to_end(key)
                    return self._opened[key]
            corpus = open_corpus(path, config, progress)
            with self._lock:
                self._opened[key] = corpus
                while len(self._opened) > self._keep:
                    self._opened.popitem(last=False)
            return corpus
        finally:
            lock.release()
