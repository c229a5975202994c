"""From the symbols of a notation (IPA, eSpeak names, ARPABET) to the phones of a corpus, by data files."""

from __future__ import annotations

import functools
import tomllib
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from types import MappingProxyType

from corpus_tools.core import InputError, LabelError
from corpus_tools.speech.phone_sets import PhoneSet, phone_set

__all__ = ["Mapped", "PhoneMap", "phone_map", "phone_map_names"]


@dataclass(frozen=True, slots=True)
class Mapped:
    """What the symbols `first` to `last` (both included) stand for: no phone, one, or several in a row."""

    first: int
    last: int
    phones: tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class PhoneMap:
    """How a notation writes the phones of a set.

    Attributes
    ----------
    notation : str
    phones : PhoneSet
    symbols : mapping of symbols -> phones
        Keys are rows of symbols; the longest that fits is taken.
    marks : tuple of str
        Stress and length marks, stripped wherever they stand.
    stresses : mapping of mark -> 1 or 2
        Those of them that say primary or secondary stress.
    pauses, stops : frozenset of str
        Symbols of silence, and of stops and affricates.
    languages : tuple of str
        Whose phones these are; "en" holds for "en-us" too.
    """

    notation: str
    phones: PhoneSet
    symbols: Mapping[tuple[str, ...], tuple[str, ...]]
    marks: tuple[str, ...]
    stresses: Mapping[str, int]
    pauses: frozenset[str]
    stops: frozenset[str]
    languages: tuple[str, ...]

    def stripped(self, symbol: str) -> str:
        """Return a symbol without its marks."""
        for mark in self.marks:
            symbol = symbol.replace(mark, "")
        return symbol

    def stress(self, symbol: str) -> int:
        """Return the stress that the marks of a symbol say: 1 primary, 2 secondary, 0 none."""
        return next((stress for mark, stress in self.stresses.items() if mark in symbol), 0)

    def is_pause(self, symbol: str) -> bool:
        """Return whether a symbol is silence."""
        return symbol in self.pauses or self.stripped(symbol) in self.pauses

    def serves(self, language: str) -> bool:
        """Return whether the set holds the phones of a language such as "en-us"."""
        return language.lower().split("-")[0] in self.languages

    def translate(self, symbols: Sequence[str]) -> tuple[Mapped, ...]:
        """Return the phones of a row of symbols, pauses as silence.

        Raises
        ------
        LabelError
            A symbol is not in the map; the sentence names it.
        """
        plain = [self.stripped(s) if not self.is_pause(s) else s for s in symbols]
        longest = max(map(len, self.symbols))
        found: list[Mapped] = []
        place = 0
        while place < len(plain):
            if self.is_pause(plain[place]):
                found.append(Mapped(place, place, (self.phones.silence,)))
                place += 1
                continue
            for size in range(min(longest, len(plain) - place), 0, -1):
                phones = self.symbols.get(tuple(plain[place : place + size]))
                if phones is not None:
                    found.append(Mapped(place, place + size - 1, phones))
                    place += size
                    break
            else:
                raise LabelError(self._unknown(symbols[place]))
        return tuple(found)

    def split(self, text: str) -> list[str]:
        """Return the symbols of a string written without blanks, the longest that fits first.

        Raises
        ------
        LabelError
            A character begins no symbol; the sentence names it and its place.
        """
        plain = self.stripped(unicodedata.normalize("NFD", text))
        singles = {key[0] for key in self.symbols if len(key) == 1} | (self.pauses - {""})
        longest = max(map(len, singles))
        found = []
        place = 0
        while place < len(plain):
            for size in range(longest, 0, -1):
                if plain[place : place + size] in singles:
                    found.append(plain[place : place + size])
                    break
            else:
                raise LabelError(f"{self._unknown(plain[place]).rstrip('.')} (in '{text}').")
            place += len(found[-1])
        return found

    def _unknown(self, symbol: str) -> str:
        return (
            f"The {self.notation} symbol '{symbol}' has no place in the phone set '{self.phones.name}', "
            f"which holds the phones of {', '.join(self.languages)}."
        )


def _folder() -> resources.abc.Traversable:
    return resources.files("corpus_tools.speech") / "data" / "maps"


def phone_map_names() -> tuple[tuple[str, str], ...]:
    """Return (notation, phone set) of every map that there is."""
    names = (f.name.removesuffix(".toml") for f in _folder().iterdir() if f.name.endswith(".toml"))
    return tuple(sorted((n.split("-")[0], n.split("-")[1]) for n in names))


@functools.cache
def phone_map(notation: str, phones: str) -> PhoneMap:
    """Return the map from a notation to a phone set, both by name.

    Raises
    ------
    InputError
        There is no such map; the sentence lists those that there are.
    """
    if (notation, phones) not in phone_map_names():
        known = ", ".join(f"{a} to {b}" for a, b in phone_map_names())
        raise InputError(
            f"There is no map from {notation} symbols to the phone set '{phones}'; there are: {known}."
        )
    text = (_folder() / f"{notation}-{phones}.toml").read_text(encoding="utf-8")
    data = tomllib.loads(text)
    symbols = {tuple(key.split()): tuple(value.split()) for key, value in data["symbols"].items()}
    return PhoneMap(
        notation=notation,
        phones=phone_set(phones),
        symbols=MappingProxyType(symbols),
        marks=tuple(data["marks"]),
        stresses=MappingProxyType(dict(data["stresses"])),
        pauses=frozenset(data["pauses"]),
        stops=frozenset(data["stops"]),
        languages=tuple(data["languages"]),
    )
