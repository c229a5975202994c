"""Registries of readers: a new format is one file with a function, and one entry here by its suffix."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from corpus_tools.core import Audio, Capture, InputError, Labels, Registry

__all__ = ["AUDIO_READERS", "LABEL_READERS", "MOTION_READERS", "read_audio", "read_labels", "read_markers"]

MOTION_READERS: Registry[Callable[[Path], Capture]] = Registry("motion format")
LABEL_READERS: Registry[Callable[[Path], Labels]] = Registry("label format")
AUDIO_READERS: Registry[Callable[[Path], Audio]] = Registry("sound format")


def _reader_for(path: Path, readers: Registry, what: str) -> Callable[[Path], object]:  # type: ignore[type-arg]
    if not os.path.exists(path):  # noqa: PTH110 - False also for names that no file system takes
        raise InputError(f"There is no {what} file '{path}'; check the path.")
    if not path.is_file():
        raise InputError(f"'{path}' is not a file; a {what} file was expected.")
    suffix = path.suffix.lower()
    if suffix not in readers:
        known = ", ".join(readers)
        raise InputError(f"'{path}' has the suffix '{suffix}'; {what} files that can be read: {known}.")
    if path.stat().st_size == 0:
        raise InputError(f"The {what} file '{path}' is empty.")
    reader: Callable[[Path], object] = readers[suffix]
    return reader


def read_markers(path: str | Path) -> Capture:
    """Read a motion file of any registered format.

    Parameters
    ----------
    path : path

    Returns
    -------
    Capture
        Positions in the unit of the file, NaN where a marker is missing.

    Raises
    ------
    InputError
        The file is missing, empty, of an unknown format or not what its suffix says; the message names it.
    """
    file = Path(path)
    capture = _reader_for(file, MOTION_READERS, "motion")(file)
    assert isinstance(capture, Capture)
    return capture


def read_labels(path: str | Path) -> Labels:
    """Read a label file of any registered format; errors as :func:`read_markers`."""
    file = Path(path)
    labels = _reader_for(file, LABEL_READERS, "label")(file)
    assert isinstance(labels, Labels)
    return labels


def read_audio(path: str | Path) -> Audio:
    """Read a sound file of any registered format, mixed to mono; errors as :func:`read_markers`."""
    file = Path(path)
    audio = _reader_for(file, AUDIO_READERS, "sound")(file)
    assert isinstance(audio, Audio)
    return audio
