"""Every way from timed phones to marker motion, by id."""

from corpus_tools.methods import dominance, fragments, mean, viseme_linear
from corpus_tools.methods.registry import (
    METHODS,
    SEARCHES,
    Method,
    Predictor,
    TunedPredictor,
    Variant,
    parse_variant,
)
from corpus_tools.methods.training import CONTEXT_S, SPEECH_MARGIN_S, TrainingSet, phone_anchors_s
from corpus_tools.methods.tuning import Tuning, tune_weights

__all__ = [
    "CONTEXT_S",
    "METHODS",
    "SEARCHES",
    "SPEECH_MARGIN_S",
    "Method",
    "Predictor",
    "TrainingSet",
    "TunedPredictor",
    "Tuning",
    "Variant",
    "dominance",
    "fragments",
    "mean",
    "parse_variant",
    "phone_anchors_s",
    "tune_weights",
    "viseme_linear",
]
