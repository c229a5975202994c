"""Which diphones of a target no unit has, and what stood in for each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from corpus_tools.core import Selection, Utterance
from corpus_tools.synthesis.model import PhoneClasses
from corpus_tools.synthesis.visible import how_it_differs

__all__ = ["StandIn", "stand_ins", "stand_ins_told"]


@dataclass(frozen=True, slots=True)
class StandIn:
    """One diphone that was spoken by another.

    Attributes
    ----------
    diphone, used : (str, str)
        What was wanted and what the corpus gave.
    time_s : float
        The boundary between the two phones in the target, s.
    source : str
        The unit that speaks it, ``recording:first-last``.
    differs : str
        What is seen to differ, for people; empty where both phones stay in their viseme classes.
    """

    diphone: tuple[str, str]
    used: tuple[str, str]
    time_s: float
    source: str
    differs: str = ""

    @property
    def sentence(self) -> str:
        """What a reader is told: "No usable unit has B-UW: P-UW stood in", and what is seen to differ."""
        told = f"No usable unit has {'-'.join(self.diphone)}: {'-'.join(self.used)} stood in"
        return f"{told}; {self.differs}" if self.differs else told


def stand_ins(selection: Selection, utterance: Utterance, phones: PhoneClasses) -> tuple[StandIn, ...]:
    """Return every diphone of the utterance for which another stood in, in order of time."""
    labels, spoken = utterance.labels, utterance.phones.intervals
    found = []
    for chosen in selection.chosen:
        instead = {index: used for index, _, used in chosen.backoff}
        for k in range(chosen.first, chosen.last):
            used = (instead.get(k, labels[k]), instead.get(k + 1, labels[k + 1]))
            wanted = (labels[k], labels[k + 1])
            if used != wanted:
                seen = (how_it_differs(phones, a, b) for a, b in zip(wanted, used, strict=True))
                differs = ", and ".join(filter(None, seen))
                found.append(StandIn(wanted, used, spoken[k].end_s, chosen.unit.key, differs))
    return tuple(found)


def stand_ins_told(found: Sequence[StandIn], n_diphones: int) -> tuple[str, tuple[str, ...]]:
    """Return what a reader is told of stand-ins.

    Parameters
    ----------
    found : sequence of StandIn
    n_diphones : int
        Diphones of the utterance.

    Returns
    -------
    summary : str
        How many diphones have no unit, and which, when it is most of them; else empty.
    sentences : tuple of str
        What stood in for each, told once.
    """
    sentences = tuple(dict.fromkeys(s.sentence for s in found))
    if 2 * len(found) <= n_diphones:
        return "", sentences
    names = ", ".join(dict.fromkeys("-".join(s.diphone) for s in found))
    return f"{len(found)} of {n_diphones} diphones have no unit: {names}", sentences
