"""The settings of methods: what kinds there are, and how a text becomes a value of one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal, get_args, get_origin

from corpus_tools.core import Registry
from corpus_tools.synthesis import WEIGHTINGS

__all__ = ["Components", "Fading", "Seconds", "Weight", "Weighting", "Within", "setting_value"]


@dataclass(frozen=True, slots=True)
class Within:
    """Bounds of a number, both included."""

    low: float
    high: float


Weight = Annotated[float, Within(0, 1e6)]
Seconds = Annotated[float, Within(0, 0.5)]
Fading = Annotated[float, Within(0.001, 0.3)]
Components = Annotated[int, Within(1, 60)]
Weighting = Annotated[str, WEIGHTINGS]
"""A weighting function by name."""

_SWITCH = {"on": True, "true": True, "off": False, "false": False}


def setting_value(kind: Any, text: str) -> Any:
    """Return the value that a text stands for.

    Parameters
    ----------
    kind : annotation
        bool, int, float or str; a Literal; int or float with :class:`Within`; str with a registry of names.
    text : str
        As it was typed.

    Raises
    ------
    ValueError
        It is none of this kind; the message says what was expected.
    """
    base, known = get_args(kind)[:2] if get_origin(kind) is Annotated else (kind, None)
    if base is bool:
        return _one_of(_SWITCH, text.lower(), "on or off")
    names = list(known) if isinstance(known, Registry) else list(get_args(base))
    if get_origin(base) is Literal or names:
        return _one_of({n: n for n in names}, text, f"one of {', '.join(names)}")
    expected = {int: "a whole number", float: "a number"}.get(base, "a word")
    if isinstance(known, Within):
        expected += f" from {known.low:g} to {known.high:g}"
    try:
        value = base(text)
    except ValueError:
        raise ValueError(expected) from None
    if isinstance(known, Within) and not known.low <= value <= known.high:
        raise ValueError(expected)
    return value


def _one_of(values: dict[str, Any], text: str, expected: str) -> Any:
    if text not in values:
        raise ValueError(expected)
    return values[text]
