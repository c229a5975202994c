"""Ways from timed phones to marker motion, under one interface.

A method is found by its id. Those made of fragments choose units first; their motion is then rendered by
:mod:`corpus_tools.synthesis`, so that a change of g(u) needs no new search.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from corpus_tools.core import Registry, Selection
from corpus_tools.synthesis import select_greedy, select_viterbi

__all__ = ["METHODS", "FragmentMethod"]


@dataclass(frozen=True, slots=True)
class FragmentMethod:
    """A method of paper A: choose motion fragments, then align, resample and blend them.

    Attributes
    ----------
    name : str
        Method id, as on the command line.
    summary : str
        One sentence for lists and tooltips.
    search : callable
        ``search(model, utterance, *, exclude, pins, bans, **weights) -> Selection``.
    """

    name: str
    summary: str
    search: Callable[..., Selection]


METHODS: Registry[FragmentMethod] = Registry("method")

METHODS.add(
    "greedy",
    FragmentMethod(
        "greedy", "Longest fragment first, as paper A prints it (its endless loop mended).", select_greedy
    ),
)
METHODS.add(
    "viterbi",
    FragmentMethod("viterbi", "The cheapest path over timing, context and join costs.", select_viterbi),
)
