"""What ``synth`` says of its joins: how many are sharper than recorded speech, and which is worst."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from corpus_tools.core import Join, counted

__all__ = ["join_facts", "join_line"]


def join_facts(joins: Sequence[Join]) -> dict[str, Any]:
    """Return how many joins peak above the 95th percentile of natural stretches, and the worst.

    Parameters
    ----------
    joins : sequence of Join

    Returns
    -------
    dict
        n; known: how many could be compared with recorded speech; above_p95; worst: ratio to that percentile,
        phone and time_s, or None.
    """
    known = [j for j in joins if np.isfinite(j.peak_ratio)]
    facts: dict[str, Any] = {"n": len(joins), "known": len(known)}
    facts["above_p95"] = sum(j.peak_ratio > 1.0 for j in known)
    worst = max(known, key=lambda j: j.peak_ratio, default=None)
    facts["worst"] = worst and {
        "ratio": round(worst.peak_ratio, 3),
        "phone": worst.phone,
        "time_s": round(worst.time_s, 4),
    }
    return facts


def join_line(facts: Mapping[str, Any]) -> str:
    """Return :func:`join_facts` for people, as in "2 of 3 joins above ...; worst 3.31 x at EH, 1.48 s"."""
    if not facts["n"]:
        return "One fragment speaks it all: there is no join."
    if facts["worst"] is None:
        return f"{counted(facts['n'], 'join')}; there is too little recorded speech to compare them with."
    worst, n = facts["worst"], counted(facts["known"], "join")
    return (
        f"{facts['above_p95']} of {n} above the 95th percentile of natural stretches in peak acceleration; "
        f"worst {worst['ratio']:.2f} x at {worst['phone']}, {worst['time_s']:.2f} s (joins.csv)"
    )
