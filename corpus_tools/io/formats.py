"""Registries of readers and writers: a new format is one file with a function, and one entry here."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Protocol

import numpy as np

from corpus_tools.core import Audio, Capture, FloatArray, InputError, Labels, MotionError, Registry

__all__ = [
    "AUDIO_READERS",
    "LABEL_READERS",
    "LARGEST_BYTES",
    "LARGEST_SOUND_BYTES",
    "LARGEST_UNPACKED_BYTES",
    "MOTION_READERS",
    "MOTION_WRITERS",
    "MotionReader",
    "MotionWriter",
    "check_unpacked",
    "read_audio",
    "read_labels",
    "read_markers",
]

LARGEST_BYTES = 1 << 30
"""Motion and label files above this size are refused before they are opened (our choice: three hours of 70
markers at 120 Hz as C3D)."""

LARGEST_UNPACKED_BYTES = 1 << 30
"""Packed files (npz, MATLAB) that hold more are refused before they are unpacked (our choice: an hour and a
half of 70 markers at 120 Hz in 8 bytes a number)."""

LARGEST_SOUND_BYTES = 1 << 31
"""Sound of more samples, at 4 bytes each, is refused by its header (our choice: three hours of one channel at
48 kHz)."""

SOUND_RATES_HZ = (1000, 768_000)
"""Lowest and highest sampling rate that can be meant (our choice)."""


class MotionReader(Protocol):
    """Reads one motion file into mm; `rate_hz` and `units` are the caller's, and stand above the file's.

    What had to be guessed, mended or left out is told in the first step of the history.
    """

    def __call__(self, path: Path, *, rate_hz: float | None = None, units: str = "") -> Capture:
        """Return the motion of `path`."""


class MotionWriter(Protocol):
    """Writes positions (n_frames, n_markers, 3) in mm, NaN where missing, as one motion file."""

    def __call__(
        self, path: str | Path, positions_mm: FloatArray, names: Sequence[str], rate_hz: float
    ) -> None:
        """Write `path`, whole or not at all."""


MOTION_READERS: Registry[MotionReader] = Registry("motion format")
MOTION_WRITERS: Registry[MotionWriter] = Registry("motion format for writing")
LABEL_READERS: Registry[Callable[[Path], Labels]] = Registry("label format")
AUDIO_READERS: Registry[Callable[[Path], Audio]] = Registry("sound format")


def check_unpacked(path: Path, n_bytes: int) -> None:
    """Refuse what would hold more than :data:`LARGEST_UNPACKED_BYTES` in memory.

    Raises
    ------
    MotionError
        The message names the file and both sizes.
    """
    if n_bytes > LARGEST_UNPACKED_BYTES:
        raise MotionError(
            f"'{path}' holds {n_bytes / 2**30:.1f} GB when it is unpacked, more than the "
            f"{LARGEST_UNPACKED_BYTES / 2**30:.3g} GB that are read at once; cut it into recordings of one "
            "sentence each."
        )


def _reader_for(path: Path, readers: Registry, what: str) -> Callable[..., object]:  # type: ignore[type-arg]
    if not os.path.exists(path):  # noqa: PTH110 - False also for names that no file system takes
        raise InputError(f"There is no {what} file '{path}'; check the path.")
    if not path.is_file():
        raise InputError(f"'{path}' is not a file; a {what} file was expected.")
    suffix = path.suffix.lower()
    if suffix not in readers:
        known = ", ".join(readers)
        raise InputError(f"'{path}' has the suffix '{suffix}'; {what} files that can be read: {known}.")
    size = path.stat().st_size
    if size == 0:
        raise InputError(f"The {what} file '{path}' is empty.")
    if size > LARGEST_BYTES and readers is not AUDIO_READERS:
        raise InputError(
            f"The {what} file '{path}' has {size / 2**30:.1f} GB, more than the {LARGEST_BYTES >> 30} GB "
            "that are read at once; cut it into recordings of one sentence each."
        )
    reader: Callable[..., object] = readers[suffix]
    return reader


def read_markers(path: str | Path, *, rate_hz: float | None = None, units: str = "") -> Capture:
    """Read a motion file of any registered format; which layout it has is seen from its content.

    Parameters
    ----------
    path : path
    rate_hz : float, optional
        Frame rate, for files that do not say it; where both do, this one is taken and the history tells.
    units : {"", "mm", "cm", "m", "inch"}
        Unit of the positions, likewise; empty: the file says it.

    Returns
    -------
    Capture
        Positions in mm, NaN where a marker is missing. The step ``read`` of its history has ``notes``:
        sentences on what was doubtful in the file.

    Raises
    ------
    InputError
        The file is missing, empty, too large, of an unknown format or not what its suffix says; the message
        names it.
    """
    file = Path(path)
    reader = _reader_for(file, MOTION_READERS, "motion")
    with np.errstate(all="ignore"):  # numbers of damaged files: what is infinite or none is looked at after
        capture = reader(file, rate_hz=rate_hz, units=units)
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
    slowest, fastest = SOUND_RATES_HZ
    if not slowest <= audio.rate_hz <= fastest:
        raise InputError(
            f"'{file}' says that its sound has {audio.rate_hz} samples per second; {slowest} to {fastest} "
            "were expected: its header is damaged, export it again."
        )
    return audio
