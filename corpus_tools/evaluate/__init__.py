"""Judging methods on sentences that they never saw: folds, metrics, intervals, a report."""

from corpus_tools.evaluate.bootstrap import Estimate
from corpus_tools.evaluate.comparison import Comparison
from corpus_tools.evaluate.files import write_evaluation
from corpus_tools.evaluate.folds import Fold, k_folds, leave_one_out, one_split
from corpus_tools.evaluate.metrics import METRICS, Metric
from corpus_tools.evaluate.natural import Natural, natural_of
from corpus_tools.evaluate.numbers import value_text
from corpus_tools.evaluate.runner import NATURAL, REPETITION, Evaluation, Source, evaluate
from corpus_tools.evaluate.table import Table, tabulate

__all__ = [
    "METRICS",
    "NATURAL",
    "REPETITION",
    "Comparison",
    "Estimate",
    "Evaluation",
    "Fold",
    "Metric",
    "Natural",
    "Source",
    "Table",
    "evaluate",
    "k_folds",
    "leave_one_out",
    "natural_of",
    "one_split",
    "tabulate",
    "value_text",
    "write_evaluation",
]
