"""Fragments of sound and motion together: the sound of the chosen units, joined, on their own clock.

Paper A section 8 sees a remedy for poor synchrony in selecting "both audio and visual units". The target then
takes the times of the units, so that neither sound nor motion is stretched, and the waveforms are laid end to
end (our choice: no change of pitch or pace, the joins are where the motion joins, at the centres of shared
phones).
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from corpus_tools.core import (
    Audio,
    FloatArray,
    InputError,
    Interval,
    Selection,
    Tier,
    UnitInventory,
    Utterance,
)

__all__ = ["FADE_S", "SHIFT_S", "linked_utterance"]

FADE_S = 0.012
"""Length over which one waveform fades into the next, s (our choice: a period of a low voice)."""

SHIFT_S = 0.006
"""Most by which a waveform is shifted so that its waves fall on those before it, s (our choice)."""

EDGE_S = 0.01
"""Fade of the sound at either end, s."""


def linked_utterance(utterance: Utterance, selection: Selection, inventory: UnitInventory) -> Utterance:
    """Return the target on the clock of its units, with their sound.

    A phone inside a unit lasts as long as in its recording, a phone that two units share half of each, and
    the silence at either end as long as in the target. Words and syllables move with their phones.

    Parameters
    ----------
    utterance : Utterance
    selection : Selection
        Of this target.
    inventory : UnitInventory
        Its recordings have sound, of one rate.

    Returns
    -------
    Utterance
        Engine "units".

    Raises
    ------
    InputError
        A recording that was chosen has no sound, or two differ in their rate.
    """
    sounds = [_sound_of(inventory, c.unit.recording) for c in selection.chosen]
    rates = {s.rate_hz for s in sounds}
    if len(rates) > 1:
        raise InputError(
            f"The chosen recordings have sound of {', '.join(f'{r} Hz' for r in sorted(rates))}; one rate "
            "was expected, to join them: convert the sound files, or leave speech.sound as it is."
        )
    old = np.array([utterance.phones.intervals[0].start_s, *(p.end_s for p in utterance.phones)])
    new = np.concatenate([[0.0], np.cumsum(_durations(utterance, selection, inventory))])
    audio = _joined(selection, inventory, sounds, new, rates.pop())

    def moved(tier: Tier | None) -> Tier | None:
        return tier and Tier(tier.name, tuple(_moved(i, old, new) for i in tier))

    phones = tuple(
        Interval(float(a), float(b), p.text)
        for (a, b), p in zip(itertools.pairwise(new), utterance.phones, strict=True)
    )
    return replace(
        utterance,
        phones=Tier(utterance.phones.name, phones),
        words=moved(utterance.words),
        syllables=moved(utterance.syllables),
        audio=audio,
        engine="units",
    )


def _moved(interval: Interval, old: FloatArray, new: FloatArray) -> Interval:
    start, end = np.interp([interval.start_s, interval.end_s], old, new)
    return Interval(float(start), float(end), interval.text)


def _sound_of(inventory: UnitInventory, name: str) -> Audio:
    audio = inventory.recordings[inventory.recording_index(name)].utterance.audio
    if audio is None:
        raise InputError(
            f"The recording '{name}' has no sound to speak with; add it to the corpus, ban the recording, or "
            "let the voice speak (speech.sound = 'voice')."
        )
    return audio


def _durations(utterance: Utterance, selection: Selection, inventory: UnitInventory) -> FloatArray:
    """Return how long each phone of the target lasts on the clock of the units, s."""
    intervals = utterance.phones.intervals
    parts = np.zeros(len(intervals))
    for chosen in selection.chosen:
        first, last = inventory.rows(chosen.unit)
        own = inventory.ends_s[first : last + 1] - inventory.starts_s[first : last + 1]
        halves = np.ones(len(own))
        halves[[0, -1]] = 0.5
        parts[chosen.first : chosen.last + 1] += own * halves
    parts[0], parts[-1] = intervals[0].duration_s, intervals[-1].duration_s
    return parts


def _joined(
    selection: Selection, inventory: UnitInventory, sounds: Sequence[Audio], edges_s: FloatArray, rate_hz: int
) -> Audio:
    """Lay the waveforms of the units end to end, each shifted by at most :data:`SHIFT_S` to fall in step."""
    fade = max(2, round(FADE_S * rate_hz))
    out = np.zeros(round(edges_s[-1] * rate_hz) + 1)
    written = 0
    for k, (chosen, sound) in enumerate(zip(selection.chosen, sounds, strict=True)):
        first, last = inventory.rows(chosen.unit)
        begin, end = _span(inventory, edges_s, chosen.first, first, k == 0), None
        end = _centre(inventory, last) if k < len(sounds) - 1 else float(inventory.ends_s[last])
        source_s, target_s = begin
        wave = np.asarray(sound.samples, float)
        low = round(source_s * rate_hz)
        place = round(target_s * rate_hz)
        if k:
            shift = _in_step(out, wave, place, low, fade, round(SHIFT_S * rate_hz))
            place += shift
            low, place = low - fade // 2, place - fade // 2
        part = _taken(wave, low, round(end * rate_hz) + fade // 2)
        part = part[: len(out) - place]
        part = _faded_in(part, out[place : place + fade], fade if k else round(EDGE_S * rate_hz), bool(k))
        out[place : place + len(part)] = part
        written = place + len(part)
    tail = min(round(EDGE_S * rate_hz), written)
    out[written - tail : written] *= np.linspace(1.0, 0.0, tail)
    return Audio(out.astype(np.float32), rate_hz)


def _centre(inventory: UnitInventory, row: int) -> float:
    return float(0.5 * (inventory.starts_s[row] + inventory.ends_s[row]))


def _span(
    inventory: UnitInventory, edges_s: FloatArray, phone: int, row: int, opening: bool
) -> tuple[float, float]:
    """Return where a unit begins on its own clock and on that of the target, s.

    At a join both are the centre of the shared phone; the first unit brings as much of the silence before its
    second phone as there is on both clocks.
    """
    if opening:
        edge_s, before_s = float(inventory.ends_s[row]), float(edges_s[phone + 1])
        lead_s = min(edge_s - float(inventory.starts_s[row]), before_s)
        return edge_s - lead_s, before_s - lead_s
    half_s = 0.5 * float(inventory.ends_s[row] - inventory.starts_s[row])
    return _centre(inventory, row), float(edges_s[phone + 1]) - half_s


def _taken(wave: FloatArray, low: int, high: int) -> FloatArray:
    """Return samples low to high; silence where there are none."""
    inside = wave[max(low, 0) : max(high, 0)]
    before = max(0, min(-low, high - low))
    return np.pad(inside, (before, max(0, high - low - before - len(inside))))


def _in_step(out: FloatArray, wave: FloatArray, place: int, low: int, fade: int, most: int) -> int:
    """Return the shift at which the next waveform is most like what is written already, in samples."""
    half = fade  # compared over twice the fade, so that a whole period is seen
    head = _taken(wave, low - half, low + half)
    there = _taken(out, place - half - most, place + half + most)
    if not (head.any() and there.any()):
        return 0
    alike = np.correlate(there, head, "valid")
    energy = np.sqrt(np.convolve(there**2, np.ones(len(head)), "valid")) + 1e-9
    return int((alike / energy).argmax()) - most


def _faded_in(part: FloatArray, before: FloatArray, length: int, joined: bool) -> FloatArray:
    """Return a waveform that fades in, over what is written before it when it is joined to that."""
    n = min(length, len(part), len(before) if joined else length)
    rise = 0.5 - 0.5 * np.cos(np.pi * (np.arange(n) + 0.5) / max(n, 1))
    head = part[:n] * rise + (before[:n] * (1.0 - rise) if joined else 0.0)
    return np.concatenate([head, part[n:]])
