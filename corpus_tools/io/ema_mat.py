"""Articulography in MATLAB files of the Haskins kind: sensors, sound and labels in one struct array."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from corpus_tools.core import (
    Audio,
    Capture,
    FloatArray,
    InputError,
    Interval,
    LabelError,
    Labels,
    MotionError,
    Tier,
)
from corpus_tools.io.formats import AUDIO_READERS, LABEL_READERS, MOTION_READERS
from corpus_tools.io.mat_layout import struct_names
from corpus_tools.io.motion_parts import Notes, capture_of, chosen_rate, unit_factor

__all__ = ["read_ema", "read_ema_labels", "read_ema_sound"]

_EXPECTED = (
    "a MATLAB file (version 5) with one struct array of channels (NAME, SRATE, SIGNAL), as the Haskins "
    "databases have them, was expected"
)
_SOUND = "AUDIO"
_TIERS = {"PHONES": "phones", "WORDS": "words"}


def _channels(path: Path, what: str) -> dict[str, Any]:
    """Return name -> record of the struct array; nothing in the file is executed."""
    from scipy.io import loadmat  # 0.2 s: only for such files

    data = path.read_bytes()
    if len(data) < 128 or data[126:128] not in (b"IM", b"MI"):
        raise InputError(f"'{path}' is no MATLAB file of version 5 to 7 with {what}: {_EXPECTED}.")
    try:
        variables = struct_names(data)
        structs = [name for name, is_struct in variables.items() if is_struct]
        held = loadmat(path, struct_as_record=True, variable_names=structs)
    except Exception as error:  # zlib, struct and scipy raise a dozen kinds on a broken file
        reason = " ".join(str(error).split())[:120].rstrip(".") or type(error).__name__
        raise InputError(f"'{path}' cannot be read as a MATLAB file ({reason}): {_EXPECTED}.") from None
    arrays = [held[name] for name in structs if isinstance(held.get(name), np.ndarray)]
    channels = [a for a in arrays if {"NAME", "SRATE", "SIGNAL"} <= set(a.dtype.names or ())]
    if len(channels) != 1:
        found = ", ".join(variables)[:80] or "nothing"
        raise InputError(f"'{path}' holds {found}, no channels with {what}: {_EXPECTED}.")
    return {_text(record["NAME"]): record for record in channels[0].ravel()}


def _text(value: Any) -> str:
    flat = np.asarray(value).ravel()
    return str(flat[0]).strip() if flat.size and flat.dtype.kind == "U" else ""


def _number(value: Any) -> float:
    flat = np.asarray(value).ravel()
    return float(flat[0]) if flat.size and flat.dtype.kind in "fiu" else math.nan


def _signal(path: Path, name: str, record: Any) -> FloatArray:
    signal = np.asarray(record["SIGNAL"])
    if signal.dtype.kind not in "fiu" or signal.ndim != 2 or not signal.size:
        raise MotionError(f"'{path}': the channel '{name[:40]}' holds no numbers: {_EXPECTED}.")
    return np.asarray(signal, dtype=np.float64)


@MOTION_READERS.register(".mat")
def read_ema(path: Path, *, rate_hz: float | None = None, units: str = "") -> Capture:
    """Read the sensors: the first three columns of every channel that has three or more, in mm.

    Axes stay as in the file (x forward, y to the left, z up).

    Raises
    ------
    InputError
        It is no such file, or its sensors differ in rate or length.
    """
    notes: Notes = []
    signals, rates = {}, {}
    for name, record in _channels(path, "sensors").items():
        signal = _signal(path, name, record)
        if name != _SOUND and signal.shape[1] >= 3:
            signals[name], rates[name] = signal[:, :3], _number(record["SRATE"])
    if not signals:
        raise MotionError(f"'{path}' holds no channel with three coordinates: {_EXPECTED}.")
    first = next(iter(signals))
    for name, signal in signals.items():
        if len(signal) != len(signals[first]) or rates[name] != rates[first]:
            raise MotionError(
                f"'{path}': '{name}' has {len(signal)} samples at {rates[name]:g} Hz and '{first}' has "
                f"{len(signals[first])} at {rates[first]:g} Hz; one clock for all sensors was expected."
            )
    rate = chosen_rate(path, rates[first], rate_hz, notes)
    positions = np.stack(list(signals.values()), axis=1) * unit_factor(path, "mm", units, notes)
    return capture_of(path, positions, list(signals), rate, format="ema", notes=notes, right="y", up="z")


@AUDIO_READERS.register(".mat")
def read_ema_sound(path: Path) -> Audio:
    """Read the sound recorded with the sensors, scaled into [-1, 1] when it is louder.

    Raises
    ------
    InputError
        It is no such file, or holds no sound.
    """
    record = _channels(path, "sound").get(_SOUND)
    if record is None:
        raise InputError(f"'{path}' has no channel {_SOUND}: {_EXPECTED}.")
    samples, rate = _signal(path, _SOUND, record)[:, 0], _number(record["SRATE"])
    if not np.isfinite(samples).all() or not (math.isfinite(rate) and rate >= 1):
        raise InputError(f"'{path}': its sound holds samples or a rate that are no numbers; export it again.")
    return Audio((samples / max(1.0, float(np.abs(samples).max()))).astype(np.float32), round(rate))


@LABEL_READERS.register(".mat")
def read_ema_labels(path: Path) -> Labels:
    """Read phones and words into the tiers ``phones`` and ``words``, labels as they stand.

    Raises
    ------
    InputError
        It is no such file, or has no labels.
    """
    records = _channels(path, "labels").values()
    tiers, end_s = [], 0.0
    for record in records:
        for key, name in _TIERS.items():
            rows = np.asarray(record[key]).ravel() if key in record.dtype.names else np.zeros(0)
            if rows.size and {"LABEL", "OFFS"} <= set(rows.dtype.names or ()):
                tiers.append(Tier(name, tuple(_interval(path, row) for row in rows)))
                end_s = max(end_s, len(record["SIGNAL"]) / max(_number(record["SRATE"]), 1.0))
    if not tiers:
        raise LabelError(f"'{path}' has neither PHONES nor WORDS: {_EXPECTED}.")
    last = max(i.end_s for tier in tiers for i in tier)
    return Labels(tuple(tiers), 0.0, max(end_s, last) if math.isfinite(end_s) else last)


def _interval(path: Path, row: Any) -> Interval:
    times = np.asarray(row["OFFS"]).ravel()
    label = _text(row["LABEL"])
    if times.size != 2 or times.dtype.kind not in "fiu" or not 0 <= times[0] < times[1] < math.inf:
        raise LabelError(f"'{path}': the label '{label[:40]}' has no start and end in s.")
    return Interval(float(times[0]), float(times[1]), label)
