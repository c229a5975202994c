"""Engines that need no voice: a label file, and a recording of the corpus."""

from __future__ import annotations

from corpus_tools.core import InputError, Utterance
from corpus_tools.speech.engines.request import ENGINES, Engine, SpeechRequest
from corpus_tools.speech.phone_sets import PhoneSet
from corpus_tools.speech.utterances import labelled_utterance, recorded_utterance

__all__ = ["speak_labels", "speak_recorded"]


def speak_labels(request: SpeechRequest, phones: PhoneSet) -> Utterance:
    """Return the utterance of a label file; without audio it is silent."""
    if request.labels is None:
        raise InputError("The engine 'labels' speaks a label file: give --labels FILE.TextGrid.")
    return labelled_utterance(
        request.name,
        request.labels,
        request.audio,
        phones,
        phone_tier=request.phone_tier,
        word_tier=request.word_tier,
        source=request.source,
        language=request.language,
    )


def speak_recorded(request: SpeechRequest, phones: PhoneSet) -> Utterance:
    """Return what is said in a recording."""
    if request.labels is None:
        raise InputError("The engine 'recorded' speaks a recording of the corpus: give --utterance NAME.")
    return recorded_utterance(
        request.name,
        request.labels,
        request.audio,
        phones,
        phone_tier=request.phone_tier,
        word_tier=request.word_tier,
        duration_s=request.duration_s,
        language=request.language,
    )


def _nothing() -> None:
    """Need nothing that might be missing."""


def _own() -> str:
    return "the file's own times"


ENGINES.add(
    "labels",
    Engine(
        "labels",
        "The timed phones of a label file, with or without sound.",
        "labels",
        speak_labels,
        _nothing,
        _own,
    ),
)
ENGINES.add(
    "recorded",
    Engine(
        "recorded",
        "A recording of the corpus: its labels and its sound.",
        "recording",
        speak_recorded,
        _nothing,
        _own,
    ),
)
