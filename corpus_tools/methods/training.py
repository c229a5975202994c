"""What methods are fitted on: recordings, and what several methods need of them, computed once."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from functools import cached_property
from typing import Any, TypeVar, cast

import numpy as np

from corpus_tools.core import BoolArray, FloatArray, Recording, Utterance, speech_span_s
from corpus_tools.fragments import build_inventory
from corpus_tools.fragments.posture import without_bias
from corpus_tools.speech import PhoneSet
from corpus_tools.synthesis import PostureBasis, SelectionModel, prepare_selection
from corpus_tools.synthesis.basis import principal_basis
from corpus_tools.synthesis.lips import LipModel, lip_model

__all__ = ["CONTEXT_S", "SPEECH_MARGIN_S", "TrainingSet", "phone_anchors_s"]

T = TypeVar("T")

CONTEXT_S = 0.4
"""Motion cut on both sides of a unit, s: half the longest overlap and a margin for resampling."""

SPEECH_MARGIN_S = 0.12
"""Motion this close to speech counts as speech, s: lips begin and end to move outside the labels."""

REST_ANCHOR_S = 0.15
"""How far from speech a silence has come to rest, s (our choice: about the time of a lip gesture)."""


def phone_anchors_s(utterance: Utterance, silence: str) -> FloatArray:
    """Return from when to when each phone is at its target, (n_phones, 2) s.

    A phone is there at its centre alone, a silence from :data:`REST_ANCHOR_S` after speech to as long before
    it (a short one at its centre); silences at the ends reach out without limit.
    """
    phones = utterance.phones.intervals
    anchors = np.array([[p.centre_s, p.centre_s] for p in phones])
    for k, phone in enumerate(phones):
        if phone.text == silence:
            rest = min(REST_ANCHOR_S, 0.5 * phone.duration_s)
            anchors[k] = phone.start_s + rest, phone.end_s - rest
            if k == 0:
                anchors[k, 0] = -np.inf
            if k == len(phones) - 1:
                anchors[k, 1] = np.inf
    return anchors


class TrainingSet:
    """Cleaned recordings in their own posture, the phone set, and what methods share of them.

    Everything is computed from these recordings alone, when it is first asked for, and kept: several methods
    that are fitted on one set share principal components, inventories and lips.

    Parameters
    ----------
    recordings : sequence of Recording
        Face markers only, cleaned, the same markers in all.
    phones : PhoneSet
    rate_hz : float
        Of the motion that is predicted, Hz.
    """

    def __init__(self, recordings: Sequence[Recording], phones: PhoneSet, rate_hz: float = 120.0) -> None:
        self.recordings = tuple(recordings)
        self.phones = phones
        self.rate_hz = rate_hz
        self._kept: dict[tuple[Hashable, ...], Any] = {}

    def shared(self, key: tuple[Hashable, ...], make: Callable[[], T]) -> T:
        """Return what `make` gives, made once under `key` and kept for the next method that asks."""
        if key not in self._kept:
            self._kept[key] = make()
        return cast("T", self._kept[key])

    @property
    def markers(self) -> tuple[str, ...]:
        """Names of the face markers."""
        return self.recordings[0].capture.names

    @cached_property
    def freed(self) -> tuple[Recording, ...]:
        """The recordings without the posture that each keeps constantly."""
        return without_bias(self.recordings, self.phones.silence)[0]

    def of(self, remove_bias: bool) -> tuple[Recording, ...]:
        """Return the recordings freed of their postures, or in them."""
        return self.freed if remove_bias else self.recordings

    def selection(self, remove_bias: bool, components: int) -> SelectionModel:
        """Return the inventory of all units, prepared for both searches."""
        return self.shared(
            ("selection", remove_bias, components),
            lambda: prepare_selection(build_inventory(self.of(remove_bias)), self.phones, components),
        )

    def lips(self, remove_bias: bool, components: int) -> LipModel:
        """Return how the lips of this speaker close."""
        key = ("lips", remove_bias, components)
        return self.shared(key, lambda: lip_model(self.of(remove_bias), self.phones, components))

    def speaking(self, recording: Recording) -> BoolArray:
        """Return the frames of a recording in which there is speech, margin included, (n_frames,)."""
        low, high = speech_span_s(recording.utterance, self.phones.silence, SPEECH_MARGIN_S)
        times = recording.capture.times_s
        return np.asarray((times >= low) & (times <= high))

    def speech_frames_mm(self, remove_bias: bool) -> FloatArray:
        """Return all frames of speech, (n_frames, n_markers, 3) mm."""
        return np.concatenate([r.capture.positions_mm[self.speaking(r)] for r in self.of(remove_bias)])

    def basis(self, remove_bias: bool, components: int) -> PostureBasis:
        """Return the principal components of the frames of speech."""
        return self.shared(
            ("basis", remove_bias, components),
            lambda: _principal(self.speech_frames_mm(remove_bias), self.markers, components),
        )

    def times_s(self, utterance: Utterance) -> FloatArray:
        """Return the clock of a prediction: uniform, from 0 to the end of the utterance, s."""
        n = int(np.floor(utterance.duration_s * self.rate_hz + 1e-6)) + 1
        return np.arange(n) / self.rate_hz


def _principal(frames_mm: FloatArray, names: tuple[str, ...], n: int) -> PostureBasis:
    flat = frames_mm.reshape(len(frames_mm), -1)
    mean = flat.mean(axis=0)
    centred = flat - mean
    return principal_basis(names, mean, centred.T @ centred / len(centred), n)
