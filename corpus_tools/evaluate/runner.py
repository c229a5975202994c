"""The evaluation itself: fold by fold, methods are fitted on what they may see and measured on the rest."""

from __future__ import annotations

import gc
import time
from collections import defaultdict
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from corpus_tools.core import BoolArray, FloatArray, IntArray, Recording, SynthesisError, Trajectory, step
from corpus_tools.evaluate.comparison import Comparison, curve_at
from corpus_tools.evaluate.folds import Fold
from corpus_tools.evaluate.metrics import METRICS
from corpus_tools.evaluate.natural import Natural, natural_of
from corpus_tools.evaluate.repetition import RepeatedWords
from corpus_tools.methods import Predictor, TrainingSet, TunedPredictor, Variant
from corpus_tools.speech import PhoneSet

__all__ = ["NATURAL", "REPETITION", "Evaluation", "Source", "evaluate"]

NATURAL = "natural"
"""Row of the recordings themselves: what a perfect prediction would score; looked at where methods join."""

REPETITION = "repetition"
"""Row of the speaker's own repetition of the same words between the same neighbours."""

Progress = Callable[[float, str], None]


class Source(Protocol):
    """Where recordings come from: they are cleaned anew for each group, by what is not tested in it."""

    @property
    def phones(self) -> PhoneSet:
        """The phone set."""

    def cleaned(self, learn_from: Collection[str], progress: Progress) -> Sequence[Recording]:
        """Return all recordings cleaned, with a head shape and a face model of some of them only."""


@dataclass(frozen=True, slots=True, eq=False)
class Evaluation:
    """What every tested sentence contributed to every metric of every method.

    Attributes
    ----------
    sentences : tuple of str
    groups : (n_sentences,) int64
    naturals : tuple of Natural
        One per group.
    shares : dict of (method, metric) -> (n_sentences, k)
        NaN where there is nothing to say.
    failures : tuple of (method, sentence, reason)
        Sentences that a method could not speak; they are left out of its rows.
    fit_s : dict of method -> s
        Mean over folds.
    predict_ms : dict of method -> ms
        Mean over sentences.
    tuned : dict of method -> tuple of weights
        What a method found on each training part, in the order of folds; none of methods with given weights.
    """

    sentences: tuple[str, ...]
    groups: IntArray
    naturals: tuple[Natural, ...]
    shares: dict[tuple[str, str], FloatArray]
    failures: tuple[tuple[str, str, str], ...]
    fit_s: dict[str, float]
    predict_ms: dict[str, float]
    tuned: dict[str, tuple[dict[str, float], ...]] = field(default_factory=dict)

    @property
    def methods(self) -> tuple[str, ...]:
        """The rows, in order: natural speech first."""
        return tuple(dict.fromkeys(method for method, _ in self.shares))


class _Collected:
    """Shares as they come in, sentence by sentence."""

    def __init__(self) -> None:
        self.sentences: list[str] = []
        self.groups: list[int] = []
        self.naturals: list[Natural] = []
        self.shares: dict[tuple[str, str], dict[str, FloatArray]] = defaultdict(dict)
        self.failures: list[tuple[str, str, str]] = []
        self.fit_s: dict[str, list[float]] = defaultdict(list)
        self.predict_s: dict[str, list[float]] = defaultdict(list)
        self.joins_s: dict[str, list[float]] = defaultdict(list)
        self.tuned: dict[str, list[dict[str, float]]] = defaultdict(list)

    def take(self, method: str, comparison: Comparison, words_only: bool = False) -> None:
        for metric in METRICS.values():
            if metric.words_only or not words_only:
                self.shares[method, metric.name][comparison.recording.name] = metric.share(comparison)

    def whole(self) -> Evaluation:
        every = {}
        for key, by_name in sorted(self.shares.items(), key=lambda item: item[0][0] != NATURAL):
            width = max(len(share) for share in by_name.values())
            nothing = np.full(width, np.nan)
            every[key] = np.stack([by_name.get(name, nothing) for name in self.sentences])
        return Evaluation(
            tuple(self.sentences),
            np.array(self.groups, dtype=np.int64),
            tuple(self.naturals),
            every,
            tuple(self.failures),
            {method: float(np.mean(v)) for method, v in self.fit_s.items()},
            {method: float(1e3 * np.mean(v)) for method, v in self.predict_s.items()},
            {method: tuple(v) for method, v in self.tuned.items()},
        )


def _as_prediction(recording: Recording, training: TrainingSet) -> Trajectory:
    """Return a recording as if a method had made it: at the rate of predictions, by a cubic spline."""
    times = training.times_s(recording.utterance)
    capture = recording.capture
    values = curve_at(capture.times_s, capture.positions_mm, times)
    return Trajectory(times, values, capture.names, history=(step(NATURAL),))


def evaluate(
    source: Source,
    folds: Sequence[Fold],
    variants: Sequence[Variant],
    *,
    rate_hz: float = 120.0,
    seed: int = 0,
    progress: Progress = lambda fraction, what: None,
    on_fold: Callable[[int, int], None] = lambda number, n: None,
) -> Evaluation:
    """Fit every method on the training recordings of each fold and measure it on the others.

    Nothing of a tested recording's motion reaches a method: head shape, face model, postures, principal
    components, inventories and lips come from the training recordings of the fold; of the tested one only
    phones and times are used. It is compared in its own posture. The recordings of a group, and all that was
    fitted on them, are let go before those of the next are cleaned.

    Parameters
    ----------
    source : Source
    folds : sequence of Fold
        Those of one group stand together.
    variants : sequence of Variant
    rate_hz : float
        Of predictions, Hz.
    seed : int
        Of the draw of repeated words.
    progress : callable
        ``progress(fraction, what)``; may raise to cancel.
    on_fold : callable
        ``on_fold(number, n)``: a group of folds begins, of `n`, counted from 1.
    """
    collected = _Collected()
    done, total = 0, len(folds)
    groups = sorted({fold.group for fold in folds})
    for number, group in enumerate(groups, 1):
        on_fold(number, len(groups))
        mine = [fold for fold in folds if fold.group == group]
        part = lambda f, w, at=done: progress((at + f) / total, w)  # noqa: E731
        _run_group(collected, source, mine, variants, rate_hz, seed, part)
        done += len(mine)
        gc.collect()
    progress(1.0, "counting")
    return collected.whole()


def _run_group(
    collected: _Collected,
    source: Source,
    folds: Sequence[Fold],
    variants: Sequence[Variant],
    rate_hz: float,
    seed: int,
    progress: Progress,
) -> None:
    """Clean for the folds that are tested together, and run them; ``progress(folds done, what)``."""
    tested = {name for fold in folds for name in fold.test}
    known = sorted({name for fold in folds for name in (*fold.train, *fold.test)} - tested)
    recordings = {r.name: r for r in source.cleaned(known, lambda f, w: progress(0.2 * f, w))}

    def training_of(names: Sequence[str]) -> TrainingSet:
        return TrainingSet([recordings[n] for n in names], source.phones, rate_hz)

    others = training_of(known)
    collected.naturals.append(natural_of(others))
    for index, fold in enumerate(folds):
        same = set(fold.train) == set(known)
        training = others if same else training_of(fold.train)
        part = lambda f, w, at=index: progress(at + 0.2 + 0.8 * f, w)  # noqa: E731
        _run_fold(collected, fold, training, recordings, variants, seed, part)


def _run_fold(
    collected: _Collected,
    fold: Fold,
    training: TrainingSet,
    recordings: dict[str, Recording],
    variants: Sequence[Variant],
    seed: int,
    progress: Progress,
) -> None:
    natural, phones = collected.naturals[-1], training.phones
    words = RepeatedWords(training.recordings, phones.silence)
    spoken = {}
    for name in fold.test:
        recording = recordings[name]
        rng = np.random.default_rng([seed, *name.encode()])
        spoken[name], again = words.repeated(recording, rng)
        collected.sentences.append(name)
        collected.groups.append(fold.group)
        repeated = Comparison(recording, again, natural, phones, spoken[name])
        collected.take(REPETITION, repeated, words_only=True)
    for index, variant in enumerate(variants):
        progress(index / len(variants), f"fold {fold.group + 1}: {variant.label}")
        start = time.perf_counter()
        predict = variant.fit(training)
        collected.fit_s[variant.label].append(time.perf_counter() - start)
        if isinstance(predict, TunedPredictor):
            collected.tuned[variant.label].append(dict(predict.weights))
        for name in fold.test:
            _predicted(collected, variant.label, predict, recordings[name], natural, phones, spoken[name])
    for name in fold.test:
        perfect, joins_s = _as_prediction(recordings[name], training), np.array(collected.joins_s[name])
        collected.take(NATURAL, Comparison(recordings[name], perfect, natural, phones, spoken[name], joins_s))


def _predicted(
    collected: _Collected,
    label: str,
    predict: Predictor,
    recording: Recording,
    natural: Natural,
    phones: PhoneSet,
    words: BoolArray,
) -> None:
    start = time.perf_counter()
    try:
        motion = predict(recording.utterance)
    except SynthesisError as error:
        collected.failures.append((label, recording.name, str(error)))
        return
    collected.predict_s[label].append(time.perf_counter() - start)
    collected.joins_s[recording.name] += [join.time_s for join in motion.joins]
    collected.take(label, Comparison(recording, motion, natural, phones, words))
