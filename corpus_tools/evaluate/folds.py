"""Which recordings are held out together: folds, leave-one-out, a test corpus."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from corpus_tools.core import InputError, counted

__all__ = ["Fold", "k_folds", "leave_one_out", "one_split"]

MOST_GROUPS = 5
"""Groups in which leave-one-out is cleaned and compared with natural speech (our choice)."""


@dataclass(frozen=True, slots=True)
class Fold:
    """Recordings that methods are fitted on, and recordings that they then have to predict.

    Attributes
    ----------
    group : int
        Folds of one group share what is taken for natural: the recordings that no fold of the group tests.
    train, test : tuple of str
        Ids; none is in both.
    """

    group: int
    train: tuple[str, ...]
    test: tuple[str, ...]

    def __post_init__(self) -> None:
        if both := set(self.train) & set(self.test):
            raise ValueError(f"'{min(both)}' is trained on and tested")


def _shuffled(names: Sequence[str], seed: int) -> list[str]:
    ordered = sorted(names)
    return [ordered[i] for i in np.random.default_rng(seed).permutation(len(ordered))]


def k_folds(names: Sequence[str], k: int, seed: int = 0) -> tuple[Fold, ...]:
    """Divide recordings at random into `k` parts of equal size (one more or less); each is tested once.

    Raises
    ------
    InputError
        There are fewer than 2 recordings, or `k` is less than 2 or more than there are.
    """
    if len(names) < 2:
        raise InputError(
            f"Folds need at least 2 usable recordings; {counted(len(names), 'is', 'are')} there."
        )
    if not 2 <= k <= len(names):
        raise InputError(
            f"--folds is {k}: a number from 2 to {len(names)}, the number of usable recordings, was expected."
        )
    mixed = _shuffled(names, seed)
    parts = [tuple(sorted(mixed[i::k])) for i in range(k)]
    return tuple(
        Fold(i, tuple(sorted(n for n in names if n not in set(part))), part) for i, part in enumerate(parts)
    )


def leave_one_out(names: Sequence[str], seed: int = 0) -> tuple[Fold, ...]:
    """Hold out each recording alone.

    Raises
    ------
    InputError
        There are fewer than 4 recordings.
    """
    if len(names) < 4:
        raise InputError(
            f"--leave-one-out needs at least 4 usable recordings; {counted(len(names), 'is', 'are')} there."
        )
    groups = min(MOST_GROUPS, len(names) // 2)
    mixed = _shuffled(names, seed)
    folds = [
        Fold(i % groups, tuple(sorted(n for n in names if n != name)), (name,))
        for i, name in enumerate(mixed)
    ]
    return tuple(sorted(folds, key=lambda f: f.group))


def one_split(train: Sequence[str], test: Sequence[str]) -> tuple[Fold, ...]:
    """Train on one corpus and test on another."""
    return (Fold(0, tuple(sorted(train)), tuple(sorted(test))),)
