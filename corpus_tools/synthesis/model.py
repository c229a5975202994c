"""An inventory prepared for selection: everything about it that does not depend on the target."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from corpus_tools.core import FloatArray, IntArray, UnitInventory, frozen
from corpus_tools.speech.places import phone_places, stress_codes
from corpus_tools.synthesis.basis import JoinFeatures, PostureBasis, join_features, posture_basis

__all__ = ["SHORTEST_S", "PhoneClasses", "SelectionModel", "prepare_selection"]

SHORTEST_S = 0.02
"""Shorter phones count as this long: below it, a label says more about the labeller than about time."""


class PhoneClasses(Protocol):
    """What selection needs to know of a phone set."""

    @property
    def silence(self) -> str:
        """The phone that stands for silence."""

    @property
    def vowels(self) -> frozenset[str]:
        """The phones that a syllable has at its heart."""

    def viseme_class(self, phone: str) -> str:
        """Return the name of the viseme class of a phone."""

    def lip_shape(self, phone: str) -> str:
        """Return what the lips do that everyone sees: "closed", "on teeth", "rounded", or ""."""


@dataclass(frozen=True, slots=True, eq=False)
class SelectionModel:
    """An inventory with everything about it that does not depend on the target; made once, read-only.

    Attributes
    ----------
    inventory : UnitInventory
    phones : PhoneClasses
    basis : PostureBasis
    joins : JoinFeatures
    classes : (n_codes + 1,) int64
        Viseme class of each code; the last entry is that of silence, which stands beyond both ends.
    class_names : tuple of str
    class_gaps : (n_classes, n_classes) float64
        How far the mean postures of two classes lie apart, as a share of the two farthest; 0 to 1.
    log_durations : (n_phones,) float64
        log of the duration in s.
    left, right : (n_phones,) int64
        Code before row r, and code after row r + 1; the code beyond an end is n_codes.
    place, stress : (n_phones,) int64
        Codes of :func:`~corpus_tools.speech.places.phone_places` and
        :func:`~corpus_tools.speech.places.stress_codes`.
    flagged : (n_phones,) float64
        Share of the marker samples of diphone r that were filled or are doubtful.
    """

    inventory: UnitInventory
    phones: PhoneClasses
    basis: PostureBasis
    joins: JoinFeatures
    classes: IntArray
    class_names: tuple[str, ...]
    class_gaps: FloatArray
    log_durations: FloatArray
    left: IntArray
    right: IntArray
    place: IntArray
    stress: IntArray
    flagged: FloatArray

    def __post_init__(self) -> None:
        for key in ("classes", "left", "right", "place", "stress"):
            object.__setattr__(self, key, frozen(getattr(self, key), np.int64))
        for key in ("class_gaps", "log_durations", "flagged"):
            object.__setattr__(self, key, frozen(getattr(self, key)))


def prepare_selection(
    inventory: UnitInventory,
    phone_set: PhoneClasses,
    n_components: int = 12,
    markers: Sequence[str] | None = None,
) -> SelectionModel:
    """Compute once what both searches need of an inventory.

    Parameters
    ----------
    inventory : UnitInventory
    phone_set : PhoneClasses
        A phone set: its silence and its viseme classes.
    n_components : int
        Principal components of the join distance.
    markers : sequence of str, optional
        Markers of the join distance; all outside region "head" when not given.

    Raises
    ------
    LabelError
        A phone of the inventory is not in the phone set.
    MotionError, CorpusError
        The captures have not been cleaned.
    """
    basis = posture_basis(inventory, markers, n_components)
    names = [phone_set.viseme_class(p) for p in (*inventory.phone_set, phone_set.silence)]
    class_names = tuple(dict.fromkeys(names))
    left, right = _neighbours(inventory)
    joins = join_features(inventory, basis)
    spoken = [r.utterance for r in inventory.recordings]
    classes = np.array([class_names.index(n) for n in names])
    return SelectionModel(
        inventory=inventory,
        phones=phone_set,
        basis=basis,
        joins=joins,
        classes=classes,
        class_names=class_names,
        class_gaps=_class_gaps(joins.position, classes[inventory.codes], len(class_names)),
        log_durations=np.log(np.maximum(inventory.ends_s - inventory.starts_s, SHORTEST_S)),
        left=left,
        right=right,
        place=np.concatenate([phone_places(u, phone_set.vowels, phone_set.silence) for u in spoken]),
        stress=np.concatenate([stress_codes(u) for u in spoken]),
        flagged=_flagged_share(inventory),
    )


def _class_gaps(position: FloatArray, classes: IntArray, n_classes: int) -> FloatArray:
    """Distances between the mean postures of the classes, the largest 1; 1 too where a class has no phone."""
    count = np.bincount(classes, minlength=n_classes)
    sums = np.stack([np.bincount(classes, column, n_classes) for column in position.T], axis=1)
    means = sums / np.maximum(count, 1)[:, None]
    gaps = np.asarray(np.linalg.norm(means[:, None] - means, axis=2))
    known = np.ix_(count > 0, count > 0)
    shares = np.ones((n_classes, n_classes))
    shares[known] = gaps[known] / max(float(gaps[known].max()), 1e-12)
    np.fill_diagonal(shares, 0.0)
    return shares


def _neighbours(inventory: UnitInventory) -> tuple[IntArray, IntArray]:
    n_codes = len(inventory.phone_set)
    codes = inventory.codes.astype(np.int64)
    follows = inventory.keys >= 0
    left = np.full(len(codes), n_codes)
    left[1:] = np.where(follows[:-1], codes[:-1], n_codes)
    right = np.full(len(codes), n_codes)
    right[:-2] = np.where(follows[:-2] & follows[1:-1], codes[2:], n_codes)
    return left, right


def _flagged_share(inventory: UnitInventory) -> FloatArray:
    """Share of flagged samples from the centre of each phone to that of the next; 0 where no frame lies."""
    centres = 0.5 * (inventory.starts_s + inventory.ends_s)
    share = np.zeros(inventory.n_phones)
    for index, recording in enumerate(inventory.recordings):
        flagged = recording.capture.flagged
        if not flagged.any():
            continue
        rows = slice(int(inventory.offsets[index]), int(inventory.offsets[index + 1]))
        sums = np.concatenate([[0.0], np.cumsum(flagged.mean(axis=1))])
        edges = np.searchsorted(recording.capture.times_s, centres[rows])
        frames = np.diff(edges)
        share[rows][:-1] = (sums[edges[1:]] - sums[edges[:-1]]) / np.maximum(frames, 1)
    return share
