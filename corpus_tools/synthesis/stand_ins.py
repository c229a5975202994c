"""Which diphones of a target the corpus does not have, and what stood in for each."""

from __future__ import annotations

from dataclasses import dataclass

from corpus_tools.core import Selection, Utterance

__all__ = ["StandIn", "stand_ins"]


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
    """

    diphone: tuple[str, str]
    used: tuple[str, str]
    time_s: float
    source: str

    @property
    def sentence(self) -> str:
        """What a reader is told: "B-UW is not in the corpus: P-UW stood in"."""
        return f"{'-'.join(self.diphone)} is not in the corpus: {'-'.join(self.used)} stood in"


def stand_ins(selection: Selection, utterance: Utterance) -> tuple[StandIn, ...]:
    """Return every diphone of the utterance for which another stood in, in order of time."""
    labels, phones = utterance.labels, utterance.phones.intervals
    found = []
    for chosen in selection.chosen:
        instead = {index: used for index, _, used in chosen.backoff}
        for k in range(chosen.first, chosen.last):
            used = (instead.get(k, labels[k]), instead.get(k + 1, labels[k + 1]))
            if used != (labels[k], labels[k + 1]):
                found.append(StandIn((labels[k], labels[k + 1]), used, phones[k].end_s, chosen.unit.key))
    return tuple(found)
