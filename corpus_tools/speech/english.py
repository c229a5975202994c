"""How English reads aloud what is not written as words: numbers, times, amounts, abbreviations, letters."""

from __future__ import annotations

import functools
import re
import tomllib
import unicodedata
from collections.abc import Collection, Mapping, Sequence
from importlib import resources
from typing import Any

from corpus_tools.core import InputError
from corpus_tools.speech.numbers import cardinal, number_words, ordinal, time_of_day

__all__ = ["english_words"]

_WORD = r"(?:[^\W\d_][\u0300-\u036f]*)+"
_TOKEN = re.compile(
    rf"""
    (?P<time>\d{{1,2}}:\d\d(?!\d)(?:\s*[ap]\.?m\b\.?)?|\d{{1,2}}(?:\.[0-5]\d)?\s*[ap]\.?m\b\.?)
  | (?P<money>[$£€]\s?\d+(?:,\d{{3}})*(?:\.\d+)?)
  | (?P<ordinal>\d+(?:st|nd|rd|th)\b)
  | (?P<number>(?:(?<![\w.])-)?(?:\d{{1,3}}(?:,\d{{3}})+(?!\d)|\d+)(?:\.\d+)?)
  | (?P<range>(?<=\d)-(?=\d))
  | (?P<dotted>(?:[^\W\d_]\.){{2,}})
  | (?P<fraction>[½¼¾])
  | (?P<word>{_WORD}(?:['-]{_WORD})*)
  | (?P<pause>[.,;:!?])
  | (?P<nothing>[-/'])
  | (?P<symbol>\S)
    """,
    re.VERBOSE | re.IGNORECASE,
)
_NUMBERS = frozenset(
    "zero one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen sixteen "  # noqa: SIM905
    "seventeen eighteen nineteen twenty thirty forty fifty sixty seventy eighty ninety".split()
)

Piece = tuple[str, bool]
"""A word and whether it is the name of a letter; or a punctuation sign."""


@functools.cache
def _data() -> Mapping[str, Any]:
    file = resources.files("corpus_tools.speech") / "data" / "text" / "en.toml"
    return tomllib.loads(file.read_text(encoding="utf-8"))


def _time(text: str) -> str:
    found = re.match(r"(\d+)(?:[:.](\d\d))?\s*([ap]?)", text, re.IGNORECASE)
    assert found is not None
    hour, minute = int(found[1]), int(found[2] or 0)
    if minute > 59 or hour > 24 or (hour == 24 and minute):
        raise InputError(f"'{text}' in the text is no time of day; write in words what is meant.")
    return time_of_day(hour, minute, found[3].lower())


def _money(text: str) -> str:
    one, several, cent, cents = _data()["currencies"][text[0]]
    whole, _, part = text[1:].strip().replace(",", "").partition(".")
    if part and int(part) and len(part) != 2:
        return f"{number_words(f'{whole}.{part}')} {several}"
    words = f"{cardinal(int(whole))} {one if int(whole) == 1 else several}"
    if not part or not int(part):
        return words
    return f"{words} and {cardinal(int(part))} {cent if int(part) == 1 else cents}"


def _ordinal(text: str) -> str:
    return ordinal(int(re.sub(r"\D", "", text)))


def _number(text: str) -> str:
    return ("minus " if text.startswith("-") else "") + number_words(text.lstrip("-"))


def _range(text: str) -> str:
    return "to"


def _dotted(text: str) -> str:
    letters = text.lower().rstrip(".")
    return str(_data()["dotted"].get(letters, letters.replace(".", " ")))


def _symbol(text: str) -> str:
    if text in _data()["symbols"]:
        return str(_data()["symbols"][text])
    raise InputError(
        f"The sign '{text}' (U+{ord(text[0]):04X}) in the text is not read aloud in English; "
        "write it in words, or take it out."
    )


_READ = {
    "time": _time,
    "money": _money,
    "ordinal": _ordinal,
    "number": _number,
    "range": _range,
    "dotted": _dotted,
    "symbol": _symbol,
    "fraction": _symbol,
}


def _check_script(word: str) -> None:
    for sign in word:
        if sign.isalnum() and not unicodedata.name(sign, "").startswith(("LATIN ", "MODIFIER ")):
            raise InputError(
                f"The letter '{sign}' (U+{ord(sign):04X}) in '{word}' is not one that English is written in; "
                "write it in Latin letters, or name the language as 'language' in corpus.toml."
            )


def _full(word: str, dotted: bool, last: bool) -> str | None:
    """Return what an abbreviation stands for, or None when the word is none."""
    data, key, capital = _data(), word.lower(), word[:1].isupper()
    if capital and key in data["titles"]:
        return str(data["titles"][key])
    if capital and dotted and not last and key in data["dates"]:
        return str(data["dates"][key])
    return str(data["abbreviations"][key]) if dotted and key in data["abbreviations"] else None


def _unit(number: str, between: str, word: str) -> str | None:
    """Return the name of a unit behind a number, or None when the word is none."""
    names = _data()["units"].get(word.lower()) if between in ("", " ") else None
    return None if names is None else str(names[0] if number == "1" else names[1])


def _tokens(text: str) -> list[tuple[str, str, str]]:
    """Return (kind, token, what stands between it and the token before)."""
    rows, end = [], 0
    for found in _TOKEN.finditer(text):
        assert found.lastgroup is not None
        rows.append((found.lastgroup, found[0], text[end : found.start()]))
        end = found.end()
    return rows


def _words_of(rows: Sequence[tuple[str, str, str]]) -> list[str]:
    out: list[str] = []
    skip = False
    for place, (kind, token, between) in enumerate(rows):
        if skip:
            skip = False
            continue
        following = rows[place + 1] if place + 1 < len(rows) else ("", "", " ")
        dotted = following[1] == "." and following[2] == ""
        before = rows[place - 1] if place else ("", "", "")
        if before[0] == "number" and (unit := _unit(before[1], between, token)):
            out += unit.split()
        elif kind == "word":
            _check_script(token)
            last = place + 2 >= len(rows)
            full = _full(token, dotted, last)
            skip = full is not None and dotted and not last
            out += [token] if full is None else full.split()
        elif kind in _READ:
            out += _READ[kind](token).split()
            out += ["."] if kind == "dotted" and place + 1 == len(rows) else []
        elif kind == "pause":
            out.append(token)
    return out


def _halves(words: list[str]) -> list[str]:
    """Write "am" and "pm" behind a number word as letters: "five past one am"."""
    out: list[str] = []
    for place, word in enumerate(words):
        after = words[place + 1].lower() if place + 1 < len(words) else "."
        number = bool(out) and (out[-1].lower() in _NUMBERS or out[-1].lower() == "o'clock")
        if word.lower() == "pm" or (word.lower() == "am" and number and after != "i"):
            out += [word[0].lower(), "m"]
        else:
            out.append(word)
    return out


def _is_letter(word: str, after: str, first: bool) -> bool:
    """Return whether a word of one letter is a letter's name; only "a" leaves a doubt, and "I"."""
    if len(word) != 1 or not word.isalpha() or word == "I":
        return False
    if word.lower() != "a" or (word == "A" and not first):
        return True
    single = len(after) == 1 and after.lower() not in "aio"
    return after in (*".,;:!?", "") or after.lower() in _NUMBERS or single


def _z(language: str, vocabulary: Collection[str]) -> str:
    for name in ("zed", "zee"):
        if name in vocabulary:
            return name
    return "zee" if language.lower() in ("en", "en-us", "en-us-nyc") else "zed"


def english_words(text: str, language: str = "en", vocabulary: Collection[str] = ()) -> list[Piece]:
    """Return the words and pauses of an English text as they are read aloud.

    Parameters
    ----------
    text : str
        With plain apostrophes, hyphens and punctuation.
    language : str
        "en-gb" and its like call the letter Z "zed".
    vocabulary : collection of str
        Words of a corpus: when "zed" or "zee" is among them, the letter has that name.

    Raises
    ------
    InputError
        A letter or sign that English does not read aloud.
    """
    words = _halves(_words_of(_tokens(text)))
    pieces: list[Piece] = []
    for place, word in enumerate(words):
        after = words[place + 1] if place + 1 < len(words) else ""
        first = place == 0 or words[place - 1] in ".!?"
        letter = _is_letter(word, after, first)
        pieces.append((_z(language, vocabulary) if letter and word.lower() == "z" else word, letter))
    return pieces
