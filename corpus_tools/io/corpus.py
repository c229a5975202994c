"""Finding the recordings of a corpus, loading them, and making a corpus over an existing folder."""

from __future__ import annotations

import contextlib
import glob
import os
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from corpus_tools.core import (
    Audio,
    Capture,
    CorpusError,
    InputError,
    LabelError,
    Labels,
    MotionError,
    counted,
)
from corpus_tools.core.errors import suggestion
from corpus_tools.io.description import (
    CORPUS_FILE,
    DEFAULT_WORD_TIER,
    CorpusDescription,
    description_from_dict,
    parsed_axes,
    write_description,
)
from corpus_tools.io.formats import (
    AUDIO_READERS,
    LABEL_READERS,
    MOTION_READERS,
    read_audio,
    read_labels,
    read_markers,
)

__all__ = [
    "RecordingFiles",
    "check_word_tier",
    "find_recordings",
    "init_corpus",
    "load_audio",
    "load_capture",
    "load_labels",
]

MOST_LOOKED_AT = 20
"""Label files that `init` reads to see whether the tiers it was told are there (our choice: at once)."""


FARTHEST_MM = 1e6
"""No face is captured a kilometre from the origin (our choice): such numbers are another unit, or damage."""

_SETTABLE = (
    "frame_time",
    "head_scale",
    "phones",
    "marker_units",
    "marker_axes",
    "rate_hz",
    "reference_markers",
    "language",
    "name",
    "phone_tier",
    "word_tier",
    "audio_offset_s",
)

_READERS: dict[str, Collection[str]] = {
    "motion": MOTION_READERS,
    "audio": AUDIO_READERS,
    "labels": LABEL_READERS,
}
"""Suffixes that can be read, by what they are read as."""

_NUMBERS = {
    "audio_offset_s": "seconds were expected, as in 0.02",
    "rate_hz": "a number of Hz was expected, as in 120",
}


@dataclass(frozen=True, slots=True, order=True)
class RecordingFiles:
    """The files of one recording; audio and labels are None where the file is not there."""

    id: str
    motion: Path
    audio: Path | None = None
    labels: Path | None = None


def _absolute(description: CorpusDescription, pattern: str) -> Path:
    path = Path(pattern)
    return path if path.is_absolute() else description.folder / path


def _ids(pattern: Path) -> dict[str, Path]:
    """Return id -> path of every file that a pattern matches; an id holds no path separator."""
    parts = pattern.parts
    first = next(i for i, part in enumerate(parts) if "{id}" in part)
    root = Path(*parts[:first]) if first else Path()
    if not os.path.isdir(root):  # noqa: PTH112 - False also for names that no file system takes
        return {}
    wildcard = "/".join(glob.escape(part).replace("{id}", "*") for part in parts[first:])
    text = re.escape("/".join(parts[first:])).replace(re.escape("{id}"), "(?P<id>[^/]+)", 1)
    regex = re.compile(text.replace(re.escape("{id}"), "(?P=id)") + r"\Z")
    found = {}
    for path in root.glob(wildcard):
        match = regex.match(path.relative_to(root).as_posix())
        if match and path.is_file() and not path.name.startswith("."):
            found[match["id"]] = path
    return found


def _optional(description: CorpusDescription, pattern: str, name: str) -> Path | None:
    if not pattern:
        return None
    path = Path(str(_absolute(description, pattern)).replace("{id}", name))
    return path if os.path.isfile(path) else None  # noqa: PTH113 - as above


def find_recordings(description: CorpusDescription) -> list[RecordingFiles]:
    """Return the files of every recording, sorted by id.

    Raises
    ------
    CorpusError
        The motion pattern matches no file; the message says where was looked.
    """
    pattern = _absolute(description, description.motion)
    found = _ids(pattern)
    if not found:
        raise CorpusError(
            f"No motion files in the corpus '{description.folder}': '{pattern}' matches nothing; "
            f"check 'motion' in '{description.file}'."
        )
    return [
        RecordingFiles(
            name,
            found[name],
            _optional(description, description.audio, name),
            _optional(description, description.labels, name),
        )
        for name in sorted(found)
    ]


def load_audio(files: RecordingFiles) -> Audio | None:
    """Return the sound of a recording, or None when it has none."""
    return read_audio(files.audio) if files.audio else None


def load_capture(description: CorpusDescription, files: RecordingFiles) -> Capture:
    """Read the motion of a recording: mm, y up, on the clock of its audio, audio attached.

    What the file does not say comes from ``marker_units``, ``marker_axes`` and ``rate_hz``. Frame times
    follow ``frame_time`` (GRID video frames are centred) and ``audio_offset_s``.

    Raises
    ------
    InputError
        A file cannot be read, or a marker lies impossibly far away.
    """
    capture = read_markers(files.motion, rate_hz=description.rate_hz or None, units=description.marker_units)
    farthest = np.abs(np.nan_to_num(capture.positions_mm)).max()
    if farthest > FARTHEST_MM:
        raise MotionError(
            f"'{files.motion}' has a marker {farthest:.3g} mm from the origin, where a face within "
            f"{FARTHEST_MM:.0e} mm was expected; check 'marker_units' in '{description.file}'."
        )
    columns, signs = parsed_axes(description.marker_axes, f"'{description.file}'")
    half = 0.5 / capture.rate_hz if description.frame_time == "centre" else 0.0
    return replace(
        capture,
        positions_mm=capture.positions_mm[:, :, list(columns)] * np.array(signs),
        start_s=half + description.audio_offset_s,
        audio=load_audio(files),
    )


def load_labels(description: CorpusDescription, files: RecordingFiles) -> Labels:
    """Read the labels of a recording.

    Raises
    ------
    LabelError
        It has none; the message says which file was expected.
    """
    if files.labels is None:
        if not description.labels:
            raise LabelError(f"'{files.id}' has no labels: '{description.file}' names no pattern 'labels'.")
        path = str(_absolute(description, description.labels)).replace("{id}", files.id)
        raise LabelError(f"'{files.id}' has no labels: '{path}' is not there.")
    return read_labels(files.labels)


def _setting(key: str, text: str) -> Any:
    if key not in _SETTABLE:
        hint = suggestion(key, _SETTABLE)
        raise CorpusError(
            f"--set {key}={text}: unknown key '{key}'{hint or '; known: ' + ', '.join(_SETTABLE) + '.'}"
        )
    if key == "head_scale":
        if text.lower() not in ("true", "false"):
            raise CorpusError(f"--set head_scale={text}: true or false was expected.")
        return text.lower() == "true"
    if key in _NUMBERS:
        try:
            return float(text)
        except ValueError:
            raise CorpusError(f"--set {key}={text}: {_NUMBERS[key]}.") from None
    return text


def _stored(pattern: str | None, folder: Path) -> str:
    """Return a pattern as it is kept: relative to `folder` when below it, else absolute."""
    if not pattern:
        return ""
    absolute = Path.cwd() / Path(pattern).expanduser()
    if ".." in absolute.parts and "\0" not in pattern:
        absolute = absolute.resolve()
    try:
        return absolute.relative_to(folder.resolve()).as_posix()
    except ValueError:
        return absolute.as_posix()


def init_corpus(
    folder: str | Path,
    *,
    motion: str,
    audio: str | None = None,
    labels: str | None = None,
    settings: Mapping[str, str] | None = None,
    force: bool = False,
) -> CorpusDescription:
    """Make a corpus over existing recordings: writes ``corpus.toml`` into `folder` and nothing else.

    Parameters
    ----------
    folder : path
        Made when it does not exist.
    motion, audio, labels : str
        Patterns with ``{id}``; relative ones start from the present working directory.
    settings : mapping of str to str
        Further keys of ``corpus.toml``, as after ``--set``.
    force : bool
        Replace a ``corpus.toml`` that is there.

    Raises
    ------
    CorpusError
        There is a corpus already, a key or value is unknown, or a pattern or a tier matches nothing.
    """
    place = Path(folder)
    if os.path.exists(place / CORPUS_FILE) and not force:  # noqa: PTH110 - as above
        raise CorpusError(f"'{place / CORPUS_FILE}' is there already; edit it, or choose another folder.")
    data: dict[str, Any] = {key: _setting(key, text) for key, text in (settings or {}).items()}
    data |= {
        "motion": _stored(motion, place),
        "audio": _stored(audio, place),
        "labels": _stored(labels, place),
    }
    description = description_from_dict(data, place, where="corpus-tools init")
    pattern = _absolute(description, description.motion)
    if not _ids(pattern):
        raise CorpusError(
            f"corpus-tools init: --motion '{motion}' matches no file: looked for '{pattern}', "
            "where {id} stands for a recording's name; check the path."
        )
    _check_files(description, {"audio": audio, "labels": labels})
    write_description(description)
    return description


def _check_files(description: CorpusDescription, typed: Mapping[str, str | None]) -> None:
    """Refuse patterns and tiers that no recording has anything for, before anything is written."""
    found = find_recordings(description)
    for what, readers in _READERS.items():
        paths = [path for files in found if (path := getattr(files, what))]
        if paths and not any(path.suffix.lower() in readers for path in paths):
            raise CorpusError(
                f"corpus-tools init: --{what} finds '{paths[0]}', which has the suffix '{paths[0].suffix}'; "
                f"what can be read: {', '.join(readers)}."
            )
    for what, pattern in typed.items():
        if pattern and not any(getattr(files, what) for files in found):
            looked = str(_absolute(description, getattr(description, what))).replace("{id}", found[0].id)
            raise CorpusError(
                f"corpus-tools init: --{what} '{pattern}' matches no file: looked for '{looked}', and so on "
                f"for {counted(len(found), 'recording')} of --motion; check the path, or leave --{what} out."
            )
    labelled = []
    for files in [f for f in found if f.labels][:MOST_LOOKED_AT]:
        with contextlib.suppress(InputError):  # `check` names the damaged ones
            labelled.append(load_labels(description, files))
    check_word_tier(description, labelled, "corpus-tools init")
    phone_tier = description.phone_tier
    if labelled and not any(phone_tier in labels.names for labels in labelled):
        raise CorpusError(
            f"corpus-tools init: no label file has the tier '{phone_tier}'; they have {_tiers(labelled)}: "
            "name that of the phones with --set phone_tier=NAME."
        )


def _tiers(labels: Iterable[Labels]) -> str:
    return (
        ", ".join(repr(name) for name in dict.fromkeys(n for found in labels for n in found.names)) or "none"
    )


def check_word_tier(
    description: CorpusDescription, labels: Sequence[Labels], where: str | None = None
) -> None:
    """Refuse a word tier that somebody named and no labels have; the usual one may be missing.

    Raises
    ------
    CorpusError
        The message names the tiers that there are.
    """
    wanted = description.word_tier
    if not wanted or wanted == DEFAULT_WORD_TIER or not labels:
        return
    if not any(wanted in found.names for found in labels):
        raise CorpusError(
            f"{where or repr(str(description.file))}: no label file has the tier word_tier = '{wanted}'; "
            f"they have {_tiers(labels)}: name that of the words, or leave it empty ('')."
        )
