"""Phone sets as data files: phones, silences, viseme classes, what is a bilabial, what a vowel."""

from __future__ import annotations

import functools
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from types import MappingProxyType

from corpus_tools.core import InputError, LabelError
from corpus_tools.core.errors import suggestion

__all__ = ["PhoneSet", "phone_set", "phone_set_names"]


@dataclass(frozen=True, slots=True, eq=False)
class PhoneSet:
    """A closed set of phones and what is known of each.

    Attributes
    ----------
    name : str
    phones : tuple of str
        Silence first.
    silence : str
    viseme_classes, display_classes : mapping of phone -> class
        For backoff (what looks alike), and for colours.
    bilabials, labiodentals, rounded, vowels : frozenset of str
    silence_words : frozenset of str
        Labels, in lower case, that mean silence.
    aliases : mapping of label -> phone
    strip_stress : bool
        Digits at the end of a label are stress marks.
    """

    name: str
    phones: tuple[str, ...]
    silence: str
    viseme_classes: Mapping[str, str]
    display_classes: Mapping[str, str]
    bilabials: frozenset[str]
    labiodentals: frozenset[str]
    rounded: frozenset[str]
    vowels: frozenset[str]
    silence_words: frozenset[str]
    aliases: Mapping[str, str]
    strip_stress: bool

    def viseme_class(self, phone: str) -> str:
        """Return the viseme class of a phone of the set.

        Raises
        ------
        LabelError
            The phone is not in the set.
        """
        return self.viseme_classes[self.normalise(phone)]

    def lip_shape(self, phone: str) -> str:
        """Return what the lips do that everyone sees: "closed", "on teeth", "rounded", or "" for nothing.

        Raises
        ------
        LabelError
            The phone is not in the set.
        """
        known = self.normalise(phone)
        shapes = (("closed", self.bilabials), ("on teeth", self.labiodentals), ("rounded", self.rounded))
        return next((shape for shape, phones in shapes if known in phones), "")

    def display_class(self, phone: str) -> str:
        """Return the class that gives a phone its colour."""
        return self.display_classes[self.normalise(phone)]

    def normalise(self, label: str) -> str:
        """Return the phone that a label stands for: blanks are silence, stress digits and case are dropped.

        Raises
        ------
        LabelError
            The label is no phone of the set; the message suggests the nearest.
        """
        text = label.strip()
        if text.lower() in self.silence_words:
            return self.silence
        upper = text.upper()
        if self.strip_stress:
            upper = upper.rstrip("0123456789")
        phone = self.aliases.get(upper, upper)
        if phone not in self.viseme_classes:
            hint = suggestion(phone, self.phones)
            raise LabelError(f"'{label}' is no phone of the set '{self.name}'{hint or '.'}")
        return phone


def phone_set_names() -> tuple[str, ...]:
    """Return the names of the phone sets that there are."""
    folder = resources.files("corpus_tools.speech") / "data"
    return tuple(sorted(f.name.removesuffix(".toml") for f in folder.iterdir() if f.name.endswith(".toml")))


def _inverted(classes: Mapping[str, list[str]]) -> Mapping[str, str]:
    return MappingProxyType({phone: name for name, phones in classes.items() for phone in phones})


@functools.cache
def phone_set(name: str) -> PhoneSet:
    """Return a phone set by name.

    Raises
    ------
    InputError
        There is none of that name; the message lists those that there are.
    """
    known = phone_set_names()
    if name not in known:
        hint = suggestion(name, known)
        raise InputError(f"There is no phone set '{name}'{hint or '.'} Known: {', '.join(known)}.")
    file = resources.files("corpus_tools.speech") / "data" / f"{name}.toml"
    data = tomllib.loads(file.read_text(encoding="utf-8"))
    viseme = _inverted(data["viseme_classes"])
    others = sorted(p for p in viseme if p != data["silence"])
    return PhoneSet(
        name=name,
        phones=(data["silence"], *others),
        silence=data["silence"],
        viseme_classes=viseme,
        display_classes=_inverted(data["display_classes"]),
        bilabials=frozenset(data["bilabials"]),
        labiodentals=frozenset(data["labiodentals"]),
        rounded=frozenset(data["rounded"]),
        vowels=frozenset(data["vowels"]),
        silence_words=frozenset(w.lower() for w in data["silence_words"]),
        aliases=MappingProxyType(dict(data.get("aliases", {}))),
        strip_stress=bool(data["strip_stress"]),
    )
