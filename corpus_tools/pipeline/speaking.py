"""A text spoken for a corpus: in its phone set, its language, and with letters called as its labels do."""

from __future__ import annotations

import re
from typing import Any

from corpus_tools.config import ConfigBase
from corpus_tools.core import InputError, Utterance
from corpus_tools.pipeline.opened import OpenCorpus
from corpus_tools.speech import ENGINES, check_text, prepare_espeak, speak_text

__all__ = [
    "check_speech",
    "corpus_vocabulary",
    "sound_problem",
    "speak_for",
    "speech_facts",
    "speech_language",
]

_VARIANT = re.compile(r"\(\d+\)$")
_SHOWN = 40
UNEQUAL_S = 0.5
"""By how much sound and speech may differ in length unsaid (our choice: as labels and sound may)."""


def check_speech(text: str, config: ConfigBase) -> None:
    """Refuse at once what cannot be spoken, and let the voice get ready while the corpus is opened.

    Raises
    ------
    InputError
        The text holds no words or what is no text, or the engine takes none.
    MissingExtraError
        The engine is not installed.
    """
    check_text(text)
    engine = ENGINES[config.speech.engine]
    if engine.takes != "text":
        texts = ", ".join(e.name for e in ENGINES.values() if e.takes == "text")
        raise InputError(
            f"The engine '{engine.name}' speaks {engine.takes}, not text; engines for text: {texts}."
        )
    engine.check()
    if engine.name == "espeak":
        prepare_espeak()


def corpus_vocabulary(corpus: OpenCorpus) -> frozenset[str]:
    """Return the words that are labelled in a corpus, in lower case, variant marks such as "(2)" left out."""
    tiers = (r.utterance.words for r in corpus.recordings)
    return frozenset(_VARIANT.sub("", w.text).lower() for words in tiers if words for w in words)


def speech_language(corpus: OpenCorpus, config: ConfigBase) -> str:
    """Return the language that text is spoken in: that of the config, else that of the corpus."""
    return str(config.speech.language or corpus.description.language)


def speak_for(corpus: OpenCorpus, text: str, config: ConfigBase) -> Utterance:
    """Speak a text with the engine of the config (section `speech`).

    Parameters
    ----------
    corpus : OpenCorpus
    text : str
    config : config

    Raises
    ------
    InputError, LabelError, MissingExtraError, EngineError
        As of :func:`~corpus_tools.speech.speak_text`.
    """
    shown = " ".join(text.split())
    return speak_text(
        text,
        corpus.phones,
        engine=config.speech.engine,
        language=speech_language(corpus, config),
        voice=config.speech.voice,
        rate=config.speech.rate,
        vocabulary=corpus_vocabulary(corpus),
        name=shown if len(shown) <= _SHOWN else shown[: _SHOWN - 1] + "…",
    )


def sound_problem(utterance: Utterance) -> str:
    """Return a sentence on sound that is not as long as what is spoken with it; empty when it fits."""
    if utterance.audio is None or abs(utterance.audio.duration_s - utterance.duration_s) <= UNEQUAL_S:
        return ""
    return (
        f"The sound lasts {utterance.audio.duration_s:.2f} s and what is spoken to it "
        f"{utterance.duration_s:.2f} s: check that they belong together."
    )


def speech_facts(utterance: Utterance) -> dict[str, Any]:
    """Return what a manifest says of the sound: engine, version, words, and whether it is silent."""
    sound, name = utterance.audio, utterance.engine
    return {
        "engine": name,
        "version": ENGINES[name].version() if name in ENGINES else "unknown",
        "text": utterance.text,
        "silent": sound is None or not bool(sound.samples.any()),
    }
