"""Sentences of the time domain (paper A section 4), and the few that cover its diphones best."""

from __future__ import annotations

import functools
import itertools
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any

import numpy as np

__all__ = ["Sentence", "all_sentences", "covering_sentences", "diphones", "load_data", "pronounce"]


@dataclass(frozen=True, slots=True)
class Sentence:
    """Words, and the phones of each word, without silences."""

    words: tuple[str, ...]
    phones: tuple[tuple[str, ...], ...]

    @property
    def text(self) -> str:
        """The words, as written."""
        return " ".join(self.words)


@functools.cache
def load_data(name: str) -> dict[str, Any]:
    """Return a data file of the simulator."""
    file = resources.files("corpus_tools.demo") / "data" / f"{name}.toml"
    return tomllib.loads(file.read_text(encoding="utf-8"))


def pronounce(text: str) -> Sentence:
    """Return a sentence of words that are in the lexicon of the time domain."""
    lexicon = load_data("time_grammar")["lexicon"]
    words = tuple(text.split())
    return Sentence(words, tuple(tuple(lexicon[w].split()) for w in words))


@functools.cache
def all_sentences() -> tuple[Sentence, ...]:
    """Return every sentence of the grammar."""
    grammar = load_data("time_grammar")["grammar"]
    parts = [grammar[name] for name in grammar["prompt"]]
    return tuple(pronounce(" ".join(p for p in choice if p)) for choice in itertools.product(*parts))


def diphones(sentence: Sentence) -> set[tuple[str, str]]:
    """Return the phone-to-phone transitions of a sentence, silences at both ends included."""
    row = ["SIL", *itertools.chain.from_iterable(sentence.phones), "SIL"]
    return set(itertools.pairwise(row))


def covering_sentences(n: int, rng: np.random.Generator) -> list[Sentence]:
    """Return `n` sentences that cover the diphones of the domain greedily, each as often as possible.

    A diphone that has been taken k times counts 1 / (1 + k)^2, so that after the first round the rest are
    covered a second time: a sentence held out can still be spoken by the others.
    """
    pool: Sequence[Sentence] = all_sentences()
    order = rng.permutation(len(pool))[:400]
    taken: dict[tuple[str, str], int] = {}
    chosen: list[Sentence] = []
    for _ in range(n):
        scores = [
            sum((1 + taken.get(d, 0)) ** -2.0 for d in diphones(pool[i])) / len(diphones(pool[i])) ** 0.5
            if pool[i] not in chosen
            else -1.0
            for i in order
        ]
        best = pool[int(order[int(np.argmax(scores))])]
        chosen.append(best)
        for d in diphones(best):
            taken[d] = taken.get(d, 0) + 1
    return chosen
