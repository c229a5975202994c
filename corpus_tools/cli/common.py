"""What every command shares: one line of JSON, progress on stderr, one sentence for a user's mistake."""

from __future__ import annotations

import contextlib
import errno
import json
import os
import signal
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import FrameType
from typing import Any

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from corpus_tools.core import InputError, OutputError, WorkbenchError, check_writable
from corpus_tools.io import find_recordings, read_description

__all__ = [
    "EXIT_BUG",
    "EXIT_INPUT",
    "PATH",
    "OneSentence",
    "StoppedByUser",
    "check_out_folder",
    "emit_json",
    "guarded",
    "path_argument",
    "progress_bar",
    "say",
]

EXIT_INPUT = 2
EXIT_BUG = 1


_SURROUNDINGS = frozenset(
    getattr(errno, name)
    for name in (
        *("EACCES", "EPERM", "EROFS", "ENOSPC", "EDQUOT", "EFBIG", "EIO", "ENAMETOOLONG"),
        *("ELOOP", "EMFILE", "ENFILE", "ENOTDIR", "EISDIR", "ENOENT", "ESTALE"),
    )
    if hasattr(errno, name)
)
"""Failures of files and disks: what a user can mend, and no fault of the program."""


def say(text: str = "", at_once: bool = False) -> None:
    """Print a line for people on stdout; characters that it cannot show are escaped.

    `at_once`: a reader at the other end of a pipe gets it now, and not when there is more.
    """
    if sys.stdout is None:  # it was closed by the caller
        return
    encoding = getattr(sys.stdout, "encoding", None) or "utf-8"
    sys.stdout.write(text.encode(encoding, "backslashreplace").decode(encoding) + "\n")
    if at_once:
        sys.stdout.flush()


def emit_json(data: Mapping[str, Any]) -> None:
    """Print one JSON object as the last line of stdout."""
    say(json.dumps(data, ensure_ascii=False, allow_nan=False, default=str))


def path_argument(text: str) -> Path:
    """Return a path of the command line; parser of typer options.

    Raises
    ------
    typer.BadParameter
        It is blank: that would stand for the folder one happens to be in.
    """
    if not str(text).strip():
        raise typer.BadParameter("it is empty, a path was expected ('.' is the present folder)")
    return Path(text)


PATH: dict[str, Any] = {"parser": path_argument, "metavar": "PATH"}
"""What typer is told of every path: ``typer.Option("--out", **PATH, help=...)``."""


@contextlib.contextmanager
def progress_bar(title: str) -> Iterator[Callable[[float, str], None]]:
    """Yield ``report(fraction, what)``; draws a bar on stderr when that is a terminal, else nothing."""
    if sys.stderr is None or not sys.stderr.isatty():
        yield lambda fraction, what: None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.percentage:>3.0f} %"))
    bar = Progress(*columns, TimeRemainingColumn(), console=Console(stderr=True), transient=True)
    with bar:
        task = bar.add_task(title, total=1.0)
        yield lambda fraction, what: bar.update(task, completed=fraction, description=what)


def check_out_folder(out: Path, corpus: Path) -> None:
    """Refuse a folder that holds recordings: what is written must neither replace nor become one."""
    check_writable(out)
    description = read_description(corpus)
    folders = {description.folder.resolve()}
    for files in find_recordings(description):
        folders |= {p.parent.resolve() for p in (files.motion, files.audio, files.labels) if p}
    if out.resolve() in folders:
        raise OutputError(f"'{out}' belongs to the corpus '{corpus}'; choose a folder of its own for --out.")


class OneSentence:
    """Goes before a command class of typer: a misspelt option costs one sentence, as other mistakes do."""

    def main(self, *args: Any, **extra: Any) -> Any:
        """Run a command; what typer would print or swallow itself is raised instead."""
        try:
            code = super().main(*args, **(extra | {"standalone_mode": False}))  # type: ignore[misc]
        except SystemExit as stop:
            if isinstance(stop.__context__, BrokenPipeError):
                raise stop.__context__ from None
            raise
        except Exception as error:
            if type(error).__name__ == "NoArgsIsHelpError":
                error.show()  # type: ignore[attr-defined]
                raise SystemExit(2) from None
            if not hasattr(error, "format_message"):
                raise
            place = getattr(getattr(error, "ctx", None), "command_path", "corpus-tools")
            sentence = error.format_message().rstrip(".")
            raise InputError(f"{sentence}; '{place} --help' lists what there is.") from None
        if isinstance(code, int) and code:
            raise SystemExit(code)
        return code


class StoppedByUser(BaseException):
    """Ctrl-C or a termination signal: no KeyboardInterrupt, for which typer has a message of its own."""


def _stop(signum: int, frame: FrameType | None) -> None:
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)  # a second Ctrl-C must not disturb the cleaning up
    raise StoppedByUser


def _line(text: str) -> None:
    if sys.stderr is None:
        return
    with contextlib.suppress(OSError):  # whoever reads it may be gone
        sys.stderr.write(" ".join(text.split()) + "\n")
        sys.stderr.flush()


def _of_the_surroundings(error: OSError) -> str:
    """Return the sentence for a file or disk that does not let itself be used."""
    what = f"'{error.filename}' cannot be used" if error.filename else "Reading or writing failed"
    return f"Error: {what}: {error.strerror}; check the path, the permissions and the space on the disk."


def _forget_output() -> None:
    """Let go of what could not be written: the interpreter would try it again at its end, and say so."""
    stdout = sys.__stdout__
    if stdout is not None and sys.stdout is stdout:
        with contextlib.suppress(OSError, ValueError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), stdout.fileno())


def guarded(command: Callable[[], Any]) -> int:
    """Run `command` and turn what it raises into an exit code and a sentence on stderr.

    Returns
    -------
    int
        0 done; 2 for a user's mistake, Ctrl-C or a termination signal; 1 for a fault of ours, whose traceback
        is shown only when ``CORPUS_TOOLS_DEBUG`` is set.
    """
    before = {number: signal.signal(number, _stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        command()
        if sys.stdout is not None:
            sys.stdout.flush()
    except WorkbenchError as error:
        _line(f"Error: {error}")
        return EXIT_INPUT
    except StoppedByUser:
        _line("Stopped before the end: nothing was written.")
        return EXIT_INPUT
    except BrokenPipeError:
        sys.stdout = None  # its reader has seen enough, as in "| head -1"; nothing is wrong
    except MemoryError as error:
        _line(
            f"Error: The memory of this computer does not suffice ({error}); take fewer or "
            "shorter recordings, or a lower --fps."
        )
        return EXIT_INPUT
    except Exception as error:
        if isinstance(error, OSError) and error.errno in _SURROUNDINGS:
            _forget_output()
            _line(_of_the_surroundings(error))
            return EXIT_INPUT
        if os.environ.get("CORPUS_TOOLS_DEBUG"):
            traceback.print_exc()
        _line(
            f"Internal error, a fault of this program: {type(error).__name__}: {error} "
            "(set CORPUS_TOOLS_DEBUG=1 for the traceback)."
        )
        return EXIT_BUG
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    return 0
