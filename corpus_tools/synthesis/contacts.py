"""Every contact that the lips have to make in an utterance, and whether the motion makes it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from corpus_tools.core import Interval, Trajectory, Utterance
from corpus_tools.speech import PhoneSet
from corpus_tools.synthesis.lips import LipContact, LipModel

__all__ = ["Contact", "lip_contacts"]

TOLERANCE_MM = 0.05


@dataclass(frozen=True, slots=True)
class Contact:
    """One contact of an utterance (columns of ``contacts.csv``).

    Attributes
    ----------
    phone : str
    start_s, end_s : float, s
    kind : str
        ``closed``: the lips meet; ``on teeth``: the lower lip meets the upper teeth.
    time_s : float
        When in the phone they are nearest.
    nearest_mm : float
        How far they are from contact then; 0 or less: in contact, as 95 of 100 of the speaker's own are.
    held_s : float
        For how long in the phone, in one piece.
    made : bool
    """

    phone: str
    start_s: float
    end_s: float
    kind: str
    time_s: float
    nearest_mm: float
    held_s: float
    made: bool


def lip_contacts(
    lips: LipModel, trajectory: Trajectory, utterance: Utterance, phones: PhoneSet
) -> tuple[Contact, ...]:
    """Return every p b m and f v of an utterance, in order, as the motion makes them.

    Parameters
    ----------
    lips : LipModel
        What a contact is for this speaker; kinds that the corpus does not have are left out.
    trajectory : Trajectory
    utterance : Utterance
    phones : PhoneSet
    """
    kinds = ((lips, phones.bilabials, "closed"), (lips.on_teeth, phones.labiodentals, "on teeth"))
    found = [
        _contact(trajectory, phone, contact, kind)
        for contact, labels, kind in kinds
        if np.isfinite(contact.threshold_mm)
        for phone in utterance.phones
        if phone.text in labels
    ]
    return tuple(sorted(found, key=lambda c: c.start_s))


def _contact(trajectory: Trajectory, phone: Interval, contact: LipContact, kind: str) -> Contact:
    times = np.asarray(trajectory.times_s)
    inside = np.flatnonzero((times >= phone.start_s) & (times <= phone.end_s))
    if not len(inside):
        inside = np.array([int(np.argmin(np.abs(times - phone.centre_s)))])
    gap = np.einsum("fmk,mk->f", trajectory.values_mm[inside], contact.functional) - contact.threshold_mm
    at = int(np.argmin(gap))
    edges = np.flatnonzero(np.diff(np.concatenate([[False], gap <= TOLERANCE_MM, [False]]).astype(int)))
    longest = int(np.max(edges[1::2] - edges[::2], initial=0))
    spacing_s = float(times[1] - times[0]) if len(times) > 1 else 0.0
    return Contact(
        phone=phone.text,
        start_s=phone.start_s,
        end_s=phone.end_s,
        kind=kind,
        time_s=float(times[inside[at]]),
        nearest_mm=float(gap[at]),
        held_s=longest * spacing_s,
        made=bool(gap[at] <= TOLERANCE_MM),
    )
