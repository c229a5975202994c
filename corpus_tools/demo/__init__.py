"""A simulated corpus: another model than every synthesiser, for a first look and for tests."""

from corpus_tools.demo.actor import Disturbances, disturb, true_markers
from corpus_tools.demo.corpus import (
    VERSION,
    SimulatedSentence,
    demo_folder,
    simulate_corpus,
    simulate_sentence,
)
from corpus_tools.demo.gestures import DIMENSIONS, articulate, time_phones
from corpus_tools.demo.sentences import Sentence, all_sentences, covering_sentences, diphones, pronounce
from corpus_tools.demo.sound import speak

__all__ = [
    "DIMENSIONS",
    "VERSION",
    "Disturbances",
    "Sentence",
    "SimulatedSentence",
    "all_sentences",
    "articulate",
    "covering_sentences",
    "demo_folder",
    "diphones",
    "disturb",
    "pronounce",
    "simulate_corpus",
    "simulate_sentence",
    "speak",
    "time_phones",
    "true_markers",
]
