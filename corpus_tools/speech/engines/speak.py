"""One call from text to a target utterance."""

from __future__ import annotations

from collections.abc import Collection

from corpus_tools.core import InputError, Utterance
from corpus_tools.speech.engines.request import ENGINES, SpeechRequest
from corpus_tools.speech.phone_sets import PhoneSet

__all__ = ["speak_text"]


def speak_text(
    text: str,
    phones: PhoneSet,
    *,
    engine: str = "espeak",
    language: str = "en",
    voice: str = "",
    rate: float = 1.0,
    vocabulary: Collection[str] = (),
    name: str = "text",
) -> Utterance:
    """Speak a text: equal arguments give equal bytes.

    Parameters
    ----------
    text : str
        Numbers, times and abbreviations are spoken in full.
    phones : PhoneSet
        Of the corpus.
    engine : str
        By name, of :data:`~corpus_tools.speech.engines.request.ENGINES`; one that takes text.
    language : str
        "en" is American English with the embedded voice: it maps onto ARPABET without loss.
    voice : str
        A variant of the voice, such as "f2"; empty for the usual one.
    rate : float
        Speaking rate, 1 as usual, 2 twice as fast.
    vocabulary : collection of str
        The words of the corpus, in lower case; see
        :func:`~corpus_tools.speech.text.normalise_text`.
    name : str
        Of the utterance.

    Returns
    -------
    Utterance
        Contiguous phones of the set, silence first and last; words; sound.

    Raises
    ------
    InputError, LabelError
        The text, language, voice or rate cannot be spoken, or a sound has no place in the phone set.
    MissingExtraError
        The engine is not installed.
    EngineError
        The engine died twice, or did not answer.
    """
    chosen = ENGINES[engine]
    if chosen.takes != "text":
        texts = ", ".join(e.name for e in ENGINES.values() if e.takes == "text")
        raise InputError(f"The engine '{engine}' speaks {chosen.takes}, not text; engines for text: {texts}.")
    return chosen.speak(SpeechRequest(name, text, language, voice, rate, vocabulary), phones)
