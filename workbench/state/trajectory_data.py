"""What a plot of one signal shows: the blend, the recording, what fragments go on with, the overlaps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from corpus_tools.core import FloatArray
from workbench.state.signals import Signal, speed_mm_s
from workbench.state.stages import Result
from workbench.state.tokens import source_slots

__all__ = ["signal_data"]

_BEYOND_S = 0.06


def _continuations(
    result: Result, signal: Signal, speed: bool, n_slots: int
) -> list[list[tuple[FloatArray, FloatArray]]]:
    """Return what each fragment goes on with beyond the joins it is cut at: lines of each colour slot."""
    chosen = result.selection.chosen
    slots = source_slots(tuple(c.unit.recording for c in chosen))
    phones, joins = result.utterance.phones.intervals, result.trajectory.joins
    start, rate = float(result.trajectory.times_s[0]), result.trajectory.rate_hz
    lines: list[list[tuple[FloatArray, FloatArray]]] = [[] for _ in range(n_slots)]
    for index, piece in enumerate(result.pieces.pieces):
        values = _values(signal, piece.motion_mm, result.pieces.names, rate, speed)
        times = start + (piece.start + np.arange(len(values))) / rate
        edges = phones[piece.first].centre_s, phones[piece.last].centre_s
        for at, side in ((index - 1, 0), (index, 1)):
            if not 0 <= at < len(joins):
                continue
            reach = joins[at].overlap_s / 2 + _BEYOND_S
            ends = (edges[0] - reach, edges[0]) if side == 0 else (edges[1], edges[1] + reach)
            inside = (times >= ends[0]) & (times <= ends[1])
            lines[slots[index] % n_slots].append((times[inside], values[inside]))
    return lines


def _values(
    signal: Signal, positions_mm: FloatArray, names: Sequence[str], rate_hz: float, speed: bool
) -> FloatArray:
    values = signal.measure(np.asarray(positions_mm), names)
    return speed_mm_s(values, rate_hz) if speed else values


def signal_data(result: Result, signal: Signal, speed: bool, n_slots: int = 6) -> dict[str, Any]:
    """Return what one plot shows of a result.

    `now` and `recorded`: (times s, values); `spans`: (starts, ends) of the overlaps, s; `beyond`: for each
    colour slot the lines that fragments go on with beyond their joins.

    Parameters
    ----------
    result : Result
    signal : Signal
    speed : bool
        Its rate of change, mm/s.
    n_slots : int
        Colours of sources.
    """
    trajectory, request = result.trajectory, result.request
    recorded: tuple[FloatArray, FloatArray] = (np.zeros(0), np.zeros(0))
    if not request.text:
        capture = request.corpus.recorded(request.sentence)
        values = _values(signal, capture.positions_mm, capture.names, capture.rate_hz, speed)
        recorded = (np.asarray(capture.times_s), values)
    joins = trajectory.joins
    return {
        "recorded": recorded,
        "beyond": _continuations(result, signal, speed, n_slots),
        "now": (
            np.asarray(trajectory.times_s),
            _values(signal, trajectory.values_mm, trajectory.names, trajectory.rate_hz, speed),
        ),
        "spans": (
            np.array([j.time_s - j.overlap_s / 2 for j in joins]),
            np.array([j.time_s + j.overlap_s / 2 for j in joins]),
        ),
    }
