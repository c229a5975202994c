"""Cleaning: the Kalman smoother on a long capture, and what it leaves of a gap of known truth."""

from __future__ import annotations

import importlib
import importlib.util

import numpy as np

from corpus_tools.cleaning import smooth_channels
from corpus_tools.cleaning.kalman import process_noise
from corpus_tools.cli.bench.rows import BENCHMARKS, Ground, Row
from corpus_tools.core import FloatArray

__all__ = ["measure_kalman"]

N_FRAMES, N_CHANNELS = 24_000, 219
RATE_HZ, CUTOFF_HZ = 120.0, 10.0
PEER_SHARE = 0.1


def _walks(n_frames: int) -> FloatArray:
    """Return channels of smooth motion with 0.1 mm of noise, (n_frames, N_CHANNELS) mm."""
    random = np.random.default_rng(0)
    times = np.arange(n_frames)[:, None] / RATE_HZ
    rates, phases = random.uniform(0.5, 4.0, N_CHANNELS), random.uniform(0, 6.28, N_CHANNELS)
    motion = 5.0 * np.sin(2 * np.pi * rates * times + phases)
    return np.asarray(motion + random.normal(0.0, 0.1, motion.shape))


def _peer_ms(ground: Ground, values: FloatArray) -> float | None:
    """Return the time of simdkalman for the same model on a tenth of the frames, times ten."""
    if importlib.util.find_spec("simdkalman") is None:
        return None
    model = importlib.import_module("simdkalman").KalmanFilter(
        state_transition=np.array([[1.0, 1.0, 0.5], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]]),
        process_noise=process_noise(RATE_HZ, CUTOFF_HZ),
        observation_model=np.array([[1.0, 0.0, 0.0]]),
        observation_noise=1.0,
    )
    part = values[: round(PEER_SHARE * len(values))].T
    once = Ground(ground.corpus, repeats=1)
    return once.best_ms(lambda: model.smooth(part)) / PEER_SHARE


@BENCHMARKS.register("kalman")
def measure_kalman(ground: Ground) -> list[Row]:
    """Measure the smoother on 219 channels of 24000 frames; its peer where that is installed."""
    values = _walks(round(ground.scale * N_FRAMES))
    seen = np.ones(len(values), dtype=np.bool_)
    ours = ground.best_ms(lambda: smooth_channels(values, seen, RATE_HZ, CUTOFF_HZ))
    peer = _peer_ms(ground, values) if ground.full else None
    what = f"Kalman smoother, {N_CHANNELS} channels x {len(values)} frames"
    if peer is None:
        note = "simdkalman is not installed" if ground.full else "simdkalman: --full"
        return [Row(what, ours, bar=1000.0, note=note)]
    note = "the peer on a tenth of the frames, times ten"
    return [Row(what, ours, bar=1000.0, peer="simdkalman", peer_measured=peer, least_ratio=100.0, note=note)]
