"""``corpus.toml``: what a corpus is called, where its files are, and how their times and units are meant."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from pathlib import Path
from typing import Any

import tomli_w

from corpus_tools.core import CorpusError, atomic_file
from corpus_tools.core.errors import suggestion
from corpus_tools.core.toml_file import TomlFileError, read_toml
from corpus_tools.io.motion_parts import mm_per

__all__ = [
    "CORPUS_FILE",
    "DEFAULT_WORD_TIER",
    "SCHEMA",
    "CorpusDescription",
    "description_from_dict",
    "parsed_axes",
    "read_description",
    "write_description",
]

CORPUS_FILE = "corpus.toml"
SCHEMA = 1
DEFAULT_WORD_TIER = "words"
"""The only word tier that labels may lack: nobody has to have words."""
FASTEST_HZ = 1e5
LONGEST_OFFSET_S = 3600.0

_CHOICES = {"frame_time": ("start", "centre")}
_NEEDED = ("motion", "phones", "phone_tier", "language", "reference_markers")
_HEADER = (
    "# A corpus of the visual speech workbench: it describes recordings and leaves them where they are.\n"
    "# '{id}' in a pattern stands for the name of a recording; relative patterns start from this folder.\n\n"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class CorpusDescription:
    """The content of a ``corpus.toml``.

    Attributes
    ----------
    folder : Path
        Where the file stands.
    name, language, phones : str
        Name of the corpus, its language, and the phone set of its labels.
    motion, audio, labels : str
        Patterns with ``{id}``; audio and labels may be empty.
    frame_time : {"start", "centre"}
        Frame i shows time i / rate, or (i + 0.5) / rate (video).
    head_scale : bool
        Head removal may scale (monocular video needs it, optical capture must not have it).
    marker_units : str
        Unit of the positions: mm, cm, m, inch, or a multiple such as "250 mm"; empty: the files say it.
    marker_axes : str
        Which axes of the motion files point to the side, up, and out of the face: "x,y,z", or for instance
        "x,z,-y" where z is up.
    rate_hz : float
        Frame rate of motion files that do not say it; 0: they say it.
    reference_markers : str
        Globs, comma separated, of the markers that move with the skull.
    phone_tier, word_tier : str
    audio_offset_s : float
        Added to motion times, s.
    exclude : tuple of str
        Recordings that are left out.
    """

    folder: Path
    motion: str
    audio: str = ""
    labels: str = ""
    name: str = ""
    language: str = "en"
    phones: str = "arpabet"
    frame_time: str = "start"
    head_scale: bool = False
    marker_units: str = ""
    marker_axes: str = "x,y,z"
    rate_hz: float = 0.0
    reference_markers: str = "head*"
    phone_tier: str = "phones"
    word_tier: str = DEFAULT_WORD_TIER
    audio_offset_s: float = 0.0
    exclude: tuple[str, ...] = ()
    schema: int = SCHEMA

    @property
    def file(self) -> Path:
        """Path of the ``corpus.toml``."""
        return self.folder / CORPUS_FILE


_KEYS = {f.name: f for f in fields(CorpusDescription) if f.name != "folder"}


def _check_value(where: str, key: str, value: Any) -> Any:
    default = _KEYS[key].default
    wanted = str if default is MISSING else type(default)
    if wanted is float and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)
    if wanted is tuple and isinstance(value, list) and all(isinstance(v, str) for v in value):
        value = tuple(value)
    if not isinstance(value, wanted) or (wanted is int and isinstance(value, bool)):
        words = {str: "text in quotes", bool: "true or false", float: "a number", int: "a whole number"}
        raise CorpusError(f"{where}: {key} = {value!r} is not {words.get(wanted, 'a list of names')}.")
    if key in _NEEDED and not value.strip():
        raise CorpusError(f"{where}: {key} is empty; {_wanted_word(key)} was expected.")
    if key == "marker_units" and value and mm_per(value) is None:
        raise CorpusError(f"{where}: marker_units = '{value}' is none of mm, cm, m, inch, or as '250 mm'.")
    if key in _CHOICES and value not in _CHOICES[key]:
        hint, known = suggestion(str(value), _CHOICES[key]), ", ".join(_CHOICES[key])
        raise CorpusError(f"{where}: {key} = '{value}' is none of {known}{hint or '.'}")
    if key == "marker_axes":
        parsed_axes(str(value), where)
    if isinstance(value, float):
        _check_number(where, key, value)
    return value


def _check_number(where: str, key: str, value: float) -> None:
    if not math.isfinite(value):
        raise CorpusError(f"{where}: {key} = {value} is not a finite number.")
    if key == "rate_hz" and not 0 <= value <= FASTEST_HZ:
        raise CorpusError(
            f"{where}: rate_hz = {value:g} is no frame rate; a positive number of Hz was expected."
        )
    if key == "audio_offset_s" and abs(value) > LONGEST_OFFSET_S:
        raise CorpusError(f"{where}: audio_offset_s = {value:g} is more than an hour; seconds were expected.")


def parsed_axes(text: str, where: str) -> tuple[tuple[int, int, int], tuple[float, float, float]]:
    """Return the columns and signs that ``marker_axes`` means.

    Raises
    ------
    CorpusError
        It does not name each axis once, or would turn the face into its mirror image.
    """
    words = [w.strip().lower() for w in text.split(",")]
    columns = ["xyz".find(w.lstrip("+-")) if len(w.lstrip("+-")) == 1 else -1 for w in words]
    signs = [-1.0 if w.startswith("-") else 1.0 for w in words]
    if sorted(columns) != [0, 1, 2] or any(len(w) > 2 for w in words):
        raise CorpusError(f"{where}: marker_axes = '{text}' is not of the form 'x,z,-y': each axis once.")
    a, b, c = columns
    even = (a, b, c) in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
    if (1.0 if even else -1.0) * signs[0] * signs[1] * signs[2] < 0:
        raise CorpusError(f"{where}: marker_axes = '{text}' mirrors the face: change the sign of one axis.")
    return (a, b, c), (signs[0], signs[1], signs[2])


def _wanted_word(key: str) -> str:
    return (
        "a pattern such as 'markers/{id}.npz'"
        if key == "motion"
        else f"a name such as '{_KEYS[key].default}'"
    )


def _check_pattern(where: str, key: str, pattern: str) -> None:
    if not pattern and key != "motion":
        return
    if "\0" in pattern:
        raise CorpusError(f"{where}: {key} = {pattern!r} holds a character that no path can hold.")
    if "{id}" not in pattern:
        raise CorpusError(f"{where}: {key} = '{pattern}' has no {{id}}, which stands for a recording's name.")


def description_from_dict(
    data: Mapping[str, Any], folder: Path, *, where: str | None = None
) -> CorpusDescription:
    """Make a description from the keys of a ``corpus.toml``.

    Parameters
    ----------
    data : mapping
    folder : Path
        Where the ``corpus.toml`` stands or will stand.
    where : str, optional
        What messages name as the place of a mistake; the file when not given.

    Raises
    ------
    CorpusError
        An unknown or misspelt key, a value of the wrong kind, a pattern without ``{id}``, a newer schema.
    """
    where = where or f"'{folder / CORPUS_FILE}'"
    for key in data:
        if key not in _KEYS:
            hint = suggestion(key, _KEYS)
            raise CorpusError(f"{where}: unknown key '{key}'{hint or '; known: ' + ', '.join(_KEYS) + '.'}")
    if "motion" not in data:
        raise CorpusError(
            f"{where} has no key 'motion': the pattern of the marker files, as in 'markers/{{id}}.npz'."
        )
    values = {key: _check_value(where, key, value) for key, value in data.items()}
    for key in ("motion", "audio", "labels"):
        _check_pattern(where, key, values.get(key, ""))
    if not 1 <= values.get("schema", SCHEMA) <= SCHEMA:
        raise CorpusError(
            f"{where} has schema {values['schema']}; this program knows up to {SCHEMA}: update it."
        )
    values["name"] = values.get("name", "").strip() or folder.resolve().name
    return CorpusDescription(folder=folder, **values)


def read_description(folder: str | Path) -> CorpusDescription:
    """Read the ``corpus.toml`` of a corpus folder.

    Raises
    ------
    CorpusError
        The folder or the file is missing, or the file is not right; the message says what to do.
    """
    place = Path(folder)
    if os.path.isfile(place):  # noqa: PTH113 - False also for names that no file system takes
        raise CorpusError(
            f"'{place}' is a file, no corpus folder; give the folder that holds "
            f"{CORPUS_FILE}, as 'corpus-tools init' makes it."
        )
    if not os.path.isdir(place):  # noqa: PTH112 - as above
        raise CorpusError(
            f"There is no corpus folder '{place}'; 'corpus-tools init' makes one over recordings."
        )
    file = place / CORPUS_FILE
    try:
        data = read_toml(file)
    except FileNotFoundError:
        raise CorpusError(
            f"'{place}' has no {CORPUS_FILE}, so it is not a corpus yet; make one with "
            f"'corpus-tools init {place} --motion PATTERN'."
        ) from None
    except TomlFileError as error:
        raise CorpusError(f"'{file}' {error}.") from None
    return description_from_dict(data, place)


def write_description(description: CorpusDescription) -> None:
    """Write the ``corpus.toml`` of a description into its folder, every key explicit.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    data: dict[str, Any] = {}
    for key in ("schema", "name", *[k for k in _KEYS if k not in ("schema", "name")]):
        value = getattr(description, key)
        data[key] = list(value) if isinstance(value, tuple) else value
    with atomic_file(description.file) as temporary:
        temporary.write_text(_HEADER + tomli_w.dumps(data), encoding="utf-8")
