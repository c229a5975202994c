"""What this speaker does naturally in a transition: the range of a signal over all its instances."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from corpus_tools.core import FloatArray, IntArray, Tier, UnitInventory
from corpus_tools.fragments.inventory import diphone_keys, diphone_rows, phone_codes, recording_mask

__all__ = ["natural_band"]

POINTS = 8
"""Steps from one phone centre to the next."""

LEAST = 3
"""Instances without which no range is given (our choice)."""

_APART_S = 10.0


def natural_band(
    inventory: UnitInventory,
    phones: Tier,
    signals: Sequence[FloatArray],
    exclude: Iterable[str] = (),
    percentiles: tuple[float, float] = (10.0, 90.0),
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the range of a signal over all instances of each diphone of a target, on the target's clock.

    Each instance is laid from phone centre to phone centre, the clock that fragments are cut by. Where the
    corpus holds fewer than three instances, the range is NaN.

    Parameters
    ----------
    inventory : UnitInventory
    phones : Tier
        Of the target.
    signals : sequence of (n_frames,) arrays
        The signal in each recording, in the order of the inventory, at the frames of its capture.
    exclude : iterable of str
        Recordings that are passed over.
    percentiles : (low, high)

    Returns
    -------
    times_s, low, high : (n_points,) float64
    """
    times, values, offsets = _one_row(inventory, signals)
    centres = 0.5 * (inventory.starts_s + inventory.ends_s) + offsets[inventory.recording_of]
    rows_of = diphone_rows(
        inventory, diphone_keys(inventory, phone_codes(inventory, [p.text for p in phones]))
    )
    usable = recording_mask(inventory, exclude)
    share = np.linspace(0.0, 1.0, POINTS + 1)
    target = np.array([p.centre_s for p in phones])
    at, low, high = [], [], []
    for k, rows in enumerate(rows_of):
        found = _instances(times, values, centres, rows[usable[inventory.recording_of[rows]]], share)
        limits = np.full((2, len(share)), np.nan)
        if len(found) >= LEAST:
            limits = np.percentile(found, percentiles, axis=0)
        at.append(target[k] + share * (target[k + 1] - target[k]))
        low.append(limits[0])
        high.append(limits[1])
    return np.concatenate(at), np.concatenate(low), np.concatenate(high)


def _one_row(
    inventory: UnitInventory, signals: Sequence[FloatArray]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Put all recordings on one time axis, far enough apart; return times, values, offset of each."""
    times, offsets, end = [], [], 0.0
    for recording in inventory.recordings:
        offsets.append(end)
        times.append(recording.capture.times_s + end)
        end += float(recording.capture.times_s[-1]) + _APART_S
    return np.concatenate(times), np.concatenate([np.asarray(s) for s in signals]), np.array(offsets)


def _instances(
    times: FloatArray, values: FloatArray, centres: FloatArray, rows: IntArray, share: FloatArray
) -> FloatArray:
    first, last = centres[rows], centres[rows + 1]
    return np.asarray(np.interp(first[:, None] + share * (last - first)[:, None], times, values))
