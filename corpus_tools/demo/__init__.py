"""A simulated corpus: another model than every synthesiser, for a first look and for tests."""

from corpus_tools.demo.actor import HEAD_MARKERS, LAYOUTS, layout_columns, marker_names, true_markers
from corpus_tools.demo.capture import UNDISTURBED, Disturbances, Seen, disturb
from corpus_tools.demo.corpus import (
    N_SENTENCES,
    VERSION,
    SimulatedSentence,
    simulate_corpus,
    simulate_sentence,
)
from corpus_tools.demo.cover import Cover, all_sentences, covering_sentences, greedy_cover, pool_of
from corpus_tools.demo.folder import demo_folder
from corpus_tools.demo.gestures import DIMENSIONS, articulate, critically_damped
from corpus_tools.demo.grammar import Grammar, load_grammar, time_grammar
from corpus_tools.demo.sentences import Sentence, diphones
from corpus_tools.demo.sound import speak
from corpus_tools.demo.truth import Truth, read_truth, write_truth
from corpus_tools.demo.voices import VOICES, Spoken, Voice, time_phones, usual_voice

__all__ = [
    "DIMENSIONS",
    "HEAD_MARKERS",
    "LAYOUTS",
    "N_SENTENCES",
    "UNDISTURBED",
    "VERSION",
    "VOICES",
    "Cover",
    "Disturbances",
    "Grammar",
    "Seen",
    "Sentence",
    "SimulatedSentence",
    "Spoken",
    "Truth",
    "Voice",
    "all_sentences",
    "articulate",
    "covering_sentences",
    "critically_damped",
    "demo_folder",
    "diphones",
    "disturb",
    "greedy_cover",
    "layout_columns",
    "load_grammar",
    "marker_names",
    "pool_of",
    "read_truth",
    "simulate_corpus",
    "simulate_sentence",
    "speak",
    "time_grammar",
    "time_phones",
    "true_markers",
    "usual_voice",
    "write_truth",
]
