"""TOML files that a user names: read whole, or one clause on why not."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

__all__ = ["TomlFileError", "read_toml"]

LARGEST_BYTES = 1 << 24
"""No settings fill 16 MB (our choice)."""


class TomlFileError(ValueError):
    """Why a file cannot be used, as a clause that follows its name."""


def read_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file; what is no regular file (a pipe, a device) is not opened.

    Raises
    ------
    FileNotFoundError
        There is none.
    TomlFileError
        It cannot be read, or is no TOML; the message is a clause without the name of the file.
    """
    try:
        if path.exists() and not path.is_file():
            raise TomlFileError(f"cannot be read: it is {'a folder' if path.is_dir() else 'no regular file'}")
        if path.stat().st_size > LARGEST_BYTES:
            raise TomlFileError(f"cannot be read: it has more than {LARGEST_BYTES >> 20} MB")
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except (FileNotFoundError, TomlFileError):
        raise
    except UnicodeDecodeError:
        raise TomlFileError("cannot be read: it is not UTF-8 text; save it again as UTF-8") from None
    except tomllib.TOMLDecodeError as error:
        raise TomlFileError(f"is not TOML: {error}") from None
    except OSError as error:
        raise TomlFileError(f"cannot be read: {error.strerror or error}") from None
    except RecursionError:
        raise TomlFileError("cannot be read: its brackets are too deep") from None
    except ValueError:  # Python refuses to read thousands of digits, and no path holds a NUL
        raise TomlFileError("is not TOML: a number in it is too long") from None
