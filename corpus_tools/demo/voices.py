"""Who speaks the simulated corpus: the embedded voice, or a formant voice where it is missing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from corpus_tools.core import Audio, Interval, MissingExtraError, Registry, Tier
from corpus_tools.demo.sentences import Sentence, load_data
from corpus_tools.demo.sound import speak
from corpus_tools.speech import ENGINES, phone_set, speak_text

__all__ = ["VOICES", "Spoken", "Voice", "time_phones", "usual_voice"]

_RATE_SD = 0.08
"""Spread of the speaking rate from sentence to sentence, as a logarithm (our choice)."""


@dataclass(frozen=True, slots=True, eq=False)
class Spoken:
    """What a voice made of a sentence: phones and words in time, and sound of the same length."""

    phones: Tier
    words: Tier
    audio: Audio


@dataclass(frozen=True, slots=True)
class Voice:
    """A voice of the simulated actor.

    Attributes
    ----------
    name, summary : str
        The summary is what the README of the corpus says of it.
    speak : callable
        ``speak(sentence, rng) -> Spoken``; equal generators give equal bytes.
    version : callable
        What a kept corpus must have been spoken by to be used again.
    """

    name: str
    summary: str
    speak: Callable[[Sentence, np.random.Generator], Spoken]
    version: Callable[[], str]


VOICES: Registry[Voice] = Registry("voice of the simulated actor")


def _later(tier: Tier, shift_s: float) -> list[Interval]:
    return [Interval(i.start_s + shift_s, i.end_s + shift_s, i.text) for i in tier]


def _between_silences(phones: Tier, words: Tier, audio: Audio, before_s: float, after_s: float) -> Spoken:
    """Return the same with more silence at both ends; the lengths are rounded to samples."""
    n_before, n_after = (round(s * audio.rate_hz) for s in (before_s, after_s))
    samples = np.concatenate([np.zeros(n_before), audio.samples, np.zeros(n_after)]).astype(np.float32)
    rows = _later(phones, n_before / audio.rate_hz)
    rows[0] = Interval(0.0, rows[0].end_s, rows[0].text)
    rows[-1] = Interval(rows[-1].start_s, len(samples) / audio.rate_hz, rows[-1].text)
    shifted = Tier(words.name, tuple(_later(words, n_before / audio.rate_hz)))
    return Spoken(Tier(phones.name, tuple(rows)), shifted, Audio(samples, audio.rate_hz))


def _embedded(sentence: Sentence, rng: np.random.Generator) -> Spoken:
    """Speak with eSpeak NG: its sound, its times, its phones; each sentence at a rate of its own."""
    rate = float(np.clip(np.exp(_RATE_SD * rng.normal()), 0.8, 1.25))
    before_s, after_s = rng.uniform(0.05, 0.2, 2)
    said = speak_text(sentence.text, phone_set("arpabet"), rate=rate)
    assert said.words is not None
    assert said.audio is not None
    return _between_silences(said.phones, said.words, said.audio, float(before_s), float(after_s))


def time_phones(sentence: Sentence, rng: np.random.Generator) -> tuple[Tier, Tier]:
    """Return phones and words with times: mean durations, 15 % variation, one speaking rate per sentence."""
    table = load_data("gestures")["phones"]
    rate = float(np.exp(_RATE_SD * rng.normal()))
    at = float(rng.uniform(0.35, 0.5))
    phones, words = [Interval(0.0, at, "SIL")], []
    for word, spoken in zip(sentence.words, sentence.phones, strict=True):
        begin = at
        for phone in spoken:
            length = 1e-3 * table[phone]["duration_ms"] * rate * float(np.exp(rng.normal(0.0, 0.15)))
            phones.append(Interval(at, at + length, phone))
            at += length
        words.append(Interval(begin, at, word))
    phones.append(Interval(at, at + float(rng.uniform(0.35, 0.5)), "SIL"))
    return Tier("phones", tuple(phones)), Tier("words", tuple(words))


def _formants(sentence: Sentence, rng: np.random.Generator) -> Spoken:
    phones, words = time_phones(sentence, rng)
    return Spoken(phones, words, speak(phones, rng))


VOICES.add(
    "espeak",
    Voice(
        "espeak",
        "the embedded voice, eSpeak NG, each sentence at a rate of its own",
        _embedded,
        lambda: ENGINES["espeak"].version(),
    ),
)
VOICES.add(
    "formants",
    Voice(
        "formants",
        "a formant synthesiser, for the extra 'voice' is not installed "
        "(pip install 'visual-speech-workbench[voice]')",
        _formants,
        lambda: "1",
    ),
)


def usual_voice() -> Voice:
    """Return the embedded voice, or the formant voice where the extra `voice` is not installed."""
    try:
        ENGINES["espeak"].check()
    except MissingExtraError:
        return VOICES["formants"]
    return VOICES["espeak"]
