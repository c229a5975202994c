"""What ``synth --export`` can write beside its own files, by name."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from corpus_tools.config import ConfigBase
from corpus_tools.core import InputError, MissingExtraError, OutputError, Registry
from corpus_tools.io import MOTION_WRITERS
from corpus_tools.pipeline import Head, Progress, Synthesis
from corpus_tools.render.encoder import ffmpeg_path
from corpus_tools.render.film import write_film, write_frames
from corpus_tools.render.probe import probe_offscreen
from corpus_tools.render.strip import write_strip

__all__ = ["EXPORTERS", "Exporter", "check_exports", "export_all", "export_names", "is_export_folder"]


@dataclass(frozen=True, slots=True)
class Exporter:
    """One kind of file that a synthesis can be written as.

    Attributes
    ----------
    summary : str
        One sentence for ``--help`` and lists.
    write : callable
        ``write(folder, synthesis, head, config, progress) -> facts``: adds its files to a folder in which
        ``speech.wav`` and the others stand already; what it returns goes into the manifest.
    check : callable
        Raises before any work what would keep it from working here.
    folder : str
        Name of the folder that it makes; empty when it writes files only.
    in_folder : str
        Pattern of the names of the files in it: a folder that holds nothing else may be replaced.
    """

    summary: str
    write: Callable[[Path, Synthesis, Head, ConfigBase, Progress], dict[str, Any]]
    check: Callable[[], object] = lambda: None
    folder: str = ""
    in_folder: str = ""


def _can_draw() -> None:
    status = probe_offscreen()
    if not status.ok:
        raise MissingExtraError(status.reason)


def _can_film() -> None:
    ffmpeg_path()
    _can_draw()


EXPORTERS: Registry[Exporter] = Registry("export")
EXPORTERS.add("mp4", Exporter("The head speaking, with its sound: film.mp4.", write_film, _can_film))
EXPORTERS.add(
    "frames",
    Exporter(
        "The pictures of the film as PNG files.", write_frames, _can_draw, "frames", r"frame-\d{5,}\.png"
    ),
)
EXPORTERS.add(
    "strip",
    Exporter(
        "Poses across the utterance with the paths of lips and jaw: strip.svg, .png.", write_strip, _can_draw
    ),
)


MOTION_FILES = {
    "c3d": ("motion.c3d", "Marker motion as C3D: motion.c3d."),
    "trc": ("motion.trc", "Marker motion as TRC: motion.trc."),
    "csv": ("motion.csv", "Marker motion as a table with a row a frame: motion.csv."),
    "csv-long": (
        "motion-long.csv",
        "Marker motion as a table with a row a marker and frame: motion-long.csv.",
    ),
}


def _write_motion(
    name: str, folder: Path, synthesis: Synthesis, head: Head, config: ConfigBase, progress: Progress
) -> dict[str, Any]:
    """Write the markers of ``motion.npz`` in another format: mm, in the actor's head-stabilised space."""
    motion, file = synthesis.trajectory, MOTION_FILES[name][0]
    progress(0.0, file)
    MOTION_WRITERS[name](folder / file, np.asarray(motion.values_mm), motion.names, motion.rate_hz)
    return {"file": file, "rate_hz": motion.rate_hz}


for _name in MOTION_FILES:
    EXPORTERS.add(_name, Exporter(MOTION_FILES[_name][1], functools.partial(_write_motion, _name)))


def export_names(given: str | None) -> tuple[str, ...]:
    """Return the names in a list such as "mp4,frames", each once, in the order given.

    Raises
    ------
    InputError
        One of them is unknown, or there is none; the sentence lists those that are there.
    """
    if given is None:
        return ()
    names = [n.strip() for n in given.split(",") if n.strip()]
    if not names:
        raise InputError(f"--export '{given}' names nothing; known, by comma: {', '.join(EXPORTERS)}.")
    for name in names:
        EXPORTERS[name]
    return tuple(dict.fromkeys(names))


def is_export_folder(folder: Path) -> bool:
    """Say whether a folder is what an export made, or empty: no file in it is of another name."""
    patterns = [e.in_folder for e in EXPORTERS.values() if e.folder == folder.name]
    if folder.is_symlink() or not folder.is_dir() or not patterns:
        return False
    return all(
        path.is_file() and not path.is_symlink() and any(re.fullmatch(p, path.name) for p in patterns)
        for path in folder.iterdir()
    )


def check_exports(names: Iterable[str], out: Path) -> None:
    """Raise what would keep exports from working, before anything is computed.

    Raises
    ------
    MissingExtraError
        An extra or a system package is missing; the sentence names it.
    OutputError
        A folder that would be made is there already, and something else than such an export lies in it.
    """
    for name in names:
        exporter = EXPORTERS[name]
        exporter.check()
        folder = out / exporter.folder
        if exporter.folder and folder.exists() and not is_export_folder(folder):
            raise OutputError(
                f"'{folder}' is there already, and something in it is not of an earlier export '{name}'; "
                "remove it, or choose another folder for --out."
            )


def export_all(
    names: Iterable[str],
    folder: Path,
    synthesis: Synthesis,
    head: Head,
    config: ConfigBase,
    progress: Progress = lambda fraction, what: None,
) -> dict[str, Any]:
    """Write the exports into a folder one after the other.

    Returns
    -------
    dict
        By name, what each says of its files.
    """
    wanted = list(names)

    def part(index: int) -> Progress:
        return lambda fraction, what: progress((index + fraction) / len(wanted), what)

    return {n: EXPORTERS[n].write(folder, synthesis, head, config, part(i)) for i, n in enumerate(wanted)}
