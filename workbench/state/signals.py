"""What can be drawn over time: lip aperture, width, jaw, or one marker; of any motion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from corpus_tools.core import FloatArray
from corpus_tools.speech import jaw_mm, lip_aperture_mm, lip_width_mm

__all__ = ["SIGNALS", "Signal", "marker_signal", "signals_of", "speed_mm_s"]

Measure = Callable[[FloatArray, Sequence[str]], FloatArray]


@dataclass(frozen=True, slots=True)
class Signal:
    """One curve: `measure(positions_mm, names)` gives (n_frames,) mm; `needs` are the markers it looks at."""

    id: str
    label: str
    measure: Measure
    needs: tuple[str, ...]


SIGNALS = (
    Signal("aperture", "Lip aperture", lip_aperture_mm, ()),
    Signal("width", "Lip width", lip_width_mm, ("lip_out0", "lip_out6")),
    Signal("jaw", "Jaw", jaw_mm, ("nose5", "chin3")),
)
"""The signals that any corpus of faces has, as far as it holds their markers."""


def marker_signal(name: str, axis: int = 1) -> Signal:
    """Return the position of one marker along an axis (0 right, 1 up, 2 out of the face)."""

    def measure(positions_mm: FloatArray, names: Sequence[str]) -> FloatArray:
        return np.asarray(positions_mm[:, list(names).index(name), axis])

    return Signal(f"{name}.{'xyz'[axis]}", f"{name} {'xyz'[axis]}", measure, (name,))


def signals_of(names: Sequence[str]) -> tuple[Signal, ...]:
    """Return the signals that a marker layout holds the markers of."""
    return tuple(s for s in SIGNALS if set(s.needs) <= set(names))


def speed_mm_s(values_mm: FloatArray, rate_hz: float) -> FloatArray:
    """Return the rate of change of a signal, mm/s, (n_frames,), by central differences."""
    return np.asarray(np.gradient(values_mm) * rate_hz) if len(values_mm) > 1 else np.zeros(len(values_mm))
