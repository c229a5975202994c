"""What weights of a search are judged by: sentences that the others speak, against the recordings."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from corpus_tools.core import (
    SPEECH_REGIONS,
    FloatArray,
    Fragment,
    NoUnitError,
    Recording,
    Selection,
    UnitRef,
    Utterance,
    region_columns,
    speech_span_s,
)
from corpus_tools.fragments import cut_fragment
from corpus_tools.methods.training import CONTEXT_S, SPEECH_MARGIN_S, TrainingSet
from corpus_tools.synthesis import natural_distribution, render_selection
from corpus_tools.synthesis.joins import peaks_at

__all__ = ["Blend", "LeftOut", "Score", "Search", "score_of"]

JOIN_SHARE = 0.1
"""How joins count against error: from 1 to 0 of excess a sentence is worth 7 % of error (our choice)."""

Search = Callable[..., Selection]
Blend = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Score:
    """How sentences turn out that the others speak.

    Attributes
    ----------
    error_mm : float
        RMSE of lips and chin in speech, mean over sentences.
    join_excess : float
        By how much peak accelerations around joins pass the natural 95th percentile of frames, in shares of
        it, summed over the joins of a sentence and averaged over sentences. A mean over joins would reward
        many small ones.
    dynamic_range : float
        Spread made over spread recorded, mean over sentences; 1 is natural.
    """

    error_mm: float
    join_excess: float
    dynamic_range: float

    @property
    def loss(self) -> float:
        """Log error + .1 log(1 + join excess) + how far the log range is from 0.

        Error alone would choose what is near to everything: a mean has less of it than the speaker's own
        repetition (decision 010).
        """
        error, spread = np.log(np.maximum([self.error_mm, self.dynamic_range], 1e-9))
        return float(error + JOIN_SHARE * np.log1p(self.join_excess) + abs(spread))


class LeftOut:
    """Speaks every sentence by the others with any weights; what was spoken once is not rendered again."""

    def __init__(
        self,
        training: TrainingSet,
        remove_bias: bool,
        components: int,
        search: Search,
        blend: Blend,
    ) -> None:
        self.training, self.search, self.blend = training, search, dict(blend)
        self.model = training.selection(remove_bias, components)
        recordings = training.of(remove_bias)
        capture = recordings[0].capture
        self.columns = region_columns(capture.regions, SPEECH_REGIONS)
        self.names = tuple(capture.names[c] for c in self.columns)
        margin = [speech_span_s(r.utterance, training.phones.silence, SPEECH_MARGIN_S) for r in recordings]
        natural = natural_distribution(
            [r.capture for r in recordings], training.rate_hz, self.columns, margin
        )
        self.p95_mm_s2 = natural.frames_p95_mm_s2
        self.recordings: list[Recording] = []
        self._known: dict[tuple[str, tuple[str, ...]], FloatArray] = {}

    def look_at(self, recordings: Sequence[Recording]) -> None:
        """Take the recordings that the others can speak."""
        for recording in recordings:
            try:
                self._choose(recording.utterance, {})
            except NoUnitError:
                continue
            self.recordings.append(recording)

    def _choose(self, utterance: Utterance, weights: Mapping[str, float]) -> Selection:
        return self.search(self.model, utterance, exclude=[utterance.name], n_rejected=0, **weights)

    def shares(self, weights: Mapping[str, float]) -> FloatArray:
        """Return how each sentence turns out with these weights: the parts of a :class:`Score`, (n, 3)."""
        return np.array([self._share(r, self._choose(r.utterance, weights)) for r in self.recordings])

    def _share(self, recording: Recording, selection: Selection) -> FloatArray:
        key = recording.name, tuple(c.unit.key for c in selection.chosen)
        if key not in self._known:
            self._known[key] = self._compare(recording, selection)
        return self._known[key]

    def _cut(self, unit: UnitRef) -> Fragment:
        """Return lips and chin of a unit: the rest of the face is not looked at."""
        whole = cut_fragment(self.model.inventory, unit, CONTEXT_S)
        motion, flags = whole.motion_mm[:, self.columns], whole.flags[:, self.columns]
        return replace(whole, motion_mm=motion, flags=flags)

    def _compare(self, recording: Recording, selection: Selection) -> FloatArray:
        fragments = [self._cut(c.unit) for c in selection.chosen]
        motion = render_selection(
            selection,
            recording.utterance,
            fragments,
            names=self.names,
            rate_hz=self.training.rate_hz,
            silence=self.training.phones.silence,
            **self.blend,
        )
        made = np.asarray(motion.values_mm)
        joins = peaks_at(made, motion.times_s, motion.rate_hz, [j.time_s for j in motion.joins])
        speaking = self.training.speaking(recording)
        truth = recording.capture.positions_mm[speaking][:, self.columns]
        nearest = np.rint(recording.capture.times_s[speaking] * motion.rate_hz).astype(np.int64)
        made = made[np.clip(nearest, 0, len(made) - 1)]
        error = float(np.sqrt(((made - truth) ** 2).sum(axis=2).mean()))
        spread = made.var(axis=0).sum() / max(float(truth.var(axis=0).sum()), 1e-12)
        excess = np.maximum(joins / self.p95_mm_s2 - 1.0, 0.0).sum()
        return np.array([error, excess, np.sqrt(spread)])


def score_of(shares: FloatArray) -> Score:
    """Return the score of sentences together, (n_sentences, 3) as of :meth:`LeftOut.shares`."""
    error, excess, spread = shares.mean(axis=0).tolist()
    return Score(error, excess, spread)
