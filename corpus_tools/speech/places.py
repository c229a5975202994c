"""Where a phone stands: in its syllable, its word and its phrase; and how it is stressed. As small codes."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from corpus_tools.core import BoolArray, FloatArray, IntArray, Tier, Utterance

__all__ = ["N_PLACES", "PHONE_STRESS", "phone_places", "place_gaps", "stress_codes", "stress_gaps"]

_ROLES, _WORDS, _FINALS = 4, 5, 2
"""Unknown, onset, nucleus, coda; unknown, inside, first, last, all of a word; before silence or not."""

N_PLACES = _ROLES * _WORDS * _FINALS
"""Codes of :func:`phone_places`."""

PHONE_STRESS = (-1, 0, 1, 2)
"""Stress of a phone: unknown, none, primary, secondary; the digits of ARPABET dictionaries."""


def _holder(centres_s: FloatArray, tier: Tier | None) -> IntArray:
    """Return which interval of a tier holds each time, -1 for none."""
    if tier is None or len(tier) == 0:
        return np.full(len(centres_s), -1, dtype=np.int64)
    starts = np.array([i.start_s for i in tier])
    ends = np.array([i.end_s for i in tier])
    found = np.searchsorted(starts, centres_s, side="right") - 1
    return np.where((found >= 0) & (centres_s < ends[found]), found, -1)


def _roles(syllable: IntArray, vowel: BoolArray) -> IntArray:
    """Return 1 before the nucleus of a syllable, 2 in it, 3 after it, 0 where that is not known."""
    order = np.arange(len(syllable))
    nucleus = np.full(int(syllable.max(initial=-1)) + 1, len(syllable))
    inside = vowel & (syllable >= 0)
    np.minimum.at(nucleus, syllable[inside], order[inside])
    at = np.append(nucleus, len(syllable))[syllable]
    role = np.where(vowel, 2, np.where(order < at, 1, 3))
    return np.where((syllable < 0) | (at == len(syllable)), 0, role)


def phone_places(utterance: Utterance, vowels: Collection[str], silence: str) -> IntArray:
    """Return where each phone stands, as a code below :data:`N_PLACES`; 0 for silence.

    Onset, nucleus or coda of its syllable, first or last of its word, in the last syllable before a silence
    or not (a phrase slows down there: final lengthening). What tiers do not tell is unknown; without
    syllables the last phone alone counts as final.

    Parameters
    ----------
    utterance : Utterance
    vowels : collection of str
    silence : str

    Returns
    -------
    (n_phones,) int64
    """
    phones = utterance.phones.intervals
    centres = np.array([p.centre_s for p in phones])
    silent = np.array([p.text == silence for p in phones])
    syllable, word = (_holder(centres, tier) for tier in (utterance.syllables, utterance.words))
    role = _roles(syllable, np.array([p.text in vowels for p in phones]))
    first, last = np.ones(len(phones), np.bool_), np.ones(len(phones), np.bool_)
    first[1:] = last[:-1] = word[1:] != word[:-1]
    in_word = np.where(word < 0, 0, 1 + first + 2 * last)
    final = ~silent & np.append(silent[1:], True)
    final |= (syllable >= 0) & np.isin(syllable, syllable[final])
    return np.where(silent, 0, (role * _WORDS + in_word) * _FINALS + final)


def place_gaps() -> FloatArray:
    """Return how different two places are, (n_places, n_places), 0 to 1.

    A third each for the place in the syllable, in the word (half of it for its beginning, half for its end)
    and before silence (our choice; paper A asks for similar context only). Unknown is like all.
    """
    code = np.arange(N_PLACES)
    role, in_word, final = code // (_WORDS * _FINALS), code // _FINALS % _WORDS, code % _FINALS
    roles = (role[:, None] != role) & (np.minimum(role[:, None], role) > 0)
    changed = np.maximum(in_word - 1, 0)[:, None] ^ np.maximum(in_word - 1, 0)
    known = np.minimum(in_word[:, None], in_word) > 0
    words = np.where(known, 0.5 * (changed & 1) + 0.5 * (changed >> 1), 0.0)
    return np.asarray((roles + words + (final[:, None] != final)) / 3.0)


def stress_codes(utterance: Utterance) -> IntArray:
    """Return where the stress of each phone stands in :data:`PHONE_STRESS`, (n_phones,); 0: unknown."""
    if utterance.stress is None:
        return np.zeros(len(utterance.phones), dtype=np.int64)
    return np.array(utterance.stress, dtype=np.int64) + 1


def stress_gaps() -> FloatArray:
    """Return how different two stresses are, (n_stresses, n_stresses): 0 same or unknown, 1 none and primary.

    Secondary stress lies half way between them (our choice).
    """
    strength = np.array([np.nan, 0.0, 1.0, 0.5])
    return np.asarray(np.nan_to_num(np.abs(strength[:, None] - strength)))
