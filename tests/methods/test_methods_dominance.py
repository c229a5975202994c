"""The dominance model: its gradient, its recovery from data, and phones that were never heard."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import check_grad
from strategies.talking import PHONES, speak, talk

from corpus_tools.methods import TrainingSet
from corpus_tools.methods.dominance import fit_dominance_class, fit_dominance_phone
from corpus_tools.methods.dominance_model import (
    DominanceProblem,
    _misfit,
    dominance_curve,
    fit_dominance,
    stack_problems,
)
from corpus_tools.pipeline.reading import face_only

N_KINDS = 4


def problem(rng, n_phones, n_frames=80):
    centres = np.cumsum(rng.uniform(0.06, 0.15, n_phones))
    times = np.linspace(0, centres[-1] + 0.1, n_frames)
    away = centres - times[:, None]
    kind = np.broadcast_to(rng.integers(0, N_KINDS, n_phones), away.shape)
    return DominanceProblem(np.abs(away), away > 0, kind)


@pytest.fixture(scope="module")
def frames():
    rng = np.random.default_rng(3)
    return stack_problems([problem(rng, n) for n in (5, 9, 7, 12, 8, 10)])


def parameters(rng):
    return np.stack(
        [
            rng.normal(0, 0.5, N_KINDS),
            rng.normal(np.log(20), 0.3, N_KINDS),
            rng.normal(np.log(25), 0.3, N_KINDS),
            rng.normal(0, 1.5, N_KINDS),
        ]
    )


def prior():
    return np.stack([np.zeros(N_KINDS), *[np.full(N_KINDS, np.log(20.0))] * 2, np.zeros(N_KINDS)])


def test_the_gradient_is_that_of_the_misfit(frames):
    rng = np.random.default_rng(1)
    values = rng.normal(size=len(frames.kind))
    at, tightness = parameters(rng), np.ones((4, N_KINDS))
    args = (frames, values, prior(), tightness)
    off = check_grad(lambda p: _misfit(p, *args)[0], lambda p: _misfit(p, *args)[1], at.ravel())
    assert off < 1e-4 * np.linalg.norm(_misfit(at.ravel(), *args)[1])


def test_a_curve_of_the_model_is_found_again(frames):
    truth = parameters(np.random.default_rng(2))
    curve = dominance_curve(frames, truth)
    found = fit_dominance(frames, curve, prior(), np.full(4, 10.0))
    assert np.sqrt(((dominance_curve(frames, found) - curve) ** 2).mean()) < 0.02 * curve.std()
    np.testing.assert_allclose(found[3], truth[3], atol=0.1)


def test_places_without_a_phone_have_no_say(frames):
    rng = np.random.default_rng(5)
    some, few = problem(rng, 9), problem(rng, 4)
    at = parameters(rng)
    both = dominance_curve(stack_problems([some, few]), at)
    np.testing.assert_allclose(both, np.concatenate([dominance_curve(p, at) for p in (some, few)]))


def test_the_curve_lies_between_the_targets(frames):
    at = parameters(np.random.default_rng(8))
    curve = dominance_curve(frames, at)
    assert at[3].min() <= curve.min() <= curve.max() <= at[3].max()


@pytest.fixture(scope="module")
def training():
    return TrainingSet([replace(r, capture=face_only(r.capture)) for r in talk(10)], PHONES)


def test_fitting_beats_the_mean_on_its_own_sentences(training):
    for fit in (fit_dominance_class, fit_dominance_phone):
        predict = fit(training, components=3)
        for recording in training.recordings[:3]:
            here, motion = training.speaking(recording), predict(recording.utterance)
            truth = recording.capture.positions_mm[here]
            frames = np.round(recording.capture.times_s[here] * 120).astype(int)
            error = ((motion.values_mm[frames] - truth) ** 2).mean()
            assert error < 0.35 * ((truth - truth.mean(axis=0)) ** 2).mean() + 0.2  # 0.4 mm are an offset


def test_a_phone_that_was_never_heard_speaks_as_its_class(training):
    """P is in no recording; B and M, of the same class, are."""
    predict = fit_dominance_phone(training, components=3)
    by_class = fit_dominance_class(training, components=3)
    spoken = speak("x", ["two"], np.random.default_rng(4))
    first, *rest = spoken.phones.intervals[1:-1]
    heard = replace(
        spoken,
        phones=replace(
            spoken.phones,
            intervals=(
                spoken.phones.intervals[0],
                replace(first, text="P"),
                *rest,
                spoken.phones.intervals[-1],
            ),
        ),
    )
    at = np.abs(predict(heard).times_s - first.centre_s).argmin()
    made, of_class = predict(heard).values_mm[at], by_class(heard).values_mm[at]
    assert np.abs(made - of_class).max() < 0.8
    assert np.abs(predict(spoken).values_mm[at] - made).max() > 2
