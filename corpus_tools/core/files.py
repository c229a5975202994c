"""Files and folders appear whole or not at all."""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from corpus_tools.core.errors import OutputError, WorkbenchError

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

__all__ = ["atomic_file", "atomic_folder", "called", "check_writable"]


_FULL = {
    getattr(errno, "ENOSPC", None): "free space there, or choose another disk",
    getattr(errno, "EDQUOT", None): "free space there, or choose another disk",
    getattr(errno, "EFBIG", None): "raise the limit on the size of files, or choose another disk",
}


def _advice(error: OSError, place: str) -> str:
    return _FULL.get(error.errno) or f"choose a {place}"


def _refusal(path: Path, error: OSError) -> OutputError:
    reason, advice = error.strerror or str(error), _advice(error, "folder you may write to")
    return OutputError(f"Cannot write to '{path}': {reason}; {advice}.")


def check_writable(path: Path) -> None:
    """Raise :class:`OutputError` when nothing can be written at `path` (a folder to be made or used)."""
    try:
        parent = path
        while not parent.exists() and not parent.is_symlink() and parent != parent.parent:
            parent = parent.parent
        if not parent.is_dir():
            raise OutputError(f"Cannot write to '{path}': '{parent}' is not a folder; choose another folder.")
        with tempfile.NamedTemporaryFile(dir=parent, prefix=".writable-"):
            pass
    except OSError as error:
        raise _refusal(path, error) from error


@contextlib.contextmanager
def atomic_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a temporary path beside `path`; on success it takes its place, else it is removed."""
    target = Path(path)
    temporary: Path | None = None
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=target.parent, prefix=_hidden(target), suffix=".part")
        os.close(handle)
        temporary = Path(name)
        yield temporary
        with temporary.open("rb+") as stream:
            os.fsync(stream.fileno())
        umask = os.umask(0)
        os.umask(umask)
        temporary.chmod(0o666 & ~umask)
        temporary.replace(target)
    except OSError as error:
        reason, advice = error.strerror or str(error), _advice(error, "place you may write to")
        raise OutputError(f"Cannot write '{target}': {reason}; {advice}.") from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


@contextlib.contextmanager
def called(hidden: Path, place: Path) -> Iterator[None]:
    """Let sentences about files in a temporary folder name the place that the user gave."""
    try:
        yield
    except WorkbenchError as error:
        error.args = tuple(
            a.replace(str(hidden), str(place)) if isinstance(a, str) else a for a in error.args
        )
        raise


@contextlib.contextmanager
def atomic_folder(
    path: str | os.PathLike[str], replaceable: Callable[[Path], bool] = lambda folder: False
) -> Iterator[Path]:
    """Yield a temporary folder beside `path`; on success its files move into `path`, else nothing remains.

    Files of the same name in an existing folder are replaced, all of them or, after an error or Ctrl-C, none;
    other files there are left alone. A folder below it is replaced, as a whole, by one of the same name only
    when ``replaceable(folder)`` says that it may be.
    """
    target = Path(path)
    check_writable(target)
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        temporary = Path(tempfile.mkdtemp(dir=target.parent, prefix=_hidden(target), suffix=".part"))
    except OSError as error:
        raise _refusal(target, error) from error
    try:
        with called(temporary, target):
            yield temporary
        with _alone(target.parent):
            _move_all(temporary, target, replaceable)
    except OSError as error:
        raise _refusal(target, error) from error
    finally:
        try:
            shutil.rmtree(temporary, ignore_errors=True)
        except BaseException:  # interrupted: to the end all the same
            shutil.rmtree(temporary, ignore_errors=True)
            raise


@contextlib.contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Let nobody else of ours move files below `folder` meanwhile: two runs into one folder do not mix.

    Where there are no such locks (Windows, some network disks) it holds nobody off.
    """
    handle = -1
    try:
        if fcntl is not None:
            with contextlib.suppress(OSError):
                handle = os.open(folder, os.O_RDONLY)
                fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        if handle >= 0:
            os.close(handle)


def _hidden(target: Path) -> str:
    """Return the beginning of a temporary name beside `target`, short enough for every file system."""
    return f".{target.name[:40]}."


def _move_all(source: Path, target: Path, replaceable: Callable[[Path], bool]) -> None:
    """Move every file of `source` into `target`, or none of them."""
    existed = target.exists()
    target.mkdir(parents=True, exist_ok=True)
    names = sorted(item.name for item in source.iterdir())
    for name in names:
        old_is, new_is = (target / name).is_dir(), (source / name).is_dir()
        if not (target / name).exists() or not (old_is or new_is):
            continue
        if not (old_is and new_is and replaceable(target / name)):
            raise OutputError(f"Cannot write '{target / name}': it is there already; choose another folder.")
    old = Path(tempfile.mkdtemp(dir=source, prefix=".old."))
    try:
        for name in names:
            if (target / name).exists() or (target / name).is_symlink():
                (target / name).replace(old / name)
            (source / name).replace(target / name)
    except BaseException:
        _move_back(source, target, old, names)
        if not existed:
            target.rmdir()
        raise


def _move_back(source: Path, target: Path, old: Path, names: list[str]) -> None:
    """Undo a broken-off move; where it broke off is seen from what lies where."""
    for name in names:
        if not (source / name).exists():
            (target / name).replace(source / name)
        if (old / name).exists() or (old / name).is_symlink():
            (old / name).replace(target / name)
