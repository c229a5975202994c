"""The sentences of a domain that cover its diphones best: greedy choice, then a random rest."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from corpus_tools.core import BoolArray, InputError
from corpus_tools.demo.grammar import Grammar, time_grammar
from corpus_tools.demo.sentences import Sentence, diphones
from corpus_tools.speech import phone_set, speak_text

__all__ = ["Cover", "all_sentences", "completed", "covering_sentences", "greedy_cover", "pool_of"]

WORTH = 64.0
"""How many diphones taken once more weigh as much as a new one (our choice: new ones come first)."""

HELD_OUT = ("the time is now exactly one in the afternoon", "the time is now quarter to ten in the morning")
"""The examples of paper A are recorded last, so that there is something new to say (our choice)."""

LARGEST_POOL = 20_000
"""Larger grammars are covered from a random sample of their sentences."""


@dataclass(frozen=True, slots=True)
class Cover:
    """What greedy choice took.

    Attributes
    ----------
    sentences : tuple of Sentence
        In the order they were chosen.
    added : tuple of tuple of (str, str)
        The diphones that each was the first to bring.
    total : int
        Number of different diphones of all sentences that could have been chosen.
    """

    sentences: tuple[Sentence, ...]
    added: tuple[tuple[tuple[str, str], ...], ...]
    total: int

    @property
    def covered(self) -> tuple[int, ...]:
        """Number of diphones that are covered after each sentence."""
        return tuple(int(n) for n in np.cumsum([len(a) for a in self.added]))


def _occurrences(pool: Sequence[Sentence]) -> tuple[BoolArray, list[tuple[str, str]]]:
    """Return which sentence holds which diphone, (n_sentences, n_diphones), and the diphones."""
    rows = [diphones(s) for s in pool]
    names = sorted({d for row in rows for d in row})
    column = {d: i for i, d in enumerate(names)}
    holds = np.zeros((len(pool), len(names)), bool)
    for i, row in enumerate(rows):
        holds[i, [column[d] for d in row]] = True
    return holds, names


def greedy_cover(pool: Sequence[Sentence], n: int, until_all: bool = False) -> Cover:
    """Choose up to `n` sentences, each the one that brings most new diphones.

    Among equals the one counts that holds most diphones which were taken only once, then twice, and so on:
    each diphone comes as often as possible, so that a sentence left out can be spoken by the others.

    Parameters
    ----------
    pool : sequence of Sentence
        Earlier ones are preferred among equals.
    n : int
    until_all : bool
        Stop as soon as every diphone is covered.
    """
    holds, names = _occurrences(pool)
    taken = np.zeros(len(names))
    free = np.ones(len(pool), bool)
    chosen, added = [], []
    for _ in range(min(n, len(pool))):
        if until_all and taken.all():
            break
        worth = WORTH ** -np.minimum(taken, 4.0)
        best = int(np.argmax(np.where(free, holds @ worth, -1.0)))
        added.append(tuple(names[i] for i in np.flatnonzero(holds[best] & (taken == 0))))
        chosen.append(pool[best])
        free[best] = False
        taken += holds[best]
    return Cover(tuple(chosen), tuple(added), len(names))


def completed(grammar: Grammar) -> Grammar:
    """Return a grammar whose lexicon has every word: those that it lacks as the embedded voice says them.

    Raises
    ------
    MissingExtraError
        Words are missing, and so is the extra `voice`.
    """
    phones = phone_set("arpabet")
    words = {word for slot in grammar.slots for part in slot for word in part.split()}
    said = {
        word: tuple(p for p in speak_text(word, phones).labels if p != phones.silence)
        for word in sorted(words - set(grammar.lexicon))
    }
    return replace(grammar, lexicon={**grammar.lexicon, **said})


def pool_of(grammar: Grammar, rng: np.random.Generator) -> list[Sentence]:
    """Return the sentences to choose from, in random order; a sample of a grammar with very many."""
    spoken = completed(grammar)
    return [spoken.pronounce(text) for text in spoken.sample(min(spoken.size, LARGEST_POOL), rng)]


@functools.cache
def all_sentences() -> tuple[Sentence, ...]:
    """Return every sentence of the time domain."""
    grammar = time_grammar()
    return tuple(grammar.pronounce(text) for text in grammar.texts())


def covering_sentences(n: int, rng: np.random.Generator) -> list[Sentence]:
    """Return `n` sentences of the time domain: enough to cover its diphones, the rest at random.

    Parameters
    ----------
    n : int
    rng : numpy Generator
        Decides among equally good sentences, and on the rest.

    Raises
    ------
    InputError
        The domain has fewer sentences, or none was asked for.
    """
    every = all_sentences()
    if not 1 <= n <= len(every):
        raise InputError(f"The time domain has {len(every)} sentences; {n} cannot be taken from it.")
    mixed = [every[int(i)] for i in rng.permutation(len(every))]
    pool = [s for s in mixed if s.text not in HELD_OUT]
    first = list(greedy_cover(pool, n, until_all=True).sentences)
    taken = {s.text for s in first}
    rest = [s for s in pool if s.text not in taken] + [s for s in mixed if s.text in HELD_OUT]
    return first + rest[: n - len(first)]
