"""What a speech engine is asked for, and what an engine is."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import Literal

from corpus_tools.core import Audio, Labels, Registry, Utterance
from corpus_tools.speech.phone_sets import PhoneSet

__all__ = ["ENGINES", "Engine", "SpeechRequest", "Takes"]

Takes = Literal["text", "labels", "recording"]


@dataclass(frozen=True, slots=True, eq=False)
class SpeechRequest:
    """What is to be said, and how.

    Attributes
    ----------
    name : str
        Of the utterance.
    text : str
        For engines that take text.
    language : str
        Such as "en", "en-gb", "es-419".
    voice : str
        Of the engine; empty for its usual one.
    rate : float
        Speaking rate, 1 as usual, 2 twice as fast.
    vocabulary : collection of str
        The words of the corpus, in lower case: how it spells what has two names (the letter "z").
    labels, audio, phone_tier, word_tier, duration_s, source
        For engines that take labels or a recording, as of
        :func:`~corpus_tools.speech.utterances.labelled_utterance`.
    """

    name: str
    text: str = ""
    language: str = "en"
    voice: str = ""
    rate: float = 1.0
    vocabulary: Collection[str] = ()
    labels: Labels | None = None
    audio: Audio | None = None
    phone_tier: str = "phones"
    word_tier: str = "words"
    duration_s: float | None = None
    source: str | None = None


@dataclass(frozen=True, slots=True)
class Engine:
    """A way from a request to a target utterance.

    Attributes
    ----------
    name, summary : str
    takes : {"text", "labels", "recording"}
    speak : callable
        ``speak(request, phones) -> Utterance``; equal requests give equal bytes.
    check : callable
        Raises MissingExtraError when what the engine needs is not installed.
    version : callable
        Name and version of what speaks, for manifests.
    """

    name: str
    summary: str
    takes: Takes
    speak: Callable[[SpeechRequest, PhoneSet], Utterance]
    check: Callable[[], None]
    version: Callable[[], str]


ENGINES: Registry[Engine] = Registry("speech engine")
