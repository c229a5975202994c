"""A session as plain data, and back: what is kept of a tab, so that it goes on after a reload."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from corpus_tools.config import ConfigBase, config_from_dict
from corpus_tools.core import ConfigError
from workbench.state.editing import EDITABLE
from workbench.state.history import Entry, History
from workbench.state.session import Session

__all__ = ["JOURNAL", "resume", "session_record"]

JOURNAL = 1
"""Number of the layout of a record; others are not read."""


def session_record(session: Session) -> dict[str, Any]:
    """Return what a person has done in a session as data that JSON can hold; each config once."""
    bases: list[ConfigBase] = []

    def plain(values: Mapping[str, Any]) -> dict[str, Any]:
        base = values["base"]
        if base not in bases:
            bases.append(base)
        return {**values, "base": bases.index(base)}

    entries = [
        {
            "number": e.number,
            "parent": e.parent,
            "when_s": e.when_s,
            "what": e.what,
            "keys": sorted(e.keys),
            "values": plain(e.values),
            "effect": e.effect if math.isfinite(e.effect) else None,
        }
        for e in session.history.entries
    ]
    return {
        "layout": JOURNAL,
        "folder": session.folder,
        "theme": session.theme,
        "kept": plain(session.kept) if session.kept else None,
        "at": session.history.at,
        "entries": entries,
        "bases": [b.model_dump(by_alias=True, mode="json") for b in bases],
    }


def _values(plain: Mapping[str, Any], bases: list[ConfigBase]) -> dict[str, Any]:
    tuples = {k: tuple(v) if isinstance(v, list) else v for k, v in plain.items()}
    return {**tuples, "base": bases[plain["base"]]}


def _entry(plain: Mapping[str, Any], bases: list[ConfigBase]) -> Entry:
    effect = math.nan if plain["effect"] is None else float(plain["effect"])
    values, keys = _values(plain["values"], bases), frozenset(plain["keys"])
    if set(values) != set(EDITABLE):
        raise ValueError("another set of values")
    return Entry(
        int(plain["number"]),
        plain["parent"],
        float(plain["when_s"]),
        str(plain["what"]),
        keys,
        values,
        effect,
    )


def resume(session: Session, record: Mapping[str, Any]) -> bool:
    """Go on where a session was; False, and nothing is changed, where its record does not fit the corpus.

    Parameters
    ----------
    session : Session
        With an opened corpus.
    record : mapping
        As of :func:`session_record`.
    """
    try:
        if record["layout"] != JOURNAL:
            return False
        bases = [config_from_dict(b) for b in record["bases"]]
        entries = [_entry(e, bases) for e in record["entries"]]
        kept = _values(record["kept"], bases) if record["kept"] else None
        history = History.of(entries, int(record["at"]))
        values = next(e.values for e in entries if e.number == history.at)
        if values["target_kind"] == "recording" and values["sentence"] not in session.sentences:
            return False
        Session(
            values["base"], **{k: v for k, v in values.items() if k != "base"}
        )  # refuses what is no value
    except (KeyError, IndexError, TypeError, ValueError, StopIteration, ConfigError):
        return False
    session.history = history
    session.restore(values)
    session.param.update(kept=kept, side="B", theme="dark" if record.get("theme") == "dark" else "light")
    session.edits += 1
    return True
