"""Task dynamics of a simulated mouth: overlapping gestures pull critically damped articulators to targets.

Deliberately another model than any synthesiser of this project: second-order dynamics after Saltzman and
Munhall (1989), with activations that overlap and vary from token to token.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from corpus_tools.core import FloatArray, Interval, Tier
from corpus_tools.demo.sentences import Sentence, load_data

__all__ = ["DIMENSIONS", "articulate", "time_phones"]

DIMENSIONS = ("jaw", "close", "round", "spread", "bite")
"""Articulators, each from 0 to 1."""

_STIFFNESS_HZ = {"jaw": 5.0, "close": 8.5, "round": 4.0, "spread": 4.5, "bite": 8.0}
_LEAD_S = {"jaw": 0.045, "close": 0.04, "round": 0.09, "spread": 0.07, "bite": 0.04}
_LAG_S = {"jaw": 0.02, "close": 0.0, "round": 0.05, "spread": 0.04, "bite": 0.0}


def time_phones(sentence: Sentence, rng: np.random.Generator) -> tuple[Tier, Tier]:
    """Return phones and words with times: mean durations, 15 % variation, one speaking rate per sentence."""
    table = load_data("gestures")["phones"]
    rate = float(np.exp(rng.normal(0.0, 0.08)))
    at = float(rng.uniform(0.35, 0.5))
    phones, words = [Interval(0.0, at, "SIL")], []
    for word, spoken in zip(sentence.words, sentence.phones, strict=True):
        begin = at
        for phone in spoken:
            length = 1e-3 * table[phone]["duration_ms"] * rate * float(np.exp(rng.normal(0.0, 0.15)))
            phones.append(Interval(at, at + length, phone))
            at += length
        words.append(Interval(begin, at, word))
    phones.append(Interval(at, at + float(rng.uniform(0.35, 0.5)), "SIL"))
    return Tier("phones", tuple(phones)), Tier("words", tuple(words))


def _targets(
    phones: Sequence[Interval], times: FloatArray, dimension: str, rng: np.random.Generator
) -> FloatArray:
    """Return what the active gestures ask of one articulator over time; 0 (rest) where none is active."""
    table = load_data("gestures")["phones"]
    asked, strength = np.zeros(len(times)), np.full(len(times), 1e-6)
    for phone in phones:
        goal = table[phone.text].get(dimension)
        if goal is None:
            continue
        varied = goal if goal in (0.0, 1.0) else float(np.clip(goal * (1 + rng.normal(0, 0.1)), 0, 1))
        lead = _LEAD_S[dimension] * float(np.exp(rng.normal(0, 0.15)))
        low, high = phone.start_s - lead, phone.end_s - 0.35 * lead + _LAG_S[dimension]
        edge = 0.015
        active = np.clip((times - low) / edge, 0, 1) * np.clip((high - times) / edge, 0, 1)
        weight = active * (4.0 if goal >= 0.9 else 1.0)
        asked += weight * varied
        strength += weight
    return np.asarray(asked / strength)


def articulate(phones: Tier, rate_hz: float, rng: np.random.Generator) -> FloatArray:
    """Return the articulators over time, (n_frames, 5), in the order of :data:`DIMENSIONS`.

    Each follows ``x'' = w^2 (target - x) - 2 w x'`` (critically damped), integrated at 8 steps a frame.
    """
    duration = phones.intervals[-1].end_s
    steps = 8
    n = int(np.floor(duration * rate_hz)) + 1
    dt = 1.0 / (rate_hz * steps)
    times = np.asarray(np.arange(n * steps) * dt, dtype=np.float64)
    out = np.zeros((n, len(DIMENSIONS)))
    for column, dimension in enumerate(DIMENSIONS):
        target = _targets(phones.intervals, times, dimension, rng)
        omega = 2 * np.pi * _STIFFNESS_HZ[dimension] * float(np.exp(rng.normal(0, 0.05)))
        position, velocity = 0.0, 0.0
        for k, goal in enumerate(target):
            velocity += dt * (omega**2 * (goal - position) - 2 * omega * velocity)
            position += dt * velocity
            if k % steps == 0:
                out[k // steps, column] = position
    return np.clip(out, 0.0, 1.0)
