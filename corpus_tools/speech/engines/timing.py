"""From the events of a synthesiser to contiguous timed phones: closures, splits, pauses, none of length 0."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from corpus_tools.core import FloatArray
from corpus_tools.speech.phone_maps import Mapped, PhoneMap

__all__ = ["PAUSE_CLOSURE_S", "SHORTEST_S", "SpokenPhone", "closure_start", "spoken_phones", "spread"]

SHORTEST_S = 0.01
"""No phone is shorter, s (our choice: the step of forced aligners)."""

PAUSE_CLOSURE_S = 0.05
"""Closure of a stop behind a pause, s: what eSpeak NG keeps silent before one at the start of a text."""

_VOWEL_SHARE, _CONSONANT_SHARE = 2.0, 1.0


@dataclass(frozen=True, slots=True)
class SpokenPhone:
    """A phone of the target set from `start_s` to the start of the next, its word, the stress of a vowel."""

    start_s: float
    phone: str
    word: int
    stress: int = -1


def closure_start(samples: npt.NDArray[np.int16], at: int, floor: int) -> int:
    """Return where the silence right before sample `at` begins, not before `floor`.

    eSpeak NG reports a stop at its burst and keeps exact silence before it; for lips and tongue the closure
    is the phone.
    """
    span = samples[max(floor, 0) : at]
    sounding = np.flatnonzero(span)
    return max(floor, 0) + (int(sounding[-1]) + 1 if len(sounding) else 0)


def spread(boundaries_s: FloatArray, end_s: float, shortest_s: float = SHORTEST_S) -> FloatArray:
    """Return boundaries moved as little as needed for every interval, the last included, to be long enough.

    Parameters
    ----------
    boundaries_s : (n,) s
        Starts, ascending or equal.
    end_s : float
        End of the last interval.
    shortest_s : float
        Less where `end_s` leaves no room for all.
    """
    n = len(boundaries_s)
    if n == 0:
        return np.zeros(0)
    least = min(shortest_s, (end_s - float(boundaries_s[0])) / n)
    steps = least * np.arange(n)
    later = np.maximum.accumulate(np.asarray(boundaries_s) - steps) + steps
    return np.asarray(np.minimum(later, end_s - least * np.arange(n, 0, -1)))


def _starts(
    samples: npt.NDArray[np.int16], rate_hz: int, events: Sequence[tuple[int, str, int]], phone_map: PhoneMap
) -> list[int]:
    """Return the first sample of each event, the closure before it included."""
    starts: list[int] = []
    paused = True
    for sample, symbol, _ in events:
        floor = starts[-1] if starts else 0
        if phone_map.is_pause(symbol):
            starts.append(sample)
        elif not paused:
            starts.append(closure_start(samples, sample, floor))
        elif phone_map.stripped(symbol) in phone_map.stops:
            starts.append(
                closure_start(samples, sample, max(floor, sample - round(PAUSE_CLOSURE_S * rate_hz)))
            )
        else:
            starts.append(sample)
        paused = phone_map.is_pause(symbol)
    return starts


def _shares(phones: Sequence[str], vowels: frozenset[str]) -> FloatArray:
    """Return where each phone of a split sound begins, as shares of it: a vowel takes twice a consonant."""
    weights = np.array([_VOWEL_SHARE if p in vowels else _CONSONANT_SHARE for p in phones])
    return np.asarray(np.concatenate([[0.0], np.cumsum(weights)[:-1]]) / weights.sum())


def spoken_phones(
    samples: npt.NDArray[np.int16],
    rate_hz: int,
    events: Sequence[tuple[int, str, int]],
    phone_map: PhoneMap,
) -> list[SpokenPhone]:
    """Return the phones that a synthesiser spoke, in the set of `phone_map`.

    Parameters
    ----------
    samples : (n_samples,) int16
    rate_hz : int
    events : sequence of (sample, symbol, word)
        In order; `word` counts words, pauses carry that of the word before. A symbol lasts until the next.
    phone_map : PhoneMap

    Returns
    -------
    list of SpokenPhone
        Starts ascend by at least :data:`SHORTEST_S`.

    Raises
    ------
    LabelError
        A symbol that the map does not know.
    """
    starts = _starts(samples, rate_hz, events, phone_map)
    edges = np.array([*starts, len(samples)]) / rate_hz
    found: list[SpokenPhone] = []
    place = 0
    vowels = phone_map.phones.vowels

    def stress(phone: str, mapped: Mapped) -> int:
        marks = [phone_map.stress(events[place + k][1]) for k in range(mapped.first, mapped.last + 1)]
        return (1 if 1 in marks else max(marks)) if phone in vowels else -1

    while place < len(events):
        stop = place
        while stop < len(events) and events[stop][2] == events[place][2]:
            stop += 1
        for mapped in phone_map.translate([symbol for _, symbol, _ in events[place:stop]]):
            low, high = edges[place + mapped.first], edges[place + mapped.last + 1]
            shares = _shares(mapped.phones, vowels) if mapped.phones else ()
            found += [
                SpokenPhone(float(low + share * (high - low)), phone, events[place][2], stress(phone, mapped))
                for share, phone in zip(shares, mapped.phones, strict=True)
            ]
        place = stop
    moved = spread(np.array([p.start_s for p in found]), float(edges[-1]))
    return [replace(p, start_s=float(t)) for t, p in zip(moved, found, strict=True)]
