"""Small simulated corpora: phones drawn at random, postures that follow the phones and their neighbours."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from hypothesis import strategies as st

from corpus_tools.core import Audio, Capture, FrameFlag, Interval, LabelError, Recording, Tier, Utterance

SILENCE = "SIL"
CLASSES = {"P": "lips", "B": "lips", "T": "tip", "D": "tip", "A": "open", "O": "open", SILENCE: "rest"}
MARKERS = ("brow0", "lip_in0", "lip_in1", "lip_in7", "chin0", "head0")


@dataclass(frozen=True)
class SmallPhoneSet:
    """Six phones in three viseme classes, and silence."""

    silence: str = SILENCE
    vowels: frozenset[str] = frozenset({"A", "O"})

    def viseme_class(self, phone: str) -> str:
        try:
            return CLASSES[phone]
        except KeyError:
            raise LabelError(f"The phone '{phone}' is not in the set.") from None

    def lip_shape(self, phone: str) -> str:
        return "closed" if self.viseme_class(phone) == "lips" else ""


def utterance(name: str, phones, durations_s=None, words: Tier | None = None) -> Utterance:
    """Return an utterance of the given phones, one after the other from 0 s."""
    durations = np.full(len(phones), 0.1) if durations_s is None else np.asarray(durations_s, float)
    edges = np.concatenate([[0.0], np.cumsum(durations)])
    spans = zip(edges[:-1].tolist(), edges[1:].tolist(), phones, strict=True)
    return Utterance(
        name, " ".join(phones), Tier("phones", tuple(Interval(a, b, p) for a, b, p in spans)), words
    )


def capture(spoken: Utterance, rng: np.random.Generator, rate_hz: float = 100.0, filled=()) -> Capture:
    """Return smooth simulated motion: a posture per phone, coloured by chance, straight lines between."""
    n_frames = round(spoken.duration_s * rate_hz) + 1
    times = np.arange(n_frames) / rate_hz
    kind = np.array([sorted(CLASSES).index(p) for p in spoken.labels])
    postures = np.random.default_rng(5).normal(0, 4, (len(CLASSES), len(MARKERS) * 3))
    heard = postures[kind] + rng.normal(0, 1, (len(kind), postures.shape[1]))
    centres = np.array([interval.centre_s for interval in spoken.phones])
    motion = np.stack([np.interp(times, centres, column) for column in heard.T], axis=1)
    flags = np.full((n_frames, len(MARKERS)), FrameFlag.MEASURED, np.uint8)
    for first, last in filled:
        flags[first : last + 1] = FrameFlag.FILLED
    return Capture(motion.reshape(n_frames, -1, 3), rate_hz, MARKERS, flags=flags)


def recording(name: str, phones, durations_s=None, seed: int = 0, words: Tier | None = None) -> Recording:
    """Return a simulated recording of the given phones."""
    spoken = utterance(name, phones, durations_s, words)
    return Recording(spoken, capture(spoken, np.random.default_rng([seed, *map(ord, name)])))


def draw_phones(rng: np.random.Generator, n: int) -> list[str]:
    """Draw a sentence: silence, n phones none of which repeats its neighbour, silence."""
    speech = [p for p in sorted(CLASSES) if p != SILENCE]
    phones = [str(rng.choice(speech))]
    while len(phones) < n:
        phones.append(str(rng.choice([p for p in speech if p != phones[-1]])))
    return [SILENCE, *phones, SILENCE]


def simulated_recordings(n: int = 12, seed: int = 0, longest: int = 9) -> list[Recording]:
    """Return `n` simulated recordings of 2 to `longest` phones each."""
    rng = np.random.default_rng(seed)
    found = []
    for index in range(n):
        phones = draw_phones(rng, int(rng.integers(2, longest + 1)))
        found.append(recording(f"s{index:03d}", phones, rng.uniform(0.04, 0.2, len(phones)), seed))
    return found


def with_sounds(recordings: list[Recording], seed: int = 0) -> list[Recording]:
    """Return recordings with simulated sound: another mixture of tones in every tenth of a second."""
    rng, rate, found = np.random.default_rng(seed), 8000, []
    for one in recordings:
        n = round(one.utterance.duration_s * rate) + 1
        hz = np.repeat(rng.uniform(100, 3000, (4, n // 800 + 1)), 800, axis=1)[:, :n]
        tones = 0.1 * np.sin(2 * np.pi * np.cumsum(hz, axis=1) / rate).sum(axis=0)
        sound = Audio(np.asarray(tones, np.float32), rate)
        found.append(replace(one, utterance=replace(one.utterance, audio=sound)))
    return found


@st.composite
def corpora(draw, least: int = 1, most: int = 14) -> list[Recording]:
    """Draw a simulated corpus."""
    n = draw(st.integers(least, most))
    return simulated_recordings(n, draw(st.integers(0, 10_000)), draw(st.integers(2, 12)))


@st.composite
def targets(draw) -> Utterance:
    """Draw a target utterance, which may hold diphones that a corpus lacks."""
    rng = np.random.default_rng(draw(st.integers(0, 10_000)))
    phones = draw_phones(rng, draw(st.integers(1, 14)))
    return utterance("target", phones, rng.uniform(0.03, 0.3, len(phones)))


def covered_target(recordings: list[Recording], rng: np.random.Generator, n: int = 12) -> Utterance:
    """Return a target whose every diphone some recording holds: a walk over the diphones of the corpus."""
    follow: dict[str, list[str]] = {}
    for item in recordings:
        for a, b in zip(item.utterance.labels, item.utterance.labels[1:], strict=False):
            follow.setdefault(a, []).append(b)
    phones = [SILENCE]
    while len(phones) < n and phones[-1] in follow:
        phones.append(str(rng.choice(follow[phones[-1]])))
    return utterance("target", phones, rng.uniform(0.03, 0.3, len(phones)))
