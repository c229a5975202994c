"""Mean postures of viseme classes and phones, read where each is at its target."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping

import numpy as np
from scipy.interpolate import CubicSpline

from corpus_tools.core import FloatArray, Recording, Utterance
from corpus_tools.methods.training import TrainingSet, phone_anchors_s
from corpus_tools.speech import PhoneSet

__all__ = ["anchor_times_s", "class_targets_mm", "nearest_class"]


def anchor_times_s(utterance: Utterance, silence: str, first_s: float, last_s: float) -> FloatArray:
    """Return from when to when each phone is at its target, (n_phones, 2) s, within the given times."""
    return np.asarray(np.clip(phone_anchors_s(utterance, silence), first_s, last_s))


def _postures(recording: Recording, silence: str) -> FloatArray:
    """Return the posture of each phone at its target, (n_phones, n_markers, 3); of a rest at its near end."""
    capture, phones = recording.capture, recording.utterance.phones.intervals
    anchors = anchor_times_s(
        recording.utterance, silence, float(capture.times_s[0]), float(capture.times_s[-1])
    )
    at = np.where(np.arange(len(phones)) == 0, anchors[:, 1], anchors[:, 0])
    return np.asarray(CubicSpline(capture.times_s, capture.positions_mm)(at))


def class_targets_mm(training: TrainingSet) -> dict[str, FloatArray]:
    """Return the mean posture (n_markers, 3) mm of every viseme class that the recordings hold."""
    phones = training.phones
    found: dict[str, list[FloatArray]] = defaultdict(list)
    for recording in training.recordings:
        for label, posture in zip(
            recording.utterance.labels, _postures(recording, phones.silence), strict=True
        ):
            found[phones.viseme_class(label)].append(posture)
    return {name: np.mean(postures, axis=0) for name, postures in found.items()}


def nearest_class(phones: PhoneSet, phone: str, known: Mapping[str, object]) -> str:
    """Return the viseme class of a phone, or that of silence when the recordings hold none of that class."""
    name = phones.viseme_class(phone)
    return name if name in known else phones.viseme_class(phones.silence)
