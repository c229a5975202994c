"""From written text to the words that are spoken: checked, numbers and abbreviations in full."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection
from dataclasses import dataclass, replace

from corpus_tools.core import InputError
from corpus_tools.speech.english import english_words

__all__ = ["MOST_CHARACTERS", "SpokenWord", "check_text", "normalise_text"]

MOST_CHARACTERS = 5000
"""Longest text that is spoken at once (our choice: about five minutes)."""

_DROPPED = dict.fromkeys(map(ord, "\u00ad\u200b\u200c\u200d\u2060\ufeff"))
_WRITTEN = str.maketrans(
    {
        **dict.fromkeys("’‘ʼ", "'"),
        **dict.fromkeys('“”„«»"*_`^\\¿¡', " "),
        **dict.fromkeys("–—−‐‑", "-"),
        **dict.fromkeys("([{<)]}>|•", ","),
        "…": ".",
    }
)
_MARKUP = re.compile(r"""</?[A-Za-z][\w:.-]*(?:\s+[\w:.-]+\s*=\s*(?:"[^"]*"|'[^']*'))*\s*/?>|<[!?][^<>]*>""")
_PIECE = re.compile(r"[^\s.,;:!?]+|[.,;:!?]")


@dataclass(frozen=True, slots=True)
class SpokenWord:
    """One word as it is spoken.

    Attributes
    ----------
    text : str
    after : str
        The punctuation that follows it, one sign or none: where the voice pauses.
    letter : bool
        The name of a letter is meant, not a word of one letter ("a").
    """

    text: str
    after: str = ""
    letter: bool = False


def _no_word(text: str) -> str:
    shown = " ".join(text.split())[:40]
    what = f"'{shown}' holds no word" if shown else "is empty"
    return f"The text {what}; write what is to be spoken."


def check_text(text: str) -> None:
    """Refuse text that cannot be spoken, whatever the language.

    Raises
    ------
    InputError
        Neither letters nor digits, control characters, tags such as ``<break/>``, or more than
        :data:`MOST_CHARACTERS`; the sentence says which.
    """
    if len(text) > MOST_CHARACTERS:
        raise InputError(
            f"The text has {len(text)} characters; at most {MOST_CHARACTERS} are spoken at once: "
            "cut it into sentences."
        )
    for place, sign in enumerate(text):
        category = unicodedata.category(sign)
        if category[0] != "C" or sign in "\t\n\r" or ord(sign) in _DROPPED:
            continue
        what = "a byte that is no UTF-8" if category == "Cs" else "the control character"
        shown = " ".join(text[max(0, place - 20) : place].split())
        before = f" (after '{shown}')" if shown else ""
        raise InputError(
            f"Character {place + 1} of the text{before} is {what} U+{ord(sign):04X}; take it out."
        )
    if tag := _MARKUP.search(text):
        raise InputError(
            f"The text holds the markup '{' '.join(tag[0].split())[:40]}', which is not understood; write "
            "plain text, with commas and full stops for pauses."
        )
    if not any(sign.isalnum() for sign in text):
        raise InputError(_no_word(text))


def _plain_words(text: str) -> list[tuple[str, bool]]:
    return [(piece, False) for piece in _PIECE.findall(text)]


def _with_pauses(pieces: list[tuple[str, bool]]) -> list[SpokenWord]:
    """Hang punctuation on the word before it; the end of a sentence is stronger than a comma."""
    words: list[SpokenWord] = []
    for piece, letter in pieces:
        if len(piece) == 1 and piece in ".,;:!?":
            if words and (not words[-1].after or piece in ".!?"):
                words[-1] = replace(words[-1], after=piece)
        elif any(sign.isalnum() for sign in piece):
            words.append(SpokenWord(piece, letter=letter))
    return words


def normalise_text(
    text: str, language: str = "en", vocabulary: Collection[str] = ()
) -> tuple[SpokenWord, ...]:
    """Return the words of a text as they are spoken.

    In English, numbers, times of day, ordinals, amounts, units and common abbreviations are written out;
    the letter Z is called as the vocabulary calls it (else "zed" outside American English); "a" is taken for
    the letter where no article can stand: before a number below a hundred, another letter, or a pause. Text
    in other languages keeps its words as they are written; the voice reads its numbers.

    Parameters
    ----------
    text : str
    language : str
        Such as "en", "en-gb", "es-419".
    vocabulary : collection of str
        The words of a corpus, in lower case.

    Raises
    ------
    InputError
        The text cannot be spoken; see :func:`check_text`.
    """
    check_text(text)
    plain = unicodedata.normalize("NFC", text).translate(_DROPPED).translate(_WRITTEN)
    family = language.lower().split("-")[0]
    pieces = english_words(plain, language, vocabulary) if family == "en" else _plain_words(plain)
    words = _with_pauses(pieces)
    if not words:
        raise InputError(_no_word(text))
    return tuple(words)
