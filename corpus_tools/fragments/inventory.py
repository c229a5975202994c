"""The unit inventory: every run of phones of every recording, found through one sorted diphone index.

Paper A section 5.1 extracts diphone, syllable, word and sentence fragments. All of them, and every run in
between, are spans of one row of phones; indexing spans instead of listing units keeps the inventory closed
under taking parts, which is what makes longest-first selection succeed whenever the diphones are there.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence

import numpy as np
import numpy.typing as npt

from corpus_tools.core import BoolArray, CorpusError, IntArray, LabelError, Recording, UnitInventory
from corpus_tools.core.errors import suggestion

__all__ = ["build_inventory", "diphone_keys", "diphone_rows", "find_spans", "phone_codes", "recording_mask"]

GAP_TOLERANCE_S = 1e-3
"""Two intervals farther apart than this are no transition (our choice: below a frame of any capture)."""


def build_inventory(
    recordings: Iterable[Recording], phone_set_phones: Sequence[str] | None = None
) -> UnitInventory:
    """Index the phones of all recordings (paper A section 5.1).

    Recordings are put in the order of their names, so that nothing downstream depends on the order of files
    and "first row" breaks every tie by recording name, then position.

    Parameters
    ----------
    recordings : iterable of Recording
    phone_set_phones : sequence of str, optional
        Code -> phone; the sorted phones of the recordings when not given.

    Raises
    ------
    CorpusError
        There is no recording, or two have one name.
    LabelError
        A phone is not in `phone_set_phones`.
    """
    ordered = tuple(sorted(recordings, key=lambda r: r.name))
    _check_names(ordered)
    intervals = [interval for r in ordered for interval in r.utterance.phones.intervals]
    texts = [interval.text for interval in intervals]
    phones = tuple(sorted(set(texts)) if phone_set_phones is None else phone_set_phones)
    codes = _encode(texts, phones)
    counts = np.array([len(r.utterance.phones) for r in ordered], dtype=np.int64)
    starts = np.array([interval.start_s for interval in intervals])
    ends = np.array([interval.end_s for interval in intervals])
    recording_of = np.repeat(np.arange(len(ordered), dtype=np.int32), counts)
    keys = _keys(codes, recording_of, starts, ends, len(phones))
    return UnitInventory(
        recordings=ordered,
        phone_set=phones,
        codes=codes,
        recording_of=recording_of,
        offsets=np.concatenate([[0], np.cumsum(counts)]),
        starts_s=starts,
        ends_s=ends,
        keys=keys,
        order=_sorted_rows(keys, len(phones) ** 2),
    )


def _check_names(ordered: tuple[Recording, ...]) -> None:
    if not ordered:
        raise CorpusError("There is no labelled recording to take units from; add recordings to the corpus.")
    for before, after in itertools.pairwise(ordered):
        if before.name == after.name:
            raise CorpusError(f"Two recordings are called '{before.name}'; give each its own id.")


def _encode(texts: list[str], phones: tuple[str, ...]) -> npt.NDArray[np.int32]:
    code_of = {phone: code for code, phone in enumerate(phones)}
    try:
        return np.fromiter((code_of[t] for t in texts), dtype=np.int32, count=len(texts))
    except KeyError as error:
        phone = str(error.args[0])
        raise LabelError(
            f"The phone '{phone}' is not in the phone set{suggestion(phone, phones) or '.'}"
        ) from None


def _keys(
    codes: npt.NDArray[np.int32],
    recording_of: npt.NDArray[np.int32],
    starts_s: npt.NDArray[np.float64],
    ends_s: npt.NDArray[np.float64],
    n_codes: int,
) -> IntArray:
    keys = np.full(len(codes), -1, dtype=np.int64)
    joined = recording_of[:-1] == recording_of[1:]
    joined &= starts_s[1:] - ends_s[:-1] <= GAP_TOLERANCE_S
    keys[:-1][joined] = codes[:-1][joined].astype(np.int64) * n_codes + codes[1:][joined]
    return keys


def _sorted_rows(keys: IntArray, n_keys: int) -> IntArray:
    small = (
        keys.astype(np.int16) if n_keys < 2**15 else keys
    )  # 16-bit keys are sorted by radix, in linear time
    return np.argsort(small, kind="stable")


def phone_codes(inventory: UnitInventory, phones: Sequence[str]) -> IntArray:
    """Return the code of each phone in the inventory, -1 where it holds none; shape (n_phones,)."""
    code_of = {phone: code for code, phone in enumerate(inventory.phone_set)}
    return np.array([code_of.get(phone, -1) for phone in phones], dtype=np.int64)


def diphone_keys(inventory: UnitInventory, codes: IntArray) -> IntArray:
    """Return the key of each pair of neighbours, -2 where a code is unknown; shape (n_phones - 1,)."""
    keys = codes[:-1] * len(inventory.phone_set) + codes[1:]
    return np.where((codes[:-1] < 0) | (codes[1:] < 0), -2, keys)


def diphone_rows(inventory: UnitInventory, keys: IntArray) -> list[IntArray]:
    """Return, for each diphone key, the rows where that diphone starts, in ascending order."""
    wanted = np.ascontiguousarray(keys, dtype=np.int64)
    low = np.searchsorted(inventory.keys, wanted, side="left", sorter=inventory.order)
    high = np.searchsorted(inventory.keys, wanted, side="right", sorter=inventory.order)
    return [inventory.order[a:b] for a, b in zip(low, high, strict=True)]


def recording_mask(inventory: UnitInventory, exclude: Iterable[str]) -> BoolArray:
    """Return which recordings may be used, shape (n_recordings,).

    Names that the inventory does not hold are passed over: to leave out what is not there changes nothing.
    """
    usable = np.ones(len(inventory.recordings), dtype=np.bool_)
    usable[[inventory.recording_index(name) for name in exclude if name in inventory]] = False
    return usable


def find_spans(inventory: UnitInventory, phones: Sequence[str], exclude: Iterable[str] = ()) -> IntArray:
    """Find every occurrence of a run of phones: FIND-UNIT of paper A section 5.1.1.

    Parameters
    ----------
    inventory : UnitInventory
    phones : sequence of str, at least two
    exclude : iterable of str
        Recordings that are passed over.

    Returns
    -------
    (n_found,) int64
        Row of the first phone of each occurrence, ascending; no occurrence reaches into another recording.
    """
    if len(phones) < 2:
        raise LabelError(f"A unit spans at least two phones; {len(phones)} given.")
    keys = diphone_keys(inventory, phone_codes(inventory, phones))
    rows = diphone_rows(inventory, keys[:1])[0]
    rows = rows[recording_mask(inventory, exclude)[inventory.recording_of[rows]]]
    for step, key in enumerate(keys[1:], start=1):
        rows = rows[inventory.keys[rows + step] == key]
    return rows
