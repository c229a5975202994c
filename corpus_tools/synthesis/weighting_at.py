"""A g(u) of their own for some joins: by class of phone, by phone, or by number (beyond paper A).

Paper A section 5.1.3 blends every join with one weighting function. A stop wants its transition elsewhere
than an open vowel, and a single bad join wants a cure of its own, so that exceptions can be made; each is a
text that a config holds: ``bilabial=septic``, ``S=linear:-0.3``, ``4=exponential``.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from corpus_tools.core import InputError, counted
from corpus_tools.core.errors import suggestion
from corpus_tools.synthesis.usercurve import DEFAULT_CURVE
from corpus_tools.synthesis.weighting import Weighting, weighting

__all__ = ["WeightingAt", "parse_weighting_at", "weightings_of_joins"]

_FORM = re.compile(r"\s*([^=:\s]+)\s*=\s*([a-z-]+)\s*(?::\s*([-+]?[0-9.]+)\s*)?")


@dataclass(frozen=True, slots=True)
class WeightingAt:
    """One exception.

    Attributes
    ----------
    where : str
        A class of phones, a phone, or the number of a join, counted from 0 as in joins.csv.
    weighting : str
        g(u) by name.
    shape : float
        Its crossover, -1 to 1.
    """

    where: str
    weighting: str
    shape: float = 0.0


def parse_weighting_at(text: str) -> WeightingAt:
    """Return the exception that a text stands for.

    Parameters
    ----------
    text : str
        ``where=name`` or ``where=name:shape``.

    Raises
    ------
    InputError
        The text is not of that form, there is no such g(u), or the shape lies outside [-1, 1].
    """
    match = _FORM.fullmatch(text)
    try:
        shape = float(match[3] or 0.0) if match else 0.0
    except ValueError:
        match = None
    if match is None:
        raise InputError(
            f"'{text}' is no g(u) of a join; 'where=name' or 'where=name:shape' was expected, with a class "
            "of phones, a phone or the number of a join first, for example 'bilabial=septic:0.2'."
        )
    weighting(match[2], shape)
    return WeightingAt(match[1], match[2], shape)


def _kind(rule: WeightingAt, n_joins: int, classes: Mapping[str, str]) -> str:
    """Return what the place of an exception is: "join", "phone" or "class"."""
    if rule.where.isdecimal():
        if int(rule.where) < n_joins:
            return "join"
        raise InputError(
            f"g(u) was given for join {rule.where}, but the utterance has {counted(n_joins, 'join')}, "
            "counted from 0; leave the exception out for this utterance."
        )
    if rule.where in classes:
        return "phone"
    names = sorted(set(classes.values()))
    if rule.where in names:
        return "class"
    hint = suggestion(rule.where, [*names, *classes])
    raise InputError(
        f"g(u) was given for '{rule.where}', which is no phone and no class of phones{hint or '.'} "
        f"Classes: {', '.join(names)}."
    )


def weightings_of_joins(
    phones: Sequence[str],
    default: tuple[str, float],
    exceptions: Sequence[str] = (),
    classes: Mapping[str, str] | None = None,
    curve_weights: Sequence[float] = DEFAULT_CURVE,
) -> tuple[tuple[str, Weighting], ...]:
    """Return (name, g) of every join.

    The number of a join goes before its phone, a phone before its class, and of two exceptions for one place
    the later one holds.

    Parameters
    ----------
    phones : sequence of str
        The phone that is shared at each join.
    default : (name, shape)
        Where there is no exception.
    exceptions : sequence of str
        As of :func:`parse_weighting_at`.
    classes : mapping of phone -> class
        Of the phone set; without it only joins by number can be named.
    curve_weights : sequence of float
        Of the curve "user".

    Raises
    ------
    InputError
        An exception is none, or its place is not in the utterance or the phone set.
    """
    known = classes or {}
    by_kind: dict[str, dict[str, WeightingAt]] = {"join": {}, "phone": {}, "class": {}}
    for rule in map(parse_weighting_at, exceptions):
        place = str(int(rule.where)) if rule.where.isdecimal() else rule.where
        by_kind[_kind(rule, len(phones), known)][place] = rule
    found = []
    for k, phone in enumerate(phones):
        places = (("join", str(k)), ("phone", phone), ("class", known.get(phone, "")))
        hits = (by_kind[kind].get(place) for kind, place in places)
        rule = next((hit for hit in hits if hit), WeightingAt("", *default))
        found.append((rule.weighting, weighting(rule.weighting, rule.shape, curve_weights)))
    return tuple(found)
