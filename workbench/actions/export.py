"""Export: the config as a file, and the command line that replays it."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from corpus_tools.config import ConfigBase, config_from_dict, load_config, write_config
from corpus_tools.core import ConfigError, InputError, OutputError
from workbench.actions.corpora import inside_root
from workbench.state import Session

__all__ = ["export_config", "replay_command", "suggested_path"]


def suggested_path(folder: Path, stem: str) -> Path:
    """Return ``folder/stem.toml``, or the first of ``stem-2.toml``, ... that does not exist yet."""
    path = folder / f"{stem}.toml"
    number = 2
    while path.exists():
        path = folder / f"{stem}-{number}.toml"
        number += 1
    return path


def replay_command(session: Session, path: str | Path) -> str:
    """Return the line that makes the same motion in a shell, quoted where needed."""
    kind, what = session.target
    parts = ["corpus-tools", "synth", session.folder or "CORPUS"]
    if kind == "text":
        parts += [f"--text={what}"]
    else:
        parts += ["--utterance", what]
        if not session.held_out:
            parts.append("--include-self")
    parts += ["--config", str(path), "--out", "text_out" if kind == "text" else f"{what}_out"]
    return shlex.join(parts)


def _refuse_foreign(path: Path) -> None:
    if path.is_dir():
        raise OutputError(
            f"'{path}' is a folder; give the name of a file, for example '{path / 'blend.toml'}'."
        )
    if not path.exists():
        return
    try:
        load_config(path)
    except ConfigError:
        raise OutputError(
            f"'{path}' is there already and is not a config; nothing was overwritten: choose another name."
        ) from None


def export_config(
    session: Session,
    path: str | Path,
    provenance: Mapping[str, Any] | None = None,
    root: Path | None = None,
) -> tuple[Path, ConfigBase]:
    """Write every value of the session's config to a file, whole or not at all.

    Parameters
    ----------
    session : Session
    path : path
        A file; ``.toml`` is added when there is no suffix. Only another config is replaced.
    provenance : mapping, optional
        Corpus and code hashes to write beside the values.
    root : path, optional
        Folder the file must lie in (remote use).

    Returns
    -------
    path, config
        As written.

    Raises
    ------
    OutputError, InputError, ConfigError
        The file cannot be written there; one sentence says why.
    """
    if not str(path).strip():
        raise InputError("No file was given; type where the config is to be written.")
    target = inside_root(path, root)
    if not target.suffix and not target.is_dir():
        target = target.with_suffix(".toml")
    _refuse_foreign(target)
    data = session.config.model_dump(by_alias=True, mode="json")
    data["provenance"] = dict(provenance or {})
    config = config_from_dict(data, str(target))
    write_config(target, config)
    return target, config
