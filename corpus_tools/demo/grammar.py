"""Grammars of limited domains (paper A section 4): slots of alternatives, every sentence by its number."""

from __future__ import annotations

import functools
import itertools
import math
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from corpus_tools.core import InputError
from corpus_tools.core.errors import suggestion
from corpus_tools.core.toml_file import TomlFileError, read_toml
from corpus_tools.demo.sentences import Sentence
from corpus_tools.speech import phone_set

__all__ = ["Grammar", "load_grammar", "time_grammar"]

MOST_SENTENCES = 10**12
"""A grammar of more sentences is taken for a mistake (our choice)."""

_FORM = (
    "a TOML file with [grammar], prompt = [names of slots], one list of alternatives per slot, and [lexicon] "
    "with word = 'PH ON ES'"
)


@dataclass(frozen=True, slots=True)
class Grammar:
    """Sentences that choose one alternative per slot.

    Attributes
    ----------
    name : str
    slots : tuple of tuple of str
        The alternatives of each slot in order; "" leaves the slot out.
    lexicon : mapping of word -> phones
        How a word is said.
    before : mapping of (word, next word) -> phones
        How a word is said before that other, where it differs: "to" before "eight".
    """

    name: str
    slots: tuple[tuple[str, ...], ...]
    lexicon: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    before: Mapping[tuple[str, str], tuple[str, ...]] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """How many sentences there are."""
        return math.prod(len(slot) for slot in self.slots)

    def text(self, number: int) -> str:
        """Return a sentence by its number, 0 to :attr:`size` - 1; the last slot changes quickest."""
        if not 0 <= number < self.size:
            raise InputError(f"'{self.name}' has sentences 0 to {self.size - 1}; there is no {number}.")
        chosen = []
        for slot in reversed(self.slots):
            number, choice = divmod(number, len(slot))
            chosen.append(slot[choice])
        return " ".join(part for part in reversed(chosen) if part)

    def texts(self) -> Iterator[str]:
        """Yield every sentence in order."""
        for choice in itertools.product(*self.slots):
            yield " ".join(part for part in choice if part)

    def sample(self, n: int, rng: np.random.Generator) -> list[str]:
        """Return `n` different sentences at random.

        Raises
        ------
        InputError
            The grammar has fewer.
        """
        if n > self.size:
            raise InputError(
                f"'{self.name}' has {self.size} sentences; {n} different ones were asked for: take fewer."
            )
        if self.size <= 10**6:
            return [self.text(int(i)) for i in rng.permutation(self.size)[:n]]
        numbers: dict[int, None] = {}
        while len(numbers) < n:
            numbers.setdefault(int(rng.integers(self.size)))
        return [self.text(i) for i in numbers]

    def pronounce(self, text: str) -> Sentence:
        """Return a sentence with the phones of each word, from the lexicon.

        Raises
        ------
        InputError
            A word is not in the lexicon.
        """
        words = tuple(text.split())
        missing = [w for w in words if w not in self.lexicon]
        if missing:
            hint = suggestion(missing[0], self.lexicon)
            raise InputError(f"'{missing[0]}' is not in the lexicon of '{self.name}'{hint or '.'}")
        pairs = itertools.pairwise((*words, ""))
        return Sentence(words, tuple(self.before.get(pair) or self.lexicon[pair[0]] for pair in pairs))


def _refused(where: str, why: str) -> InputError:
    return InputError(f"'{where}' is no grammar: {why}; {_FORM} was expected.")


def _slots(data: Mapping[str, Any], where: str) -> tuple[tuple[str, ...], ...]:
    table = data.get("grammar")
    if not isinstance(table, dict) or not isinstance(table.get("prompt"), list) or not table["prompt"]:
        raise _refused(where, "it has no [grammar] with a list 'prompt'")
    slots = []
    for name in table["prompt"]:
        row = table.get(name) if isinstance(name, str) else None
        if not isinstance(row, list) or not row or not all(isinstance(a, str) for a in row):
            raise _refused(where, f"the slot '{name}' is no list of texts")
        tidy = [" ".join(a.split()) for a in row]
        if len(set(tidy)) < len(tidy):
            raise _refused(where, f"the slot '{name}' has an alternative twice")
        slots.append(tuple(tidy))
    if math.prod(len(s) for s in slots) > MOST_SENTENCES:
        raise _refused(where, f"it has more than {MOST_SENTENCES:.0e} sentences")
    if all("" in slot for slot in slots):
        raise _refused(where, "every slot may be left out, so that one sentence has no words")
    return tuple(slots)


def _lexicon(data: Mapping[str, Any], key: str, n_words: int, where: str) -> dict[str, tuple[str, ...]]:
    """Return phones by the `n_words` words that are the key of a row."""
    table = data.get(key, {})
    if not isinstance(table, dict) or not all(
        isinstance(v, str) and v.split() and len(k.split()) == n_words for k, v in table.items()
    ):
        form = "word" if n_words == 1 else "'word next'"
        raise _refused(where, f"[{key}] is not of the form {form} = 'PH ON ES'")
    phones = phone_set("arpabet")
    return {word: tuple(phones.normalise(p) for p in text.split()) for word, text in table.items()}


def _grammar(data: Mapping[str, Any], name: str, where: str) -> Grammar:
    before = {(k.split()[0], k.split()[1]): v for k, v in _lexicon(data, "before", 2, where).items()}
    return Grammar(name, _slots(data, where), _lexicon(data, "lexicon", 1, where), before)


@functools.cache
def time_grammar() -> Grammar:
    """Return the time domain of paper A: 2880 sentences; exactness and minutes may be left out."""
    file = resources.files("corpus_tools.demo") / "data" / "time_grammar.toml"
    return _grammar(tomllib.loads(file.read_text(encoding="utf-8")), "time", "time_grammar.toml")


def load_grammar(source: str | Path) -> Grammar:
    """Return a grammar: "time", or a TOML file of the same form as ours.

    Raises
    ------
    InputError
        No such file, or no grammar in it; the sentence says what was expected.
    """
    if str(source) == "time":
        return time_grammar()
    path = Path(source)
    try:
        data = read_toml(path)
    except (FileNotFoundError, TomlFileError) as error:
        why = "cannot be read: it is not there" if isinstance(error, FileNotFoundError) else str(error)
        raise InputError(f"'{source}' {why}; 'time' or {_FORM} was expected.") from None
    return _grammar(data, path.stem, str(source))
