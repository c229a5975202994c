"""Sentences, and the few that cover the diphones of a domain best."""

from __future__ import annotations

import functools
import itertools
import tomllib
from dataclasses import dataclass
from importlib import resources
from typing import Any

__all__ = ["Sentence", "diphones", "load_data"]


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


def diphones(sentence: Sentence) -> list[tuple[str, str]]:
    """Return the phone-to-phone transitions of a sentence in order, silences at both ends included."""
    row = ["SIL", *itertools.chain.from_iterable(sentence.phones), "SIL"]
    return list(itertools.pairwise(row))
