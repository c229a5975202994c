"""What was done to a piece of data, in order, with the settings that were used."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

__all__ = ["History", "Step", "step"]


@dataclass(frozen=True, slots=True)
class Step:
    """One operation: its name and its settings as sorted (key, value) pairs, hashable."""

    name: str
    settings: tuple[tuple[str, Any], ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """Return ``{"step": name, **settings}`` for manifests and reports."""
        return {"step": self.name, **dict(self.settings)}


History = tuple[Step, ...]


def step(name: str, **settings: Any) -> Step:
    """Make a :class:`Step` from plain keywords."""
    return Step(name, tuple(sorted(settings.items())))
