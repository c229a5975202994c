"""Task dynamics of a simulated mouth: overlapping gestures pull critically damped articulators to targets.

Deliberately another model than any synthesiser of this project: second-order dynamics after Saltzman and
Munhall (1989), with activations that overlap, blend by strength and vary from token to token.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.signal import lfilter

from corpus_tools.core import FloatArray, Interval, Tier
from corpus_tools.demo.sentences import load_data

__all__ = ["DIMENSIONS", "articulate", "critically_damped"]

DIMENSIONS = ("jaw", "close", "round", "spread", "bite")
"""Articulators, each from 0 (rest) to 1."""

STEPS_PER_FRAME = 8

_STIFFNESS_HZ = {"jaw": 5.0, "close": 8.5, "round": 4.0, "spread": 4.5, "bite": 8.0}
_LEAD_S = {"jaw": 0.045, "close": 0.04, "round": 0.09, "spread": 0.07, "bite": 0.04}
_LAG_S = {"jaw": 0.02, "close": 0.0, "round": 0.05, "spread": 0.04, "bite": 0.0}
_EDGE_S = 0.015
_LEAST_S = {"close": 0.085, "bite": 0.085}
"""A constriction is asked for at least so long, however short its phone is: it has to be reached."""

_CONSTRICTION, _BEYOND = 0.9, 1.2
"""Targets from here on are constrictions, which must be met: they win over what blends with them, and aim
beyond contact (the virtual targets of Loefqvist and Gracco 1997), where the lips then stay."""


@dataclass(frozen=True, slots=True)
class _Gesture:
    """One articulator is asked for `target` from `start_s` to `end_s`, with `strength` against others."""

    start_s: float
    end_s: float
    target: float
    strength: float


def _phases(phone: Interval, dimension: str, table: Mapping[str, Any]) -> list[tuple[float, float, float]]:
    """Return (start_s, end_s, target) of what a phone asks of an articulator; a diphthong asks twice."""
    entry = table[phone.text]
    begin, glide = entry.get(dimension), entry.get("glide", {})
    end = glide.get(dimension, begin)
    if begin is None and end is None:
        return []
    if not glide:
        return [(phone.start_s, phone.end_s, begin)]
    middle = phone.start_s + 0.55 * phone.duration_s
    halves = [(phone.start_s, middle, begin), (middle, phone.end_s, end)]
    return [h for h in halves if h[2] is not None]


def _gestures(phones: Tier, dimension: str, rng: np.random.Generator) -> list[_Gesture]:
    """Return the gestures of one articulator; targets and timing vary from token to token."""
    table = load_data("gestures")["phones"]
    found = []
    for phone in phones:
        for start_s, end_s, target in _phases(phone, dimension, table):
            tight = target >= _CONSTRICTION
            varied = target * _BEYOND if tight else float(np.clip(target * (1 + 0.1 * rng.normal()), 0, 1))
            lead = _LEAD_S[dimension] * float(np.exp(0.15 * rng.normal()))
            low, high = start_s - lead, end_s - 0.35 * lead + _LAG_S[dimension]
            short = max(0.0, _LEAST_S.get(dimension, 0.0) - (high - low)) if tight else 0.0
            strength = 4.0 if tight else float(table[phone.text].get("firm", 1.0))
            found.append(_Gesture(low - 0.5 * short, high + 0.5 * short, varied, strength))
    return found


def _asked(gestures: list[_Gesture], times: FloatArray) -> FloatArray:
    """Return what the active gestures ask for together over time; 0 (rest) where none is active."""
    asked, strength = np.zeros(len(times)), np.full(len(times), 1e-6)
    for gesture in gestures:
        low, high = np.searchsorted(times, [gesture.start_s, gesture.end_s])
        inside = times[low:high]
        rise = np.clip((inside - gesture.start_s) / _EDGE_S, 0, 1)
        weight = gesture.strength * rise * np.clip((gesture.end_s - inside) / _EDGE_S, 0, 1)
        asked[low:high] += weight * gesture.target
        strength[low:high] += weight
    return np.asarray(asked / strength)


def critically_damped(target: FloatArray, omega: float, dt_s: float) -> FloatArray:
    """Return the solution of ``x'' = omega^2 (target - x) - 2 omega x'`` from rest, at every step.

    The exact solution for a target that is held over each step.

    Parameters
    ----------
    target : (n_steps,)
    omega : float
        Natural frequency, rad/s.
    dt_s : float
    """
    step = omega * dt_s
    pole = np.exp(-step)
    first, second = 1.0 - pole * (1.0 + step), pole * (pole + step - 1.0)
    return np.asarray(lfilter([0.0, first, second], [1.0, -2.0 * pole, pole * pole], target))


def articulate(phones: Tier, rate_hz: float, rng: np.random.Generator) -> FloatArray:
    """Return the articulators over time, (n_frames, 5), in the order of :data:`DIMENSIONS`.

    Parameters
    ----------
    phones : Tier
        Contiguous, silence at both ends.
    rate_hz : float
    rng : numpy Generator
        Varies targets, timing and stiffness of the tokens.
    """
    n = int(np.floor(phones.intervals[-1].end_s * rate_hz + 1e-6)) + 1
    dt_s = 1.0 / (rate_hz * STEPS_PER_FRAME)
    times = np.asarray(np.arange(n * STEPS_PER_FRAME) * dt_s, dtype=np.float64)
    out = np.zeros((n, len(DIMENSIONS)))
    for column, dimension in enumerate(DIMENSIONS):
        target = _asked(_gestures(phones, dimension, rng), times)
        omega = 2 * np.pi * _STIFFNESS_HZ[dimension] * float(np.exp(0.05 * rng.normal()))
        out[:, column] = critically_damped(target, omega, dt_s)[::STEPS_PER_FRAME]
    return np.clip(out, 0.0, 1.0)
