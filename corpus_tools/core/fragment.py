"""Fragments of captured speech and the inventory of every span that can be one."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from corpus_tools.core.arrays import FloatArray, IntArray, frozen
from corpus_tools.core.errors import InputError, suggestion
from corpus_tools.core.selection import UnitRef
from corpus_tools.core.utterance import Recording

__all__ = ["Fragment", "UnitInventory"]


@dataclass(frozen=True, slots=True, eq=False)
class Fragment:
    """One unit cut out of its recording, with motion on both sides of it for the overlaps.

    Attributes
    ----------
    unit : UnitRef
    phones : tuple of str, n_phones
    edges_s : (n_phones + 1,) float64, s
        Phone boundaries on the clock of the source recording.
    times_s : (n_samples,) float64, s
        Source frame times, context included.
    motion_mm : (n_samples, n_markers, 3) float64, mm
    flags : (n_samples, n_markers) uint8
    """

    unit: UnitRef
    phones: tuple[str, ...]
    edges_s: FloatArray
    times_s: FloatArray
    motion_mm: FloatArray
    flags: npt.NDArray[np.uint8]

    def __post_init__(self) -> None:
        for key in ("edges_s", "times_s", "motion_mm"):
            object.__setattr__(self, key, frozen(getattr(self, key)))
        object.__setattr__(self, "flags", frozen(self.flags, np.uint8))

    @property
    def centres_s(self) -> FloatArray:
        """Phone centres on the source clock, shape (n_phones,); the unit spans the first to the last."""
        return np.asarray(0.5 * (self.edges_s[:-1] + self.edges_s[1:]))


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class UnitInventory:
    """All phones of all recordings in one row, and a sorted diphone index over them.

    Spans are indexed, not listed: a unit is any run of at least two phones inside one recording (paper A
    section 5.1: sentence, word, syllable and diphone units are views of that). Row `r` is the diphone
    (phone r, phone r + 1); the last phone of a recording starts none.

    Attributes
    ----------
    recordings : tuple of Recording
    phone_set : tuple of str
        Code -> phone.
    codes : (n_phones,) int32
    recording_of : (n_phones,) int32
    offsets : (n_recordings + 1,) int64
        First row of each recording.
    starts_s, ends_s : (n_phones,) float64
    keys : (n_phones,) int64
        ``code * len(phone_set) + next code``; -1 where no diphone starts.
    order : (n_phones,) int64
        Rows sorted by key (stable), for binary search.
    """

    recordings: tuple[Recording, ...]
    phone_set: tuple[str, ...]
    codes: npt.NDArray[np.int32]
    recording_of: npt.NDArray[np.int32]
    offsets: IntArray
    starts_s: FloatArray
    ends_s: FloatArray
    keys: IntArray
    order: IntArray
    _where: dict[str, int] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        for key, dtype in {
            "codes": np.int32,
            "recording_of": np.int32,
            "offsets": np.int64,
            "starts_s": np.float64,
            "ends_s": np.float64,
            "keys": np.int64,
            "order": np.int64,
        }.items():
            object.__setattr__(self, key, frozen(getattr(self, key), dtype))
        object.__setattr__(self, "_where", {r.name: i for i, r in enumerate(self.recordings)})

    @property
    def n_phones(self) -> int:
        """Number of phones, silences included."""
        return len(self.codes)

    def __contains__(self, name: object) -> bool:
        """Whether a recording of that name is in the inventory."""
        return name in self._where

    def recording_index(self, name: str) -> int:
        """Return the position of the recording called `name`; InputError with a suggestion if unknown."""
        try:
            return self._where[name]
        except KeyError:
            hint = suggestion(name, self._where)
            raise InputError(f"There is no recording '{name}' in the inventory{hint or '.'}") from None

    def rows(self, unit: UnitRef) -> tuple[int, int]:
        """Return the global rows of a unit's first and last phone."""
        base = int(self.offsets[self.recording_index(unit.recording)])
        return base + unit.first, base + unit.last

    def unit(self, first_row: int, last_row: int) -> UnitRef:
        """Return the :class:`UnitRef` of the rows `first_row` to `last_row`."""
        index = int(self.recording_of[first_row])
        base = int(self.offsets[index])
        return UnitRef(self.recordings[index].name, first_row - base, last_row - base)
