"""What ``synth`` says of the contacts of the lips: how many of p b m and f v are made, and which are not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from corpus_tools.core import counted
from corpus_tools.synthesis import Contact

__all__ = ["contact_facts", "contact_line"]

_SAID = {"closed": "closure of the lips", "on teeth": "lip on the teeth"}
_SEVERAL = {"closed": "closures of the lips", "on teeth": "lips on the teeth"}


def contact_facts(contacts: Sequence[Contact]) -> dict[str, Any]:
    """Return by kind how many contacts there are and how many are made, and those that are not.

    Parameters
    ----------
    contacts : sequence of Contact

    Returns
    -------
    dict
        For each kind n and made; missed: phone, time_s and nearest_mm of the others.
    """
    facts: dict[str, Any] = {}
    for kind in _SAID:
        mine = [c for c in contacts if c.kind == kind]
        facts[kind] = {"n": len(mine), "made": sum(c.made for c in mine)}
    facts["missed"] = [
        {"phone": c.phone, "time_s": round(c.time_s, 4), "nearest_mm": round(c.nearest_mm, 3)}
        for c in contacts
        if not c.made
    ]
    return facts


def contact_line(facts: Mapping[str, Any]) -> str:
    """Return :func:`contact_facts` for people, "3 of 3 closures of the lips made"; empty without any."""
    parts = [
        f"{facts[kind]['made']} of {counted(facts[kind]['n'], _SAID[kind], _SEVERAL[kind])}"
        for kind in _SAID
        if facts[kind]["n"]
    ]
    if not parts:
        return ""
    missed = [f"{m['phone']} at {m['time_s']:.2f} s by {m['nearest_mm']:.1f} mm" for m in facts["missed"][:3]]
    more = f" and {len(facts['missed']) - 3} more" if len(facts["missed"]) > 3 else ""
    return f"{', '.join(parts)} made (contacts.csv)" + (f"; not {', '.join(missed)}{more}" if missed else "")
