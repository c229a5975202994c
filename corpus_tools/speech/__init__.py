"""Phones, viseme classes, target utterances, and what the lips do."""

from corpus_tools.speech.articulators import (
    APERTURE_PAIRS,
    aperture_functional,
    bilabial_minima_mm,
    closure_offset,
    closure_threshold_mm,
    jaw_mm,
    lip_aperture_mm,
    lip_width_mm,
)
from corpus_tools.speech.phone_sets import PhoneSet, phone_set, phone_set_names
from corpus_tools.speech.utterances import labelled_utterance, recorded_utterance, timed_phones

__all__ = [
    "APERTURE_PAIRS",
    "PhoneSet",
    "aperture_functional",
    "bilabial_minima_mm",
    "closure_offset",
    "closure_threshold_mm",
    "jaw_mm",
    "labelled_utterance",
    "lip_aperture_mm",
    "lip_width_mm",
    "phone_set",
    "phone_set_names",
    "recorded_utterance",
    "timed_phones",
]
