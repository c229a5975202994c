"""Places to extend: a name, a thing, and one law test that runs over every entry."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Generic, TypeVar

from corpus_tools.core.errors import InputError, suggestion

__all__ = ["Registry"]

T = TypeVar("T")


class Registry(Mapping[str, T], Generic[T]):
    """Named entries of one kind; unknown names are refused with a suggestion.

    Parameters
    ----------
    kind : str
        What the entries are, in the words of a message: "weighting function", "deformer".
    """

    def __init__(self, kind: str) -> None:
        self.kind = kind
        self._entries: dict[str, T] = {}

    def register(self, name: str) -> Callable[[T], T]:
        """Return a decorator that enters its object under `name`."""

        def enter(thing: T) -> T:
            self.add(name, thing)
            return thing

        return enter

    def add(self, name: str, thing: T) -> None:
        """Enter `thing` under `name`; a name can be taken once."""
        if name in self._entries:
            raise ValueError(f"the {self.kind} '{name}' is registered twice")
        self._entries[name] = thing

    def __getitem__(self, name: str) -> T:
        try:
            return self._entries[name]
        except KeyError:
            raise InputError(self._unknown(name)) from None

    def _unknown(self, name: str) -> str:
        known = ", ".join(self._entries)
        hint = suggestion(name, self._entries)
        return f"There is no {self.kind} called '{name}'{hint or '.'} Known: {known}."

    def __contains__(self, name: object) -> bool:
        return name in self._entries

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)
