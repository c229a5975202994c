"""The natural floor: a word of the tested sentence as the same speaker said it another time.

No method that knows phones and times only, and moves as much as speech does, can be expected to come nearer
to a recording than the speaker's own repetition of the word between the same words.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from corpus_tools.core import BoolArray, FloatArray, Recording, Trajectory, step
from corpus_tools.evaluate.comparison import curve_at

__all__ = ["RepeatedWords"]

Key = tuple[str, ...]
Place = tuple[Recording, int, int]

LEAST_FRAMES = 3
"""Captured frames without which a word is too short to be compared (our choice)."""

_STEP_S = 1e-4


def _words(recording: Recording, silence: str) -> list[tuple[Key, int, int]]:
    """Return (word, word before, word after, its phones ...) with the first and last phone of every word."""
    utterance = recording.utterance
    if utterance.words is None:
        return []
    phones = utterance.phones.intervals
    said = [w.text for w in utterance.words]
    found = []
    for i, word in enumerate(utterance.words):
        inside = [
            k for k, p in enumerate(phones) if p.text != silence and word.start_s <= p.centre_s < word.end_s
        ]
        if inside:
            first, last = inside[0], inside[-1]
            before = said[i - 1] if i else ""
            after = said[i + 1] if i + 1 < len(said) else ""
            found.append(((word.text, before, after, *utterance.labels[first : last + 1]), first, last))
    return found


def _edges(recording: Recording, first: int, last: int) -> FloatArray:
    phones = recording.utterance.phones.intervals[first : last + 1]
    return np.array([t for p in phones for t in (p.start_s, p.centre_s)] + [phones[-1].end_s])


class RepeatedWords:
    """All words of the training recordings, found by word, neighbours and phones.

    Parameters
    ----------
    recordings : sequence of Recording
        In their own posture.
    silence : str
    """

    def __init__(self, recordings: Sequence[Recording], silence: str) -> None:
        self.silence = silence
        self._places: dict[Key, list[Place]] = defaultdict(list)
        for recording in recordings:
            for key, first, last in _words(recording, silence):
                self._places[key].append((recording, first, last))

    def repeated(self, recording: Recording, rng: np.random.Generator) -> tuple[BoolArray, Trajectory]:
        """Return which frames of a recording lie in repeated words, and the motion of the repetitions.

        One repetition of each word is drawn at random and laid onto the phones of the recording, edge on edge
        and centre on centre. The motion is at the captured frames, 0 outside repeated words.
        """
        capture = recording.capture
        times = capture.times_s
        here = np.zeros(capture.n_frames, dtype=np.bool_)
        values = np.zeros(capture.positions_mm.shape)
        for key, first, last in _words(recording, self.silence):
            places = self._places.get(key, [])
            target = _edges(recording, first, last)
            inside = (times >= target[0]) & (times <= target[-1]) & ~here
            if not places or inside.sum() < LEAST_FRAMES:
                continue
            other, start, stop = places[int(rng.integers(len(places)))]
            source = _edges(other, start, stop)
            keep = np.concatenate([[True], np.diff(target) > _STEP_S])
            asked = np.interp(times[inside], target[keep], source[keep])
            values[inside] = curve_at(other.capture.times_s, other.capture.positions_mm, asked)
            here |= inside
        return here, Trajectory(times, values, capture.names, history=(step("repetition"),))
