"""Speech engines: from a text, a label file or a recording to a target utterance, by name."""

from corpus_tools.speech.engines.espeak import prepare_espeak
from corpus_tools.speech.engines.labels import speak_labels, speak_recorded
from corpus_tools.speech.engines.request import ENGINES, Engine, SpeechRequest
from corpus_tools.speech.engines.speak import speak_text

__all__ = [
    "ENGINES",
    "Engine",
    "SpeechRequest",
    "prepare_espeak",
    "speak_labels",
    "speak_recorded",
    "speak_text",
]
