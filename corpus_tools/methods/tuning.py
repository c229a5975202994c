"""Weights of a search found on the recordings themselves, each sentence spoken by the others.

Paper A does not say how timing and context are weighed. Here weights are tried one after the other on a small
grid (coordinate descent): every sentence is left out of the inventory, spoken by the rest, and compared with
what was recorded. Only recordings that a method is fitted on are looked at, so that a held-out sentence says
nothing about the weights it is spoken with (nested: the tuning has leave-one-out folds of its own).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from corpus_tools.core import CorpusError, FloatArray
from corpus_tools.methods.left_out import Blend, LeftOut, Score, Search, score_of
from corpus_tools.methods.training import TrainingSet

__all__ = ["LEAST_GAIN", "TUNED", "Tuning", "standard_error", "tune_weights"]

TUNED = ("duration", "context", "position", "stress", "velocity", "acceleration", "aperture", "per_join")
"""Weights that are tried, in this order. That of the posture at a join stays: only their ratios matter. Too
few stand-ins and flagged frames occur to tell their weights from (our choice)."""

MULTIPLIERS = (0.0, 0.5, 2.0)
FIRST = (0.1, 0.3, 1.0)
"""What is tried of a weight: multiples of it; these values where it is 0."""

ROUNDS = 2
LEAST_GAIN = 0.003
"""Loss that a change must gain at least: below .3 % one corpus says little of another (our choice)."""

SURE = 2.0
"""Standard errors over sentences that it must gain, too: the best of some thirty tries gains by chance what
other sentences do not (our choice; none and one were seen to fail on held-out sentences, decision 014)."""

MOST_SENTENCES = 200


@dataclass(frozen=True, slots=True)
class Tuning:
    """The weights that were found.

    Attributes
    ----------
    weights : dict of str to float
    before, after : Score
        With the first weights and with these, on the sentences that were looked at.
    steps : tuple of (weight, value, loss)
        The changes that were kept, in order.
    n_tried : int
        Settings that were looked at.
    """

    weights: dict[str, float]
    before: Score
    after: Score
    steps: tuple[tuple[str, float, float], ...]
    n_tried: int


def standard_error(before: FloatArray, after: FloatArray) -> float:
    """Return the standard error of a gain in loss: how far it hangs on single sentences (jackknife).

    Parameters
    ----------
    before, after : (n_sentences, 3)
        As of :meth:`~corpus_tools.methods.left_out.LeftOut.shares`.
    """
    n = len(before)
    kept = ~np.eye(n, dtype=np.bool_)
    gains = [score_of(before[k]).loss - score_of(after[k]).loss for k in kept] if n > 1 else [0.0]
    return float(np.sqrt((n - 1) * np.var(gains)))


def _tried(value: float) -> tuple[float, ...]:
    return tuple(m * value for m in MULTIPLIERS) if value else FIRST


def tune_weights(
    training: TrainingSet,
    search: Search,
    start: Mapping[str, float],
    *,
    remove_bias: bool = True,
    components: int = 12,
    blend: Blend | None = None,
    most: int = MOST_SENTENCES,
    seed: int = 0,
) -> Tuning:
    """Find the weights of a search with which the recordings of a training set speak each other best.

    Parameters
    ----------
    training : TrainingSet
    search : callable
        Such as :func:`~corpus_tools.synthesis.select_viterbi`.
    start : mapping of weight -> value
        Those of :data:`TUNED` that are in it are tried; the others are kept.
    remove_bias, components
        Of the units and of the join distance. The components see all of the training set.
    blend : mapping, optional
        Settings of :func:`~corpus_tools.synthesis.render_selection`. The lips are not closed: whatever was
        chosen, that is done afterwards.
    most : int
        Sentences that are looked at, drawn at random where there are more.
    seed : int

    Raises
    ------
    CorpusError
        No recording can be spoken by the others.
    """
    judge = LeftOut(training, remove_bias, components, search, blend or {})
    recordings = training.of(remove_bias)
    drawn = np.sort(np.random.default_rng(seed).permutation(len(recordings))[:most])
    judge.look_at([recordings[k] for k in drawn])
    if not judge.recordings:
        raise CorpusError(
            f"None of the {len(recordings)} recordings can be spoken by the others, so that no weights can "
            "be tuned on them; record more sentences, or take the weights that are given."
        )
    known_stress = bool(np.asarray(judge.model.stress).any())
    keys = [k for k in TUNED if k in start and (k != "stress" or known_stress)]
    return _descend(judge, dict(start), keys)


def _descend(judge: LeftOut, weights: dict[str, float], keys: Sequence[str]) -> Tuning:
    """Change one weight at a time to the best of a few values, until nothing gains."""
    shares = judge.shares(weights)
    before = best = score_of(shares)
    steps: list[tuple[str, float, float]] = []
    n_tried = 1
    for _ in range(ROUNDS):
        n_before = len(steps)
        for key in keys:
            found = {value: judge.shares(weights | {key: value}) for value in _tried(weights[key])}
            n_tried += len(found)
            value, made = min(found.items(), key=lambda item: score_of(item[1]).loss)
            gain = best.loss - score_of(made).loss
            if gain > LEAST_GAIN and gain > SURE * standard_error(shares, made):
                weights, shares, best = weights | {key: value}, made, score_of(made)
                steps.append((key, value, best.loss))
        if len(steps) == n_before:
            break
    return Tuning(weights, before, best, tuple(steps), n_tried)
