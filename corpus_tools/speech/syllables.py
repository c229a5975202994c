"""Syllables of timed phones, by rules that a data file gives for each language.

Paper A section 5.1 takes syllables as fragments and does not say where they begin: maximal onset is our
choice, for it needs no dictionary. A new language is one file in ``data/syllables``.
"""

from __future__ import annotations

import functools
import itertools
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from importlib import resources

from corpus_tools.core import Interval, Tier, Utterance
from corpus_tools.speech.phone_sets import PhoneSet

__all__ = [
    "SyllableRules",
    "syllable_languages",
    "syllable_rules",
    "syllable_spans",
    "syllable_tier",
    "with_syllables",
]

Span = tuple[int, int]
"""First and last phone of a syllable, both included."""


@dataclass(frozen=True, slots=True)
class SyllableRules:
    """What is known of the syllables of a language.

    Attributes
    ----------
    language : str
    phones : str
        Name of the phone set that the symbols are of; empty where there is none.
    nuclei : frozenset of str
        Phones that a syllable may have at its heart.
    weak : frozenset of str
        Those of them that make one nucleus with a neighbouring vowel.
    onsets : frozenset of tuple of str
        What a syllable may begin with before its nucleus; nothing is legal, too.
    """

    language: str
    phones: str
    nuclei: frozenset[str]
    weak: frozenset[str]
    onsets: frozenset[tuple[str, ...]]


def syllable_languages() -> tuple[str, ...]:
    """Return the languages that there are rules for."""
    folder = resources.files("corpus_tools.speech") / "data" / "syllables"
    return tuple(sorted(f.name.removesuffix(".toml") for f in folder.iterdir() if f.name.endswith(".toml")))


@functools.cache
def syllable_rules(language: str) -> SyllableRules | None:
    """Return the rules of a language ("en"; "en-gb" is spoken by those of "en"), or None without a file."""
    name = language.strip().lower().replace("_", "-").partition("-")[0]
    if name not in syllable_languages():
        return None
    file = resources.files("corpus_tools.speech") / "data" / "syllables" / f"{name}.toml"
    data = tomllib.loads(file.read_text(encoding="utf-8"))
    return SyllableRules(
        name,
        data["phones"],
        frozenset(data["nuclei"]),
        frozenset(data["weak"]),
        frozenset(tuple(onset.split()) for onset in data["onsets"]),
    )


def _nuclei(phones: Sequence[str], rules: SyllableRules) -> list[Span]:
    """Return the nuclei: a vowel, with the weak vowels beside it as long as one of them at most is strong."""
    found: list[Span] = []
    for place, phone in enumerate(phones):
        if phone not in rules.nuclei:
            continue
        if found and found[-1][1] == place - 1 and phone != phones[place - 1]:
            first = found[-1][0]
            strong = [p for p in phones[first : place + 1] if p not in rules.weak]
            if len(strong) < 2 and len(strong) < place + 1 - first:
                found[-1] = first, place
                continue
        found.append((place, place))
    return found


def syllable_spans(phones: Sequence[str], rules: SyllableRules) -> tuple[Span, ...]:
    """Divide the phones of a word, or of a stretch between silences, into syllables.

    Parameters
    ----------
    phones : sequence of str
    rules : SyllableRules

    Returns
    -------
    tuple of (first, last)
        They follow one another from the first phone to the last. Each has one nucleus and the longest legal
        onset; phones without any vowel are one syllable without a nucleus.
    """
    if not phones:
        return ()
    nuclei = _nuclei(phones, rules)
    starts = [0]
    for (_, before), (nucleus, _) in itertools.pairwise(nuclei):
        places = range(before + 1, nucleus)
        starts.append(next((k for k in places if tuple(phones[k:nucleus]) in rules.onsets), nucleus))
    return tuple((a, b - 1) for a, b in itertools.pairwise([*starts, len(phones)]))


def _word_of(phones: Sequence[Interval], words: Tier | None, silence: str) -> list[int | None]:
    """Return the word that holds the centre of each phone, -1 outside words, None for silence."""
    spans = words.intervals if words is not None else ()
    found: list[int | None] = []
    at = 0
    for phone in phones:
        while at < len(spans) and spans[at].end_s <= phone.centre_s:
            at += 1
        inside = at < len(spans) and spans[at].start_s <= phone.centre_s
        found.append(None if phone.text == silence else at if inside else -1)
    return found


def _joined(spans: Sequence[Span], voiced: Sequence[bool]) -> list[Span]:
    """Give what has no vowel to the syllable before, else to the one after, where no silence lies between."""
    out: list[Span] = []
    last_voiced = True
    for (first, last), has_vowel in zip(spans, voiced, strict=True):
        if out and out[-1][1] == first - 1 and not (has_vowel and last_voiced):
            out[-1] = out[-1][0], last
            last_voiced = last_voiced or has_vowel
        else:
            out.append((first, last))
            last_voiced = has_vowel
    return out


def syllable_tier(phones: Tier, words: Tier | None, rules: SyllableRules, silence: str) -> Tier:
    """Return the syllables of timed phones.

    A syllable never crosses the edge of a word, where words are known, or a silence; a phone belongs to the
    word that holds its centre. A word of consonants alone joins the syllable before it, else the one after.

    Parameters
    ----------
    phones : Tier
        Contiguous.
    words : Tier or None
    rules : SyllableRules
    silence : str

    Returns
    -------
    Tier
        Called "syllables"; the text of each is its phones with blanks between.
    """
    rows = phones.intervals
    spans: list[Span] = []
    for word, group in itertools.groupby(enumerate(_word_of(rows, words, silence)), key=lambda item: item[1]):
        places = [place for place, _ in group]
        if word is not None:
            found = syllable_spans([rows[k].text for k in places], rules)
            spans += [(places[0] + a, places[0] + b) for a, b in found]
    voiced = [any(rows[k].text in rules.nuclei for k in range(a, b + 1)) for a, b in spans]
    syllables = (
        Interval(rows[a].start_s, rows[b].end_s, " ".join(rows[k].text for k in range(a, b + 1)))
        for a, b in _joined(spans, voiced)
    )
    return Tier("syllables", tuple(syllables))


def with_syllables(utterance: Utterance, language: str, phones: PhoneSet) -> Utterance:
    """Return an utterance with its syllables; as it is where the language or the phone set has no rules."""
    rules = syllable_rules(language)
    if rules is None or rules.phones != phones.name:
        return utterance
    tier = syllable_tier(utterance.phones, utterance.words, rules, phones.silence)
    return replace(utterance, syllables=tier)
