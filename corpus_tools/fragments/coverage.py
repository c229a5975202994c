"""Which diphones a corpus holds, which it lacks, and how well it covers given sentences."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from corpus_tools.core import InputError, IntArray, UnitInventory, Utterance, frozen
from corpus_tools.fragments.inventory import diphone_keys, diphone_rows, phone_codes, recording_mask

__all__ = ["CoverageReport", "UtteranceCoverage", "coverage"]


@dataclass(frozen=True, slots=True)
class UtteranceCoverage:
    """How much of one utterance the inventory covers.

    `share` is the share of its diphones that are there, repeated ones counted each time; `missing` names the
    others, once each, in order of appearance.
    """

    name: str
    share: float
    missing: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True, eq=False)
class CoverageReport:
    """Diphones of the inventory, and the coverage of utterances by it.

    Attributes
    ----------
    phones : tuple of str
    counts : (n_phones, n_phones) int64
        How often the row's phone is followed by the column's.
    utterances : tuple of UtteranceCoverage
    leave_one_out : bool
        Each utterance was covered by the other recordings only.
    """

    phones: tuple[str, ...]
    counts: IntArray
    utterances: tuple[UtteranceCoverage, ...]
    leave_one_out: bool

    def __post_init__(self) -> None:
        object.__setattr__(self, "counts", frozen(self.counts, np.int64))

    @property
    def n_diphone_types(self) -> int:
        """Number of different diphones in the inventory."""
        return int(np.count_nonzero(self.counts))

    @property
    def missing(self) -> tuple[tuple[tuple[str, str], int], ...]:
        """Missing diphones, each with the number of utterances that lack it; most wanted first."""
        wanted: dict[tuple[str, str], int] = {}
        for utterance in self.utterances:
            for diphone in utterance.missing:
                wanted[diphone] = wanted.get(diphone, 0) + 1
        return tuple(sorted(wanted.items(), key=lambda item: (-item[1], item[0])))

    def as_dict(self) -> dict[str, Any]:
        """Return plain numbers, lists and dicts for JSON."""
        shares = np.array([u.share for u in self.utterances])
        rows, columns = np.nonzero(self.counts)
        return {
            "n_diphone_types": self.n_diphone_types,
            "n_diphones": int(self.counts.sum()),
            "leave_one_out": self.leave_one_out,
            "n_utterances": len(self.utterances),
            "n_full": int(np.count_nonzero(shares == 1.0)),
            "mean": float(shares.mean()),
            "min": float(shares.min()),
            "phones": list(self.phones),
            "diphones": {
                f"{self.phones[a]}-{self.phones[b]}": int(self.counts[a, b])
                for a, b in zip(rows.tolist(), columns.tolist(), strict=True)
            },
            "missing": {f"{a}-{b}": n for (a, b), n in self.missing},
            "utterances": [
                {"id": u.name, "coverage": u.share, "missing": [f"{a}-{b}" for a, b in u.missing]}
                for u in self.utterances
            ],
        }


def _covered(inventory: UnitInventory, phones: Sequence[str], exclude: Iterable[str]) -> list[bool]:
    keys = diphone_keys(inventory, phone_codes(inventory, phones))
    usable = recording_mask(inventory, exclude)
    return [bool(usable[inventory.recording_of[rows]].any()) for rows in diphone_rows(inventory, keys)]


def _names_of_missing(phones: Sequence[str], covered: list[bool]) -> tuple[tuple[str, str], ...]:
    pairs = itertools.pairwise(phones)
    return tuple(dict.fromkeys(pair for pair, there in zip(pairs, covered, strict=True) if not there))


def coverage(
    inventory: UnitInventory, utterances: Iterable[Utterance], leave_one_out: bool = True
) -> CoverageReport:
    """Report the diphones of the inventory and how much of each utterance it covers.

    Parameters
    ----------
    inventory : UnitInventory
    utterances : iterable of Utterance
        At least one, of two phones or more.
    leave_one_out : bool
        Cover each utterance without the recording of its own name; else with all.

    Raises
    ------
    InputError
        No utterance is given, or one has fewer than two phones.
    """
    parts = []
    for utterance in utterances:
        if len(utterance.phones) < 2:
            raise InputError(f"'{utterance.name}' has fewer than two phones and so no diphone to cover.")
        covered = _covered(inventory, utterance.labels, (utterance.name,) if leave_one_out else ())
        missing = _names_of_missing(utterance.labels, covered)
        parts.append(UtteranceCoverage(utterance.name, float(np.mean(covered)), missing))
    if not parts:
        raise InputError("Coverage was asked for no utterance; give at least one.")
    n = len(inventory.phone_set)
    counts = np.bincount(inventory.keys[inventory.keys >= 0], minlength=n * n).reshape(n, n)
    return CoverageReport(inventory.phone_set, counts.astype(np.int64), tuple(parts), leave_one_out)
