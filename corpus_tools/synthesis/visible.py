"""What is seen to be lost when another phone stands in: the viseme class, and what the lips do."""

from __future__ import annotations

from collections.abc import Iterable

from corpus_tools.synthesis.model import PhoneClasses

__all__ = ["SAME_CLASS", "how_it_differs", "visible_losses"]

SAME_CLASS = 1
"""Greatest loss of a phone that stays in its viseme class."""

_SAME_LIPS, _LIPS_TOO_MANY = 2, 3
_LOST = {"rounded": 4, "on teeth": 6, "closed": 8}
_NEAR = {("on teeth", "closed"): 5, ("closed", "on teeth"): 7}
_DOES = {"closed": "closes the lips", "on teeth": "puts the lip on the teeth", "rounded": "rounds the lips"}


def _loss(phones: PhoneClasses, wanted: str, used: str) -> int:
    if wanted == used:
        return 0
    if phones.viseme_class(wanted) == phones.viseme_class(used):
        return SAME_CLASS
    shape, other = phones.lip_shape(wanted), phones.lip_shape(used)
    if shape == other:
        return _SAME_LIPS
    if not shape:
        return _LIPS_TOO_MANY
    return _NEAR.get((shape, other), _LOST[shape])


def visible_losses(phones: PhoneClasses, wanted: str, known: Iterable[str]) -> tuple[int, ...]:
    """Return how much is lost to the eye when each of the `known` phones stands in for `wanted`.

    The order is our choice; it follows what a viewer notices first: 0 the phone itself, 1 its viseme class,
    2 another class with the same lips, 3 lips that do something where nothing is wanted, 4 a lost rounding,
    5 closed lips for the lip on the teeth, 6 a lost lip on the teeth, 7 the lip on the teeth for closed lips,
    8 a lost closure. So no closure is given up for anything else, and no lip on the teeth for a rounding.
    """
    return tuple(_loss(phones, wanted, used) for used in known)


def how_it_differs(phones: PhoneClasses, wanted: str, used: str) -> str:
    """Return a clause on what is seen to differ, empty where the viseme class is the same."""
    if phones.viseme_class(wanted) == phones.viseme_class(used):
        return ""
    shape, other = phones.lip_shape(wanted), phones.lip_shape(used)
    if shape == other:
        return f"{used} does not look like {wanted}"
    doer, seen = (wanted, shape) if shape else (used, other)
    return f"its lips differ: {doer} {_DOES[seen]}"
