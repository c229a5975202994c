"""Phones, viseme classes, target utterances, and what the lips do."""

from corpus_tools.speech.articulators import (
    APERTURE_PAIRS,
    CLOSURE_WINDOW_S,
    aperture_functional,
    bilabial_minima_mm,
    bite_functional,
    closure_offset,
    closure_threshold_mm,
    jaw_mm,
    lip_aperture_mm,
    lip_pair_functionals,
    lip_protrusion_mm,
    lip_width_mm,
    phone_minima_mm,
)
from corpus_tools.speech.engines import ENGINES, Engine, SpeechRequest, prepare_espeak, speak_text
from corpus_tools.speech.phone_maps import PhoneMap, phone_map, phone_map_names
from corpus_tools.speech.phone_sets import PhoneSet, phone_set, phone_set_names
from corpus_tools.speech.syllables import (
    SyllableRules,
    syllable_languages,
    syllable_rules,
    syllable_spans,
    syllable_tier,
)
from corpus_tools.speech.text import MOST_CHARACTERS, SpokenWord, check_text, normalise_text
from corpus_tools.speech.utterances import labelled_utterance, recorded_utterance, timed_phones

__all__ = [
    "APERTURE_PAIRS",
    "CLOSURE_WINDOW_S",
    "ENGINES",
    "MOST_CHARACTERS",
    "Engine",
    "PhoneMap",
    "PhoneSet",
    "SpeechRequest",
    "SpokenWord",
    "SyllableRules",
    "aperture_functional",
    "bilabial_minima_mm",
    "bite_functional",
    "check_text",
    "closure_offset",
    "closure_threshold_mm",
    "jaw_mm",
    "labelled_utterance",
    "lip_aperture_mm",
    "lip_pair_functionals",
    "lip_protrusion_mm",
    "lip_width_mm",
    "normalise_text",
    "phone_map",
    "phone_map_names",
    "phone_minima_mm",
    "phone_set",
    "phone_set_names",
    "prepare_espeak",
    "recorded_utterance",
    "speak_text",
    "syllable_languages",
    "syllable_rules",
    "syllable_spans",
    "syllable_tier",
    "timed_phones",
]
