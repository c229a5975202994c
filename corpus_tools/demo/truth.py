"""What was really there in a simulated recording: kept beside the corpus, where no pattern of it reads."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from corpus_tools.core import BoolArray, FloatArray, InputError, atomic_file
from corpus_tools.demo.actor import marker_names
from corpus_tools.demo.capture import Seen

__all__ = ["Truth", "read_truth", "write_truth"]

_KEPT_AS = {"skin_mm": np.float16, "face_mm": np.float32, "jig_mm": np.float32, "articulators": np.float32}
"""Smaller than they are in memory: below 0.001 mm of the 0.3 mm of skin, below 0.0001 mm of the face."""


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """A recording without anything that the capture added, and what it added.

    ``captured = rotation @ (face + skin, jig) + translation``, then noise, swaps, spikes and occlusions.

    Attributes
    ----------
    names : tuple of str
        All 73 markers, face first, whatever the layout of the corpus.
    rate_hz : float
    articulators : (n_frames, 5)
        Jaw, lip closure, rounding, spreading, lower lip to the teeth; 0 to 1.
    face_mm : (n_frames, 66, 3) mm
        Head-stabilised, without any disturbance.
    skin_mm : (n_frames, 66, 3) mm
    jig_mm : (n_frames, 7, 3) mm
        Head markers on the skull, slip included.
    rotation : (n_frames, 3, 3)
    translation_mm : (n_frames, 3) mm
    spiked, swapped, occluded : (n_frames, 73) bool
    slip_s : float
        When the jig slipped, s; NaN when it did not.
    """

    names: tuple[str, ...]
    rate_hz: float
    articulators: FloatArray
    face_mm: FloatArray
    skin_mm: FloatArray
    jig_mm: FloatArray
    rotation: FloatArray
    translation_mm: FloatArray
    spiked: BoolArray
    swapped: BoolArray
    occluded: BoolArray
    slip_s: float

    @classmethod
    def of(cls, face_mm: FloatArray, articulators: FloatArray, seen: Seen, rate_hz: float) -> Truth:
        """Gather the truth of one recording."""
        return cls(
            marker_names(),
            rate_hz,
            articulators,
            face_mm,
            seen.skin_mm,
            seen.jig_mm,
            seen.rotation,
            seen.translation_mm,
            seen.spiked,
            seen.swapped,
            seen.occluded,
            seen.slip_s,
        )


def write_truth(path: str | Path, truth: Truth) -> None:
    """Write the truth of a recording as a numpy archive; equal truths, equal bytes."""
    arrays: dict[str, Any] = {f.name: np.asarray(getattr(truth, f.name)) for f in fields(truth)}
    arrays |= {key: arrays[key].astype(kind) for key, kind in _KEPT_AS.items()}
    with atomic_file(path) as temporary, temporary.open("wb") as stream:
        np.savez_compressed(stream, **arrays)


def read_truth(path: str | Path) -> Truth:
    """Read the truth of a recording, in double precision.

    Raises
    ------
    InputError
        There is no such file.
    """
    place = Path(path)
    if not place.is_file():
        raise InputError(f"'{place}' is not there: only simulated corpora have a folder 'truth'.")
    with place.open("rb") as stream, np.load(stream, allow_pickle=False) as data:
        found = {key: data[key] for key in data.files}
    doubled = {key: found[key].astype(np.float64) for key in _KEPT_AS}
    scalars = {"rate_hz": float(found["rate_hz"]), "slip_s": float(found["slip_s"])}
    return Truth(**(found | doubled | scalars | {"names": tuple(str(n) for n in found["names"])}))
