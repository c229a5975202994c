"""What each tab has done, kept in the user's state folder, so that a reload goes on where it was."""

from __future__ import annotations

import contextlib
import hashlib
import json
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import platformdirs

from corpus_tools.core import OutputError, atomic_file
from corpus_tools.pipeline.kept import APP
from workbench.actions.jobs import Job, LatestJob
from workbench.state import Session, session_record

__all__ = ["MOST_TABS", "Journal", "journal_folder"]

MOST_TABS = 64
"""Tabs that are kept, the newest (our choice)."""

LARGEST_BYTES = 16_000_000
_TAB = re.compile(r"[0-9a-f-]{16,64}")


def journal_folder() -> Path:
    """Return the folder of the journals in the user's state folder."""
    return Path(platformdirs.user_state_dir(APP, appauthor=False)) / "tabs"


class Journal:
    """Keeps a session in a file of its tab; nothing is kept until the tab has said which it is.

    Parameters
    ----------
    session : Session
    home : str
        What the server shows at first: a tab that comes back to another corpus begins anew.
    deliver : callable
        As of :class:`~workbench.actions.jobs.LatestJob`.
    """

    def __init__(self, session: Session, home: str, deliver: Callable[[Callable[[], None]], None]) -> None:
        self._session, self._home = session, home
        self._path: Path | None = None
        self._jobs: LatestJob[None] = LatestJob(deliver, lambda number, value: None, lambda number, why: None)
        session.param.watch(lambda *events: self.note(), ["edits", "theme"])

    def begin(self, tab: str, earlier: str = "") -> Mapping[str, Any] | None:
        """Keep the session of a tab from now on; return what was kept of it, or of the tab it is a copy of.

        Parameters
        ----------
        tab : str
            Its id: hexadecimal digits and hyphens; anything else is not kept.
        earlier : str
            The tab that it is a copy of, if it is one.
        """
        if _TAB.fullmatch(tab) is None or (earlier and _TAB.fullmatch(earlier) is None):
            return None
        self._path = self._file(tab)
        return _read(self._file(earlier or tab))

    def note(self) -> None:
        """Keep what the session is now, in the background; the newest wins."""
        path, session = self._path, self._session
        if path is None or session.corpus is None or not session.history.entries:
            return
        record = session_record(session)

        def work(job: Job) -> None:
            with contextlib.suppress(OutputError, OSError):
                with atomic_file(path) as part:
                    part.write_text(json.dumps(record), encoding="utf-8")
                _let_go(path.parent)

        self._jobs.submit(work)

    @property
    def busy(self) -> bool:
        """Whether something is being written."""
        return self._jobs.busy

    def close(self) -> None:
        """End; what is being written is written."""
        self._jobs.close()

    def _file(self, tab: str) -> Path:
        home = hashlib.sha256(self._home.encode()).hexdigest()[:12]
        return journal_folder() / f"{tab}-{home}.json"


def _read(path: Path) -> Mapping[str, Any] | None:
    """Return a record; a file that cannot be read counts as none."""
    try:
        if path.stat().st_size > LARGEST_BYTES:
            return None
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    return found if isinstance(found, dict) and isinstance(found.get("folder"), str) else None


def _let_go(folder: Path) -> None:
    """Remove the journals that were written longest ago."""
    files = sorted(folder.glob("*.json"), key=lambda p: p.stat().st_mtime_ns)
    for path in files[:-MOST_TABS]:
        path.unlink(missing_ok=True)
