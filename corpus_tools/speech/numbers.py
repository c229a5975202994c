"""Numbers, ordinals and times of day as English words; pure functions."""

from __future__ import annotations

__all__ = ["cardinal", "digits", "number_words", "ordinal", "time_of_day", "year"]

_SMALL = (
    *(
        "zero",
        "one",
        "two",
        "three",
        "four",
        "five",
        "six",
        "seven",
        "eight",
        "nine",
        "ten",
        "eleven",
        "twelve",
    ),
    *("thirteen", "fourteen", "fifteen", "sixteen", "seventeen", "eighteen", "nineteen"),
)
_TENS = ("", "", "twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety")
_SCALES = ("", "thousand", "million", "billion", "trillion")
_ORDINALS = {
    "one": "first",
    "two": "second",
    "three": "third",
    "five": "fifth",
    "eight": "eighth",
    "nine": "ninth",
    "twelve": "twelfth",
}
LARGEST = 10**15 - 1
"""The largest number that is read as one; longer ones are read digit by digit."""


def _below_hundred(n: int) -> str:
    if n < 20:
        return _SMALL[n]
    tens, ones = divmod(n, 10)
    return _TENS[tens] + (f"-{_SMALL[ones]}" if ones else "")


def _below_thousand(n: int) -> str:
    hundreds, rest = divmod(n, 100)
    if not hundreds:
        return _below_hundred(rest)
    return f"{_SMALL[hundreds]} hundred" + (f" and {_below_hundred(rest)}" if rest else "")


def cardinal(n: int) -> str:
    """Return a number from 0 to :data:`LARGEST` in words: 1205 is "one thousand two hundred and five"."""
    if n < 1000:
        return _below_thousand(n)
    parts = []
    for power in range(len(_SCALES) - 1, -1, -1):
        group = n // 1000**power % 1000
        if not group:
            continue
        joined = "and " if power == 0 and group < 100 else ""
        parts.append(f"{joined}{_below_thousand(group)} {_SCALES[power]}".strip())
    return " ".join(parts)


def ordinal(n: int) -> str:
    """Return the ordinal of a number in words: 21 is "twenty-first"."""
    words = cardinal(n)
    for mark in ("-", " "):
        head, found, last = words.rpartition(mark)
        if found and mark in words and (mark == "-" or "-" not in words.rsplit(" ", 1)[-1]):
            return f"{head}{mark}{_ordinal_word(last)}"
    return _ordinal_word(words)


def _ordinal_word(word: str) -> str:
    if word in _ORDINALS:
        return _ORDINALS[word]
    return f"{word[:-1]}ieth" if word.endswith("y") else f"{word}th"


def digits(text: str) -> str:
    """Return digits one by one: "007" is "zero zero seven"."""
    return " ".join(_SMALL[int(d)] for d in text)


def year(n: int) -> str:
    """Return a number from 1100 to 1999 as years are read: 1984 is "nineteen eighty-four"."""
    head, rest = divmod(n, 100)
    if rest == 0:
        return f"{_below_hundred(head)} hundred"
    return f"{_below_hundred(head)} {'oh ' if rest < 10 else ''}{_below_hundred(rest)}"


def number_words(text: str) -> str:
    """Return a written number in words.

    Thousands may be set apart by commas; four digits from 1100 to 1999 without one are read as a year;
    leading zeros, and more than 15 digits, are read digit by digit.

    Parameters
    ----------
    text : str
        Digits, with commas between thousands and a decimal point allowed.
    """
    whole, point, part = text.partition(".")
    plain = whole.replace(",", "")
    if (len(plain) > 1 and plain.startswith("0")) or int(plain or 0) > LARGEST:
        words = digits(plain)
    elif whole == plain and not point and 1100 <= int(plain) <= 1999:
        words = year(int(plain))
    else:
        words = cardinal(int(plain or 0))
    return f"{words} point {digits(part)}" if part else words


def time_of_day(hour: int, minute: int, half: str = "") -> str:
    """Return a time as it is read aloud.

    Parameters
    ----------
    hour, minute : int
        10, 15 is "ten fifteen"; 3, 5 "three oh five"; 10, 0 "ten o'clock"; 15, 0 "fifteen hundred".
    half : {"", "a", "p"}
        Adds "a m" or "p m", and leaves the o'clock out.
    """
    if minute:
        words = f"{cardinal(hour)} {'oh ' if minute < 10 else ''}{cardinal(minute)}"
    elif half:
        words = cardinal(hour)
    else:
        words = f"{cardinal(hour)} o'clock" if 1 <= hour <= 12 else f"{cardinal(hour)} hundred"
    return f"{words} {half} m" if half else words
