"""The film of an utterance: pictures drawn in software and encoded."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from corpus_tools.cli.bench.rows import BENCHMARKS, TARGET_S, Ground, Row
from corpus_tools.config import config_with
from corpus_tools.core import Audio, MissingExtraError
from corpus_tools.io import write_wav
from corpus_tools.pipeline import synthesise
from corpus_tools.render import check_exports, write_film

__all__ = ["measure_film"]

BAR_MS = 1000 * 15.0 * TARGET_S / 3.0
"""15 s for a film of 3 s."""


@BENCHMARKS.register("film")
def measure_film(ground: Ground) -> list[Row]:
    """Measure a film of the target at its usual size; nothing where films cannot be made."""
    film = ground.config.film
    config = config_with(
        ground.config,
        film__rate_hz=max(1.0, ground.scale * film.rate_hz),
        film__width=max(64, 2 * round(0.5 * ground.scale * film.width)),
        film__height=max(64, 2 * round(0.5 * ground.scale * film.height)),
    )
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        try:
            check_exports(["mp4"], folder)
        except MissingExtraError:
            return []
        made = synthesise(ground.corpus, ground.target, config, ground.head, ground.held_out)
        write_wav(folder / "speech.wav", Audio(np.zeros(16000, np.float32), 16000))
        facts: list[dict[str, float]] = []
        once = Ground(ground.corpus, repeats=1)
        ours = once.best_ms(lambda: facts.append(write_film(folder, made, ground.head, config, _quiet)))
    size = f"{config.film.width} x {config.film.height}"
    return [Row(f"film of {TARGET_S:g} s, {facts[0]['pictures']} pictures of {size}", ours, bar=BAR_MS)]


def _quiet(fraction: float, what: str) -> None:
    """Take the progress and say nothing."""
