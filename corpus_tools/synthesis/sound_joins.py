"""What units sound like where they can be joined: at the centre of every phone of an inventory."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np

from corpus_tools.core import FloatArray, UnitInventory, frozen
from corpus_tools.speech.acoustics import SOUND_FEATURES, sound_features

__all__ = ["join_sounds"]

_KEPT: WeakKeyDictionary[UnitInventory, FloatArray] = WeakKeyDictionary()


def join_sounds(inventory: UnitInventory) -> FloatArray:
    """Return the sound at the centre of every phone, measured when it is first asked for.

    Returns
    -------
    (n_phones, SOUND_FEATURES) float64
        Each feature over its standard deviation in the corpus, all together so that a distance of 1 is the
        root mean square distance from the mean, as in posture. 0, the mean, where a recording has no sound.
    """
    if inventory not in _KEPT:
        _KEPT[inventory] = frozen(_measured(inventory))
    return _KEPT[inventory]


def _measured(inventory: UnitInventory) -> FloatArray:
    centres = 0.5 * (inventory.starts_s + inventory.ends_s)
    found = np.full((inventory.n_phones, SOUND_FEATURES), np.nan)
    for index, recording in enumerate(inventory.recordings):
        rows = slice(int(inventory.offsets[index]), int(inventory.offsets[index + 1]))
        if recording.utterance.audio is not None:
            found[rows] = sound_features(recording.utterance.audio, centres[rows])
    known = np.isfinite(found).all(axis=1)
    if not known.any():
        return np.zeros_like(found)
    found -= found[known].mean(axis=0)
    found /= np.maximum(found[known].std(axis=0), 1e-9) * np.sqrt(SOUND_FEATURES)
    return np.where(known[:, None], found, 0.0)
