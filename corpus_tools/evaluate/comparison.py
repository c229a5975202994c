"""A prediction beside the recording that it never saw, in the frames that are compared."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline

from corpus_tools.core import (
    BoolArray,
    Capture,
    FloatArray,
    IntArray,
    Recording,
    Trajectory,
    region_columns,
    speech_span_s,
)
from corpus_tools.evaluate.natural import Natural, articulators
from corpus_tools.methods import SPEECH_MARGIN_S
from corpus_tools.speech import PhoneSet

__all__ = ["Comparison", "curve_at"]


def curve_at(times_s: FloatArray, values: FloatArray, at_s: FloatArray) -> FloatArray:
    """Return a cubic spline through frames, read at other times; the nearest frame beyond both ends."""
    return np.asarray(CubicSpline(times_s, values)(np.clip(at_s, times_s[0], times_s[-1])))


class Comparison:
    """One held-out sentence: what was recorded, what was predicted.

    Error metrics look at the captured frames of speech (:data:`~corpus_tools.methods.SPEECH_MARGIN_S` around
    it included), so that nothing interpolated is taken for measured; accelerations and closures are looked
    at in the frames of the prediction.

    Parameters
    ----------
    recording : Recording
        In its own posture.
    prediction : Trajectory
    natural : Natural
    phones : PhoneSet
    words : (n_frames,) bool, optional
        Captured frames inside words that the training recordings hold with the same neighbours.
    instants_s : (n,) s, optional
        Where accelerations are looked at as around a join; the joins of the prediction when None. A recording
        has no joins: it is looked at where the methods have theirs.
    """

    def __init__(
        self,
        recording: Recording,
        prediction: Trajectory,
        natural: Natural,
        phones: PhoneSet,
        words: BoolArray | None = None,
        instants_s: FloatArray | None = None,
    ) -> None:
        self.recording = recording
        self.prediction = prediction
        self.natural = natural
        self.phones = phones
        joins = np.array([join.time_s for join in prediction.joins])
        self.instants_s = joins if instants_s is None else instants_s
        capture = recording.capture
        self.span_s = speech_span_s(recording.utterance, phones.silence, SPEECH_MARGIN_S)
        self.frames = np.flatnonzero(
            (capture.times_s >= self.span_s[0]) & (capture.times_s <= self.span_s[1])
        )
        every = np.zeros(capture.n_frames, dtype=np.bool_)
        self.in_words = (every if words is None else words)[self.frames]

    @property
    def capture(self) -> Capture:
        """The recording in its own posture."""
        return self.recording.capture

    @property
    def times_s(self) -> FloatArray:
        """Times of the compared frames, (n_frames,) s."""
        return self.capture.times_s[self.frames]

    @cached_property
    def truth_mm(self) -> FloatArray:
        """What was recorded, (n_frames, n_markers, 3) mm."""
        return np.asarray(self.capture.positions_mm[self.frames])

    @cached_property
    def made_mm(self) -> FloatArray:
        """What was predicted, at the same times, (n_frames, n_markers, 3) mm."""
        return curve_at(self.prediction.times_s, self.prediction.values_mm, self.times_s)

    @cached_property
    def measured(self) -> BoolArray:
        """Samples that were captured, neither filled nor doubtful, (n_frames, n_markers)."""
        return np.asarray(self.capture.measured[self.frames])

    @cached_property
    def whole(self) -> BoolArray:
        """Frames in which all of lips and chin were measured, (n_frames,)."""
        return np.asarray(self.measured[:, self.natural.columns].all(axis=1))

    def columns(self, regions: Sequence[str] | None) -> IntArray:
        """Return the columns of some regions."""
        return region_columns(self.capture.regions, regions)

    @cached_property
    def truth_articulators(self) -> FloatArray:
        """Aperture, width, protrusion, jaw as recorded, (n_frames, 4) mm."""
        return articulators(self.truth_mm, self.capture.names)

    @cached_property
    def made_articulators(self) -> FloatArray:
        """Aperture, width, protrusion, jaw as predicted, (n_frames, 4) mm."""
        return articulators(self.made_mm, self.capture.names)

    @cached_property
    def fine_s(self) -> FloatArray:
        """Times of the predicted frames inside speech, (n_fine,) s."""
        times = np.asarray(self.prediction.times_s)
        captured = self.capture.times_s
        low, high = max(self.span_s[0], captured[0]), min(self.span_s[1], captured[-1])
        return np.asarray(times[(times >= low) & (times <= high)])

    @cached_property
    def made_fine_mm(self) -> FloatArray:
        """The prediction at its own rate, inside speech, (n_fine, n_markers, 3) mm."""
        times = np.asarray(self.prediction.times_s)
        first = int(np.searchsorted(times, self.fine_s[0]))
        return np.asarray(self.prediction.values_mm[first : first + len(self.fine_s)])

    @cached_property
    def truth_fine_mm(self) -> FloatArray:
        """The recording at the rate of the prediction, by a cubic spline, (n_fine, n_markers, 3) mm."""
        return curve_at(self.capture.times_s, self.capture.positions_mm, self.fine_s)
