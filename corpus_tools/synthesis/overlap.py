"""How long two fragments overlap at a join (paper A section 5.1.3)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from corpus_tools.core import FloatArray, InputError, Interval

__all__ = ["OverlapRule", "overlap_lengths"]

OverlapRule = Literal["shared-phone", "paper"]


def overlap_lengths(
    phones: Sequence[Interval],
    joins: Sequence[int],
    rule: OverlapRule = "shared-phone",
    overlap_s: float = 0.12,
    fraction: float = 0.5,
) -> FloatArray:
    """Return the length of the overlap at every join, s.

    Parameters
    ----------
    phones : sequence of Interval
        The target's phones.
    joins : sequence of int
        Index of the phone that the two units of each join share, increasing.
    rule : {"shared-phone", "paper"}
        "shared-phone": at most the shared phone (our default: the printed rule gives 15 ms on GRID, which is
        visibly too short). "paper": at most `fraction` of the smallest phone of the utterance, "always a
        fraction of the smallest phone-to-phone interval".
    overlap_s : float
        Upper limit under both rules, s.
    fraction : float

    Returns
    -------
    (n_joins,) float64
        Centred on the shared phones; neighbouring overlaps never meet, for none leaves its phone.

    Raises
    ------
    InputError
        There is no such rule, or a limit is out of range.
    """
    if rule not in ("shared-phone", "paper"):
        raise InputError(f"There is no overlap rule '{rule}'. Known: shared-phone, paper.")
    if not (overlap_s >= 0 and 0 < fraction <= 1):
        raise InputError(
            f"The longest overlap is {overlap_s:g} s and its share of the smallest phone {fraction:g}: "
            "0 s or more, and a share above 0 and up to 1, were expected."
        )
    lengths = np.array([phones[j].duration_s for j in joins], dtype=np.float64)
    if rule == "paper":
        smallest = min(phone.duration_s for phone in phones)
        lengths = np.minimum(lengths, fraction * smallest)
    return np.minimum(lengths, overlap_s)
