"""Config files: TOML with every value, written whole or not at all."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import tomli_w

from corpus_tools.config.model import ConfigBase, config_from_dict
from corpus_tools.core import ConfigError, atomic_file
from corpus_tools.core.toml_file import TomlFileError, read_toml

__all__ = ["config_text", "load_config", "write_config"]

_HEADER = (
    "# A config of the visual speech workbench: every value that changes the result.\n"
    "# Replay it with: corpus-tools synth CORPUS --utterance NAME --config THIS_FILE --out FOLDER\n\n"
)


def load_config(path: str | Path) -> ConfigBase:
    """Read a config file.

    Raises
    ------
    ConfigError
        The file is missing, is not TOML, or holds an unknown key or a bad value; the message names it.
    """
    file = Path(path)
    try:
        data = read_toml(file)
    except FileNotFoundError:
        raise ConfigError(f"There is no config file '{file}'; check the path given to --config.") from None
    except TomlFileError as error:
        raise ConfigError(
            f"The config file '{file}' {error}; give a file that the workbench exported."
        ) from None
    return config_from_dict(data, str(file))


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {k: _plain(v) for k, v in value.items() if v is not None}
    return value


def config_text(config: ConfigBase) -> str:
    """Return the TOML text of a config, provenance included, keys in the order of the sections."""
    data = config.model_dump(by_alias=True, mode="json")
    provenance = data.pop("provenance")
    if provenance:
        data["provenance"] = provenance
    return _HEADER + tomli_w.dumps(_plain(data))


def write_config(path: str | Path, config: ConfigBase) -> None:
    """Write `config` to `path` atomically; OutputError when it cannot be written."""
    with atomic_file(path) as temporary:
        temporary.write_text(config_text(config), encoding="utf-8")
