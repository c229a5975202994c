"""The key table: every key that acts, once; feeds the page, its help, the status line and the tests."""

from __future__ import annotations

import functools
import tomllib
from dataclasses import dataclass
from importlib import resources

__all__ = ["KeyBinding", "key_label", "key_table"]

_SIGNS = {"Space": "Space", "Escape": "Esc", "Enter": "↵", "ArrowLeft": "←", "ArrowRight": "→"} | {
    "ArrowUp": "↑",
    "ArrowDown": "↓",
}


@dataclass(frozen=True, slots=True)
class KeyBinding:
    """What a key does.

    Attributes
    ----------
    id : str
        Name of the action.
    keys : tuple of str
        Keys as the browser names them, "Ctrl+", "Alt+", "Shift+" before; several keys of one action are told
        apart by place.
    label, short : str
        What it does: for the help, and for the status line.
    scope : str
        "transport" (acted on by the transport itself) or the name of a dashboard.
    """

    id: str
    keys: tuple[str, ...]
    label: str
    short: str
    scope: str

    @property
    def caption(self) -> str:
        """The keys as written on a key cap: "1–7", "Shift Space"."""
        if len(self.keys) > 2:
            return f"{key_label(self.keys[0])}–{key_label(self.keys[-1])}"
        return " or ".join(key_label(k) for k in self.keys)


def key_label(key: str) -> str:
    """Return a key as people write it: capital letters, "Esc", "Shift Space"."""
    parts = [_SIGNS.get(p, p.upper() if len(p) == 1 else p) for p in key.split("+")] if key != "+" else ["+"]
    return " ".join(parts)


@functools.cache
def key_table(scope: str | None = None) -> tuple[KeyBinding, ...]:
    """Return the bindings of a scope, or all of them."""
    text = resources.files("workbench.state").joinpath("data/keys.toml").read_text(encoding="utf-8")
    rows = tuple(
        KeyBinding(r["id"], tuple(r["keys"]), r["label"], r["short"], r["scope"])
        for r in tomllib.loads(text)["keys"]
    )
    return rows if scope is None else tuple(r for r in rows if r.scope == scope)
