"""Sentence, word, syllable and diphone units: views of the one index of spans (paper A section 5.1)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from corpus_tools.core import Recording, Tier, UnitInventory, UnitRef

__all__ = ["UnitViews", "unit_views"]


@dataclass(frozen=True, slots=True)
class UnitViews:
    """The units of paper A section 5.1 by kind.

    Attributes
    ----------
    sentences : tuple of UnitRef
        One per recording of two phones or more.
    words : dict of word -> tuple of UnitRef
        The phones whose centres lie in the word; words of a single phone are no unit.
    syllables : dict of phones -> tuple of UnitRef
        Keyed by the phones with hyphens between; syllables of a single phone are no unit. Empty where the
        language of the corpus has no rules.
    diphones : dict of (phone, phone) -> count
    n_phones, n_spans : int
        All phones, and all runs of two phones or more: what selection can choose from.
    """

    sentences: tuple[UnitRef, ...]
    words: dict[str, tuple[UnitRef, ...]]
    syllables: dict[str, tuple[UnitRef, ...]]
    diphones: dict[tuple[str, str], int]
    n_phones: int
    n_spans: int

    def as_dict(self) -> dict[str, Any]:
        """Return the counts as plain numbers and dicts, for JSON and for lines of text."""
        return {
            "phones": self.n_phones,
            "sentence_units": len(self.sentences),
            "word_units": sum(len(units) for units in self.words.values()),
            "word_types": len(self.words),
            "syllable_units": sum(len(units) for units in self.syllables.values()),
            "syllable_types": len(self.syllables),
            "diphone_units": sum(self.diphones.values()),
            "diphone_types": len(self.diphones),
            "all_spans": self.n_spans,
            "words": {word: len(units) for word, units in sorted(self.words.items())},
            "syllables": {phones: len(units) for phones, units in sorted(self.syllables.items())},
            "diphones": {f"{a}-{b}": n for (a, b), n in sorted(self.diphones.items())},
        }


def unit_views(inventory: UnitInventory) -> UnitViews:
    """List the sentence, word and syllable units of an inventory and count its diphones and spans."""
    words: dict[str, list[UnitRef]] = {}
    syllables: dict[str, list[UnitRef]] = {}
    sentences = []
    for recording in inventory.recordings:
        if len(recording.utterance.phones) > 1:
            sentences.append(UnitRef(recording.name, 0, len(recording.utterance.phones) - 1))
        for word, unit in _tier_units(recording, recording.utterance.words):
            words.setdefault(word, []).append(unit)
        for text, unit in _tier_units(recording, recording.utterance.syllables):
            syllables.setdefault(text.replace(" ", "-"), []).append(unit)
    return UnitViews(
        sentences=tuple(sentences),
        words={word: tuple(units) for word, units in words.items()},
        syllables={phones: tuple(units) for phones, units in syllables.items()},
        diphones=_diphone_counts(inventory),
        n_phones=inventory.n_phones,
        n_spans=_count_spans(inventory),
    )


def _tier_units(recording: Recording, tier: Tier | None) -> Iterator[tuple[str, UnitRef]]:
    """Yield the intervals of a tier that hold the centres of two phones or more."""
    if tier is None:
        return
    centres = np.array([interval.centre_s for interval in recording.utterance.phones])
    for interval in tier:
        first, after = np.searchsorted(centres, [interval.start_s, interval.end_s])
        if interval.text.strip() and after - first > 1:
            yield interval.text, UnitRef(recording.name, int(first), int(after) - 1)


def _diphone_counts(inventory: UnitInventory) -> dict[tuple[str, str], int]:
    keys, counts = np.unique(inventory.keys[inventory.keys >= 0], return_counts=True)
    n, phones = len(inventory.phone_set), inventory.phone_set
    pairs = zip(keys.tolist(), counts.tolist(), strict=True)
    return {(phones[key // n], phones[key % n]): count for key, count in pairs}


def _count_spans(inventory: UnitInventory) -> int:
    starts = np.flatnonzero(inventory.keys < 0)  # each ends a run of phones that follow one another
    runs = np.diff(np.concatenate([[-1], starts]))
    return int((runs * (runs - 1) // 2).sum())
