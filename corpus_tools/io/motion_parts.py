"""What every reader of motion shares: units, rates, marker names, and the capture made of them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from corpus_tools.core import Capture, FloatArray, MotionError
from corpus_tools.core.history import step

__all__ = ["Notes", "capture_of", "chosen_rate", "common_prefix", "mm_per", "reading_notes", "unit_factor"]

_TO_MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "inch": 25.4}

_SPELT = {
    **{s: "mm" for s in ("mm", "millimeter", "millimeters", "millimetre", "millimetres")},
    **{s: "cm" for s in ("cm", "centimeter", "centimeters", "centimetre", "centimetres")},
    **{s: "m" for s in ("m", "meter", "meters", "metre", "metres")},
    **{s: "inch" for s in ("in", "inch", "inches")},
}

RATES_HZ = (1.0, 1e5)
"""Slowest and fastest motion that can be meant (our choice): others are periods, or damage."""

_UNIT = re.compile(r"(?P<times>\d{1,9}(?:\.\d{1,9})?)? *(?P<unit>mm|cm|m|inch)")

Notes = list[str]
"""Sentences on what is doubtful in a file; a reader appends to them as it goes."""


def mm_per(units: str) -> float | None:
    """Return how many mm ``"cm"`` or ``"250 mm"`` are, None when it is no such unit."""
    match = _UNIT.fullmatch(units)
    factor = float(match["times"] or 1.0) * _TO_MM[match["unit"]] if match else 0.0
    return factor or None


def unit_factor(
    path: Path, stated: str | None, units: str, notes: Notes, *, default: str | None = None
) -> float:
    """Return how many mm one unit of the file is.

    Parameters
    ----------
    path : Path
    stated : str or None
        What the file says.
    units : str
        What the caller says, which is stronger; empty when nothing.
    notes : list of str
    default : str, optional
        Taken, and told, where nobody says anything; without one that is refused.

    Raises
    ------
    MotionError
        No unit, or one that is unknown.
    """
    stated = (stated or "").strip()
    word = _SPELT.get(stated.lower())
    if units:
        factor = mm_per(units)
        if factor is None:
            raise MotionError(
                f"marker_units = '{units}' for '{path}' is no unit: mm, cm, m or inch was expected."
            )
        if word is not None and factor != _TO_MM[word]:
            notes.append(f"the file gives its positions in {word}; marker_units = {units} is used.")
        return factor
    if stated and word is None:
        raise MotionError(
            f"'{path}' gives its positions in '{stated[:20]}', where mm, cm, m or inch was expected; set "
            "'marker_units' in corpus.toml to the unit that is meant."
        )
    if word is None and default is None:
        raise MotionError(
            f"'{path}' does not say in which unit its positions are; set 'marker_units' in corpus.toml "
            "to mm, cm, m or inch."
        )
    if word is None:
        notes.append(f"no unit in the file: {default} is taken; 'marker_units' in corpus.toml settles it.")
    return _TO_MM[word or str(default)]


def chosen_rate(path: Path, stated_hz: float | None, rate_hz: float | None, notes: Notes) -> float:
    """Return the frame rate: the caller's when given, else the file's.

    Raises
    ------
    MotionError
        Neither says a number within :data:`RATES_HZ`.
    """
    slowest, fastest = RATES_HZ
    expected = f"{slowest:g} to {fastest:g} Hz was expected"
    if rate_hz is not None:
        if not slowest <= rate_hz <= fastest:
            raise MotionError(f"rate_hz = {rate_hz:g} for '{path}' is no frame rate; {expected}.")
        if stated_hz is not None and abs(stated_hz - rate_hz) > 1e-3 * rate_hz:
            notes.append(f"the file says {stated_hz:g} Hz; rate_hz = {rate_hz:g} is used.")
        return float(rate_hz)
    if stated_hz is None:
        raise MotionError(
            f"'{path}' says neither a frame rate nor the times of its frames; set 'rate_hz' in corpus.toml."
        )
    if not slowest <= stated_hz <= fastest:
        raise MotionError(
            f"'{path}' says its frame rate is {stated_hz:g}; {expected}, which 'rate_hz' in corpus.toml can "
            "give."
        )
    return float(stated_hz)


def common_prefix(names: Sequence[str]) -> str:
    """Return ``"subject:"`` when all names begin with the same subject, else an empty string."""
    first, sign, _ = names[0].partition(":") if names else ("", "", "")
    prefix = first + sign
    alike = bool(sign and first) and all(n.startswith(prefix) and len(n) > len(prefix) for n in names)
    return prefix if alike else ""


def _named(names: Sequence[str]) -> list[int]:
    """Return the columns that carry a name: ``*12`` and blanks are what a system could not tell apart."""
    return [i for i, n in enumerate(names) if n.strip() and not n.strip().rpartition(":")[2].startswith("*")]


def _check(path: Path, positions: FloatArray, names: Sequence[str]) -> None:
    twice = [n for n, count in Counter(names).items() if count > 1]
    if twice:
        raise MotionError(
            f"'{path}' : the marker name '{twice[0]}' stands more than once; rename one and export it again."
        )
    odd = [n for n in names if not n.isprintable()]
    if odd:
        raise MotionError(
            f"'{path}': the marker name {odd[0][:40]!r} holds characters that cannot be printed; rename "
            "it and export it again."
        )
    if not names:
        raise MotionError(f"'{path}' holds no marker that has a name; label them and export again.")
    if not len(positions):
        raise MotionError(f"'{path}' holds no frames; export it again with its motion.")
    frames, markers, _ = np.nonzero(np.isinf(positions))
    if len(frames):
        raise MotionError(
            f"'{path}': marker '{names[markers[0]]}' is infinitely far off in frame {frames[0]}; "
            "a missing position must be left blank or NaN."
        )


def _note_zeros(positions: FloatArray, notes: Notes) -> None:
    zero = (positions == 0).all(axis=2)
    if zero.any():
        notes.append(
            f"{int(zero.sum())} positions are exactly (0, 0, 0), first in frame "
            f"{int(np.argmax(zero.any(axis=1)))}: some programs write gaps so; export them as missing."
        )


def capture_of(
    path: Path,
    positions_mm: FloatArray,
    names: Sequence[str],
    rate_hz: float,
    *,
    format: str,
    notes: Notes,
    **settings: Any,
) -> Capture:
    """Make the capture of a file: unnamed markers left out, the common subject taken off the names.

    Parameters
    ----------
    path : Path
        For messages.
    positions_mm : (n_frames, n_markers, 3) mm
        A position of which one coordinate is missing is missing.
    names : sequence of str
    rate_hz : float
    format : str
    notes : list of str
    **settings
        Further facts for the history.

    Raises
    ------
    MotionError
        No frames, no named markers, a name twice or of control characters, or an infinite position.
    """
    keep = _named(names)
    kept = [names[i].strip() for i in keep]
    if len(keep) < len(names):
        settings["left_out"] = f"{len(names) - len(keep)} points without a label"
    prefix = common_prefix(kept)
    if prefix:
        settings["prefix"] = prefix
    positions = np.array(positions_mm, dtype=np.float64)[:, keep]
    _check(path, positions, [n[len(prefix) :] for n in kept])
    positions[np.isnan(positions).any(axis=2)] = np.nan
    _note_zeros(positions, notes)
    history = (step("read", format=format, notes=tuple(notes), **settings),)
    return Capture(positions, rate_hz, tuple(n[len(prefix) :] for n in kept), history=history)


def reading_notes(capture: Capture) -> tuple[str, ...]:
    """Return what its reader found doubtful in the file of a capture, one sentence each."""
    return tuple(
        note
        for done in capture.history
        if done.name == "read"
        for note in dict(done.settings).get("notes", ())
    )
