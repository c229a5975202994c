"""What the command line says about the server, and what of it is refused; imports nothing that takes time."""

from __future__ import annotations

import socket
from dataclasses import dataclass, field
from pathlib import Path

from corpus_tools.core import InputError

__all__ = ["LOOPBACK", "Options", "check_options", "free_port", "read_password"]

LOOPBACK = ("127.0.0.1", "localhost", "::1")


@dataclass(frozen=True, slots=True)
class Options:
    """What the command line says about the server.

    Attributes
    ----------
    corpus : path or None
    host : str
    port : int
        0 takes a free one.
    password_file : path or None
        First line: the password; needed on any host but loopback.
    origins : tuple of str
        Host names (with port) that pages may be asked from.
    root : path or None
        Folder that corpora and exports must lie in; needed on any host but loopback.
    browser : bool
        Open the browser.
    demo : bool
        Open the simulated starter corpus when no corpus is given; never with a `root`, which it lies outside.
    app : str
        Dashboard to begin with.
    config : path or None
        Config that is taken over when the first corpus has been opened.
    """

    corpus: Path | None = None
    host: str = "127.0.0.1"
    port: int = 5006
    password_file: Path | None = None
    origins: tuple[str, ...] = field(default=())
    root: Path | None = None
    browser: bool = True
    demo: bool = True
    app: str = "blend"
    config: Path | None = None


def read_password(path: Path) -> str:
    """Return the first line of a password file.

    Raises
    ------
    InputError
        The file is missing, or its first line is shorter than 8 characters.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"The password file '{path}' cannot be read: {error}.") from None
    password = lines[0].strip() if lines else ""
    if len(password) < 8:
        raise InputError(f"The first line of '{path}' must hold a password of at least 8 characters.")
    return password


def check_options(options: Options) -> None:
    """Refuse what is unsafe or cannot work.

    Raises
    ------
    InputError
        One sentence: a host other than loopback without password, origin and root; a corpus or root that is
        no folder; a port in use.
    """
    if options.host not in LOOPBACK:
        missing = [
            name
            for name, value in (
                ("--password-file", options.password_file),
                ("--origin", options.origins),
                ("--root", options.root),
            )
            if not value
        ]
        if missing:
            raise InputError(
                f"--host {options.host} opens the workbench to other machines: give {', '.join(missing)} "
                "too, or leave --host out."
            )
    if options.root is not None and not options.root.is_dir():
        raise InputError(f"--root '{options.root}' is not a folder.")
    if options.corpus is not None and not (options.corpus / "corpus.toml").is_file():
        raise InputError(
            f"There is no corpus.toml in '{options.corpus}': make a corpus with 'corpus-tools init', "
            "or give the folder that holds it."
        )
    if options.password_file is not None:
        read_password(options.password_file)
    if options.config is not None:
        from corpus_tools.config import load_config  # takes half a second to import

        load_config(options.config)
    _check_port(options.host, options.port)


def _check_port(host: str, port: int) -> None:
    if not 0 <= port <= 65535:
        raise InputError(f"--port {port} is not a port; give a number between 0 and 65535.")
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            reason = error.strerror or str(error)
            other = "--host" if isinstance(error, socket.gaierror) else "--port"
            raise InputError(
                f"Cannot listen on {host} port {port}: {reason}; choose another with {other}."
            ) from None


def free_port(host: str = "127.0.0.1") -> int:
    """Return a port nobody listens on."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as probe:
        probe.bind((host, 0))
        return int(probe.getsockname()[1])
