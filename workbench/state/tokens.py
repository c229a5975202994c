"""Design tokens: one data file of colours, type and sizes that feeds CSS, controls, canvases and tests."""

from __future__ import annotations

import functools
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from types import MappingProxyType
from typing import Any

__all__ = ["THEMES", "Tokens", "css_variables", "read_tokens", "source_slots", "tokens"]

THEMES = ("light", "dark")
"""The themes, in the order of the pairs in the data file."""


@dataclass(frozen=True, slots=True)
class Tokens:
    """The tokens of one theme.

    Attributes
    ----------
    theme : str
        "light" or "dark".
    colours, phone_classes, sources : mapping of name -> "#rrggbb"
    type_roles : mapping of role -> (size px, line height px, weight)
    family, mono : str
        CSS font stacks.
    sizes : mapping of name -> px
    """

    theme: str
    colours: Mapping[str, str]
    phone_classes: Mapping[str, str]
    sources: Mapping[str, str]
    type_roles: Mapping[str, tuple[int, int, int]]
    family: str
    mono: str
    sizes: Mapping[str, int]

    def palette(self) -> dict[str, Any]:
        """Return everything a canvas draws with, as plain data: colours, classes, sources, font."""
        return {
            **self.colours,
            "classes": dict(self.phone_classes),
            "sources": list(self.sources.values()),
            "family": self.family,
        }


@functools.cache
def read_tokens() -> Mapping[str, Any]:
    """Return the token file as plain data."""
    text = resources.files("workbench.state").joinpath("data/tokens.toml").read_text(encoding="utf-8")
    return MappingProxyType(tomllib.loads(text))


@functools.cache
def tokens(theme: str) -> Tokens:
    """Return the tokens of a theme.

    Raises
    ------
    ValueError
        `theme` is neither "light" nor "dark".
    """
    which = THEMES.index(theme)
    data = read_tokens()
    roles = {k: tuple(v) for k, v in data["type"].items() if isinstance(v, list)}
    pairs = {
        group: MappingProxyType({k: v[which] for k, v in data[group].items()})
        for group in ("colours", "phone_classes", "sources")
    }
    return Tokens(
        theme=theme,
        **pairs,
        type_roles=MappingProxyType(roles),
        family=data["type"]["family"],
        mono=data["type"]["mono"],
        sizes=MappingProxyType(dict(data["sizes"])),
    )


def css_variables(theme: str) -> str:
    """Return CSS declarations ``--vsw-NAME: value;`` of a theme, one a line, sorted as in the file."""
    t = tokens(theme)
    lines = [f"--vsw-{k.replace('_', '-')}: {v};" for k, v in t.colours.items()]
    lines += [f"--vsw-class-{k}: {v};" for k, v in t.phone_classes.items()]
    lines += [f"--vsw-{k}: {v};" for k, v in t.sources.items()]
    lines += [f"--vsw-{k.replace('_', '-')}: {v}px;" for k, v in t.sizes.items()]
    lines += [f"--vsw-font: {t.family};", f"--vsw-mono: {t.mono};", f"color-scheme: {theme};"]
    return "\n".join(lines)


def source_slots(recordings: tuple[str, ...], n_slots: int = 6) -> tuple[int, ...]:
    """Return the colour slot of each fragment, by the order in which its recording first appears.

    Neighbours of different recordings always differ, also when there are more recordings than colours: the
    later fragment then takes the next colour.

    Parameters
    ----------
    recordings : tuple of str
        Source recording of each fragment, in the order of the utterance.
    n_slots : int
        Colours there are.
    """
    slot_of: dict[str, int] = {}
    slots: list[int] = []
    for index, name in enumerate(recordings):
        slot = slot_of.setdefault(name, len(slot_of) % n_slots)
        if index and recordings[index - 1] != name and slots[-1] == slot:
            slot = (slot + 1) % n_slots
        slots.append(slots[-1] if index and recordings[index - 1] == name else slot)
    return tuple(slots)
