"""Export: the config as a file, and the command line that replays it."""

from __future__ import annotations

import re
import shlex
import unicodedata
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import platformdirs

from corpus_tools.config import ConfigBase, config_from_dict, load_config, write_config
from corpus_tools.core import ConfigError, InputError, OutputError
from corpus_tools.pipeline.kept import APP, cache_folder
from workbench.actions.corpora import inside_root
from workbench.state import Session

__all__ = [
    "export_config",
    "export_stem",
    "export_target",
    "exports_beside",
    "read_config",
    "replay_command",
    "spoken_of",
    "suggested_path",
]

_LONGEST_STEM = 40


def exports_beside(corpus_folder: Path) -> Path:
    """Return the folder that the exports of a corpus go to unless another is typed.

    ``exports`` beside corpus.toml; for a corpus in the cache, which may be deleted at any time, ``exports``
    in the user's data folder of the workbench.

    Parameters
    ----------
    corpus_folder : path
        Folder that holds corpus.toml.
    """
    corpus_folder = corpus_folder.resolve()
    if corpus_folder.is_relative_to(cache_folder().resolve()):
        return Path(platformdirs.user_data_dir(APP, appauthor=False)) / "exports"
    return corpus_folder / "exports"


def suggested_path(folder: Path, stem: str) -> Path:
    """Return ``folder/stem.toml``, or the first of ``stem-2.toml``, ... that does not exist yet."""
    path = folder / f"{stem}.toml"
    number = 2
    while path.exists():
        path = folder / f"{stem}-{number}.toml"
        number += 1
    return path


def export_stem(session: Session) -> str:
    """Return a name for the export of what is spoken: the recording's, or the first words of the text."""
    kind, what = session.target
    plain = unicodedata.normalize("NFKD", what).encode("ascii", "ignore").decode()
    words = re.findall(r"[A-Za-z0-9_]+", plain.lower() if kind == "text" else plain)
    stem = ""
    for word in words:
        if stem and len(stem) + 1 + len(word) > _LONGEST_STEM:
            break
        stem = f"{stem}-{word}" if stem else word
    return stem[:_LONGEST_STEM] or "blend"


def replay_command(session: Session, path: str | Path) -> str:
    """Return the line that makes the same motion in a shell of any folder, quoted where needed."""
    kind, what = session.target
    corpus = session.corpus
    folder = Path(session.folder or (corpus.description.folder if corpus is not None else "CORPUS"))
    parts = ["corpus-tools", "synth", str(folder.expanduser().absolute())]
    if kind == "text":
        parts += [f"--text={what}"]
    else:
        parts += ["--utterance", what]
        if not session.held_out:
            parts.append("--include-self")
    parts += [
        "--config",
        str(Path(path).absolute()),
        "--out",
        "text_out" if kind == "text" else f"{what}_out",
    ]
    return shlex.join(parts)


_LONGEST_NAME, _LONGEST_PATH = 200, 2000
"""Bytes of a part of a path, and characters of it all (our choice: less than file systems allow)."""


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


def export_target(path: str | Path, root: Path | None = None, beside: Path | None = None) -> Path:
    """Return the file that a config is written to; parameters and errors as of :func:`export_config`."""
    if not str(path).strip():
        raise InputError("No file was given; type where the config is to be written.")
    text = str(path).strip()
    longest = max((len(part.encode("utf-8", "replace")) for part in Path(text).parts), default=0)
    if longest > _LONGEST_NAME or len(text) > _LONGEST_PATH:
        raise OutputError(
            f"'{text[:30]}…' is too long for a file; give a name of at most {_LONGEST_NAME} bytes."
        )
    target = inside_root(text if text.startswith("~") else Path(beside or "") / text, root)
    if not target.suffix and not target.is_dir():
        target = target.with_suffix(".toml")
    _refuse_foreign(target)
    return target


def read_config(path: str | Path, root: Path | None = None, beside: Path | None = None) -> ConfigBase:
    """Return the config of a file that was typed; parameters as of :func:`export_config`.

    Raises
    ------
    InputError, ConfigError
        There is none, or it is not in order; one sentence says why, as ``corpus-tools config check`` does.
    """
    text = str(path).strip()
    if not text:
        raise InputError("No file was given; type which config is to be opened.")
    file = inside_root(text if text.startswith("~") else Path(beside or "") / text, root)
    if not file.suffix and not file.exists():
        file = file.with_suffix(".toml")
    if not file.exists():
        raise InputError(f"There is no config file '{file}'; type the path of one that was exported.")
    return load_config(file)


def spoken_of(config: ConfigBase, session: Session) -> dict[str, Any]:
    """Return the editable values of what an exported config says was spoken, as far as the corpus has it."""
    said = config.provenance
    text, name, held_out = said.get("text"), said.get("utterance"), said.get("held_out")
    if isinstance(text, str) and text.strip():
        return {"target_kind": "text", "text": text.strip()}
    if not isinstance(name, str) or name not in session.sentences:
        return {}
    own = {"held_out": held_out} if isinstance(held_out, bool) else {}
    return {"target_kind": "recording", "sentence": name, **own}


def export_config(
    session: Session,
    path: str | Path,
    provenance: Mapping[str, Any] | None = None,
    root: Path | None = None,
    beside: Path | None = None,
) -> tuple[Path, ConfigBase]:
    """Write every value of the session's config to a file, whole or not at all.

    Parameters
    ----------
    session : Session
    path : path
        A file; ``.toml`` is added when there is no suffix. Another config is replaced, nothing else is.
    provenance : mapping, optional
        Corpus and code hashes to write beside the values.
    root : path, optional
        Folder the file must lie in (remote use).
    beside : path, optional
        Folder that a path which is not absolute counts from; the working directory when not given.

    Returns
    -------
    path, config
        As written.

    Raises
    ------
    OutputError, InputError, ConfigError
        The file cannot be written there; one sentence says why.
    """
    target = export_target(path, root, beside)
    data = session.config.model_dump(by_alias=True, mode="json")
    kind, what = session.target
    spoken = {"text": what} if kind == "text" else {"utterance": what, "held_out": session.held_out}
    data["provenance"] = {**(provenance or {}), **(spoken if what else {})}
    config = config_from_dict(data, str(target))
    write_config(target, config)
    return target, config
