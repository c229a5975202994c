"""Metrics of a prediction against a recording, by id: error, realism, lips, joins, repeated words."""

from corpus_tools.evaluate.metrics import error, joins, lips, realism, words
from corpus_tools.evaluate.metrics.registry import METRICS, Metric

__all__ = ["METRICS", "Metric", "error", "joins", "lips", "realism", "words"]
