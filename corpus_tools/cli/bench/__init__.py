"""``corpus-tools bench``: every promise on speed and size, measured here; a file a topic.

A topic is a function ``Ground -> list of Row`` entered in :data:`BENCHMARKS`; its module is imported below.
"""

from corpus_tools.cli.bench import bids, cleaning, films, heads, selection, utterance, weightings
from corpus_tools.cli.bench.command import register, run_bench
from corpus_tools.cli.bench.rows import BENCHMARKS, Ground, Row

__all__ = [
    "BENCHMARKS",
    "Ground",
    "Row",
    "bids",
    "cleaning",
    "films",
    "heads",
    "register",
    "run_bench",
    "selection",
    "utterance",
    "weightings",
]
