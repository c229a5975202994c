"""The film of a synthesis: the head speaking with its sound, or the same pictures one by one."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from PIL import Image

from corpus_tools.config import ConfigBase
from corpus_tools.core import FloatArray
from corpus_tools.pipeline import Head, Progress, Synthesis
from corpus_tools.render.encoder import encoding
from corpus_tools.render.moving import MovingHead, poses_at

__all__ = ["film_times_s", "write_film", "write_frames"]


def film_times_s(duration_s: float, rate_hz: float) -> FloatArray:
    """Return the time of the pose that each picture of a film shows: the middle of the time it stands.

    As many pictures as are needed to cover the whole duration (the last may reach beyond it). With a film of
    30 pictures and motion of 120 frames per second every pose is a frame of the motion.
    """
    n = max(1, math.ceil(duration_s * rate_hz - 1e-6))
    return np.asarray((np.arange(n) + 0.5) / rate_hz)


def _duration_s(synthesis: Synthesis) -> float:
    """Return the length of motion or sound, whichever is longer: nothing of either is cut off."""
    audio = synthesis.utterance.audio
    return max(synthesis.utterance.duration_s, audio.duration_s if audio else 0.0)


def _pictures(
    synthesis: Synthesis, head: Head, config: ConfigBase, progress: Progress, what: str
) -> Iterator[npt.NDArray[np.uint8]]:
    film = config.film
    times = film_times_s(_duration_s(synthesis), film.rate_hz)
    size = (film.width, film.height)
    poses = synthesis.vertices_mm
    with MovingHead(head.mesh, poses, size=size, view=film.view, zoom_mm=film.zoom_mm) as moving:
        for k, time in enumerate(times):
            progress(k / len(times), f"{what}, picture {k + 1} of {len(times)}")
            (pose,) = poses_at(synthesis.trajectory.times_s, poses, [time])
            yield moving.draw(pose)


def write_film(
    folder: Path, synthesis: Synthesis, head: Head, config: ConfigBase, progress: Progress
) -> dict[str, Any]:
    """Write ``film.mp4``: H.264 and AAC, sound and picture of one length, both beginning at 0.

    The sound is ``speech.wav``, which stands in the folder already.

    Parameters
    ----------
    folder : Path
    synthesis, head, config
        Section `film` is used.
    progress : callable
        ``progress(fraction, what)``; may raise to cancel.

    Returns
    -------
    dict
        File, pictures and their rate.
    """
    film = config.film
    n = len(film_times_s(_duration_s(synthesis), film.rate_hz))
    path, size = folder / "film.mp4", (film.width, film.height)
    with encoding(path, size, film.rate_hz, folder / "speech.wav", n / film.rate_hz) as encoder:
        for picture in _pictures(synthesis, head, config, progress, "film"):
            encoder.add(picture)
    return {"file": path.name, "pictures": n, "rate_hz": film.rate_hz}


def write_frames(
    folder: Path, synthesis: Synthesis, head: Head, config: ConfigBase, progress: Progress
) -> dict[str, Any]:
    """Write ``frames/frame-00000.png`` and on: the pictures of the film, without loss.

    Parameters and result are those of :func:`write_film`.
    """
    (folder / "frames").mkdir()
    n = 0
    for picture in _pictures(synthesis, head, config, progress, "frames"):
        path = folder / "frames" / f"frame-{n:05d}.png"
        Image.fromarray(picture).save(path, format="PNG", compress_level=4)
        n += 1
    return {"file": "frames", "pictures": n, "rate_hz": config.film.rate_hz}
