"""From the times or frame numbers of a file to frames on a uniform clock; what is not there becomes a gap."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from corpus_tools.core import FloatArray, IntArray, MotionError
from corpus_tools.io.motion_parts import Notes

__all__ = ["frames_of_numbers", "frames_of_times", "placed"]

JITTER = 0.1
"""Part of a frame by which a time may be off its frame (our choice)."""

SPARSEST = 4
"""So many times more frames than rows are refused: such a file is no continuous recording (our choice)."""


def frames_of_times(
    path: Path, times_s: FloatArray, n_decimals: int, lines: Sequence[int]
) -> tuple[IntArray, float | None]:
    """Return the frame number of each time, from 0, and the rate in Hz (None for a single frame).

    Steps of whole multiples are frames that were dropped.

    Parameters
    ----------
    path : Path
    times_s : (n,) s
    n_decimals : int
        Of the times as written: they are that much uncertain.
    lines : sequence of int, n
        Where they stand in the file.

    Raises
    ------
    MotionError
        Times are missing, repeat, run backwards or are not uniform; the message says in which line.
    """
    unknown = np.flatnonzero(~np.isfinite(times_s))
    if len(unknown):
        raise MotionError(f"'{path}', line {lines[unknown[0]]}: there is no time; every frame needs one.")
    if len(times_s) < 2:
        return np.zeros(len(times_s), np.int64), None
    steps = np.diff(times_s)
    if (steps <= 0).any():
        at = int(np.argmax(steps <= 0)) + 1
        raise MotionError(
            f"'{path}', line {lines[at]}: {times_s[at]:g} s does not come after {times_s[at - 1]:g} s; "
            "times must grow from row to row, and be written with enough decimals."
        )
    rounding = 0.5 * 10.0**-n_decimals
    count = np.arange(len(times_s))
    dropped = np.concatenate([[0], np.cumsum(np.maximum(np.rint(steps / np.median(steps)), 1))]).astype(
        np.int64
    )
    for frames in (count, dropped):
        step = (times_s[-1] - times_s[0]) / frames[-1]
        off = np.abs(times_s - times_s[0] - frames * step)
        if (off <= JITTER * step + 2 * rounding).all():
            return frames, _plain_rate(1 / step, 2 * rounding / (times_s[-1] - times_s[0]))
    usual = float(np.median(steps))
    at = int(np.argmax(np.abs(steps / usual - np.maximum(np.rint(steps / usual), 1)) > JITTER)) + 1
    raise MotionError(
        f"'{path}', line {lines[at]}: the times are not uniform: {times_s[at]:g} s follows "
        f"{times_s[at - 1]:g} s, where steps of {usual:g} s were expected; resample it to a constant rate."
    )


def _plain_rate(rate_hz: float, uncertainty: float) -> float:
    """Return the whole rate, or the whole rate / 1.001 (video), when the times cannot tell it from that."""
    for plain in (round(rate_hz), round(rate_hz * 1.001) / 1.001):
        if plain and abs(plain - rate_hz) <= max(uncertainty, 1e-9) * rate_hz:
            return float(plain)
    return rate_hz


def frames_of_numbers(path: Path, numbers: FloatArray, lines: Sequence[int]) -> IntArray:
    """Return frame numbers from 0 on.

    Raises
    ------
    MotionError
        One is missing, not whole, or does not grow; the message says in which line.
    """
    bad = ~np.isfinite(numbers) | (np.rint(numbers) != numbers) | (np.abs(numbers) > 2**53)
    if bad.any():
        at = int(np.argmax(bad))
        raise MotionError(
            f"'{path}', line {lines[at]}: '{numbers[at]:g}' is no frame number; a whole one was expected."
        )
    back = np.diff(numbers) <= 0
    if back.any():
        at = int(np.argmax(back)) + 1
        raise MotionError(
            f"'{path}', line {lines[at]}: frame {numbers[at]:.0f} follows frame {numbers[at - 1]:.0f}; "
            "frames must stand in order, each once."
        )
    return np.asarray(numbers - numbers[0], dtype=np.int64) if len(numbers) else np.zeros(0, np.int64)


def placed(path: Path, positions: FloatArray, frames: IntArray, notes: Notes) -> FloatArray:
    """Return positions on the uniform clock, NaN in frames that the file leaves out.

    Raises
    ------
    MotionError
        Far more frames are left out than are there.
    """
    if not len(frames):
        return positions
    total = int(frames[-1]) + 1
    if total == len(frames):
        return positions
    if total > SPARSEST * len(frames):
        raise MotionError(
            f"'{path}' holds {len(frames)} of {total} frames; one continuous recording was expected: cut it."
        )
    first = int(np.argmax(np.diff(frames) > 1))
    notes.append(
        f"{total - len(frames)} frames are not in the file, the first after frame {int(frames[first])}; "
        "they are gaps."
    )
    out = np.full((total, *positions.shape[1:]), np.nan)
    out[frames] = positions
    return out
