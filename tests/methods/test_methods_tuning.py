"""Weights found by leaving out one sentence after the other: never worse, never told by what is held out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies.talking import PHONES, talk

from corpus_tools.core import CorpusError
from corpus_tools.methods import TrainingSet, parse_variant, tune_weights
from corpus_tools.methods.left_out import Score, score_of
from corpus_tools.methods.tuning import LEAST_GAIN, TUNED, standard_error
from corpus_tools.pipeline.reading import face_only
from corpus_tools.synthesis import select_viterbi

START = {name: 0.0 for name in TUNED} | {"duration": 1.0, "context": 0.3, "velocity": 0.3, "backoff": 2.0}
SILLY = START | {"duration": 0.0, "context": 0.0, "velocity": 0.0, "join": 0.01}


@pytest.fixture(scope="module")
def training():
    return TrainingSet([replace(r, capture=face_only(r.capture)) for r in talk(10)], PHONES)


class Spy:
    """A search that remembers what it was asked."""

    def __init__(self):
        self.asked = []

    def __call__(self, model, utterance, *, exclude, n_rejected, **weights):
        self.asked.append((utterance.name, tuple(exclude), dict(weights)))
        return select_viterbi(model, utterance, exclude=exclude, n_rejected=n_rejected, **weights)


@pytest.fixture(scope="module")
def tuned(training):
    spy = Spy()
    return tune_weights(training, spy, SILLY), spy.asked


def test_the_loss_falls_with_every_step_that_is_kept(tuned):
    tuning, _ = tuned
    losses = [tuning.before.loss, *(loss for _, _, loss in tuning.steps)]
    assert len(losses) > 1
    assert (np.diff(losses) < -LEAST_GAIN).all()
    assert tuning.after.loss == losses[-1]


def test_only_weights_of_the_grid_change_and_the_steps_say_how(tuned):
    tuning, _ = tuned
    followed = dict(SILLY)
    for name, value, _ in tuning.steps:
        assert name in TUNED
        followed[name] = value
    assert tuning.weights == followed
    assert tuning.weights["backoff"] == SILLY["backoff"]


def test_no_sentence_is_spoken_with_itself_and_all_are_looked_at(training, tuned):
    tuning, asked = tuned
    assert all(exclude == (name,) for name, exclude, _ in asked)
    names = {r.name for r in training.recordings}
    assert {name for name, _, _ in asked} == names
    settings = {tuple(weights.items()) for _, _, weights in asked if weights}
    assert len(settings) <= tuning.n_tried
    assert {weights["stress"] for _, _, weights in asked if weights} == {0.0}  # nobody knows the stress


def test_tuning_twice_finds_the_same_and_a_few_sentences_are_enough(training, tuned):
    again = tune_weights(training, select_viterbi, SILLY)
    assert again == tuned[0]
    spy = Spy()
    tune_weights(training, spy, {"duration": 1.0}, most=3)
    assert len({name for name, _, _ in spy.asked}) == 3


def test_what_cannot_gain_stays(training):
    """With nothing to try, the first weights come back: no stress is known here."""
    tuning = tune_weights(training, select_viterbi, {"backoff": 2.0, "stress": 0.0})
    assert (tuning.weights, tuning.steps, tuning.n_tried) == ({"backoff": 2.0, "stress": 0.0}, (), 1)
    assert tuning.before == tuning.after


def test_a_method_takes_the_tuned_weights(training):
    variant = parse_variant("viterbi:weights=tuned+duration=0+context=0+velocity=0+join=0.01")
    tuning = tune_weights(training, select_viterbi, _given(variant), blend=BLEND)
    assert tuning.steps
    by_hand = variant.method.fit(training, **tuning.weights)
    plain = parse_variant("viterbi:duration=0+context=0+velocity=0+join=0.01").fit(training)
    fitted, changed = variant.fit(training), 0.0
    for said in talk(4, seed=5):
        made = np.asarray(fitted(said.utterance).values_mm)
        np.testing.assert_array_equal(made, by_hand(said.utterance).values_mm)
        changed = max(changed, float(np.abs(made - plain(said.utterance).values_mm).max()))
    assert changed > 0.05


BLEND = {
    "mode": "crossfade",
    "weighting": "smootherstep",
    "overlap_s": 0.12,
    "inertial_s": 0.12,
    "warp": "linear",
    "resampling": "inverse",
}


def _given(variant):
    settings = variant.method.settings | dict(variant.changes)
    return {k: settings[k] for k in (*TUNED, "backoff", "join")}


def test_a_gain_of_a_single_sentence_is_no_gain():
    """Nine sentences stay as they are, one turns out better by far: its chance is not taken for a rule."""
    before = np.tile([1.0, 2.0, 1.0], (10, 1))
    one, all_ = before.copy(), before.copy()
    one[3, 0] = 0.5
    all_[:, 0] = 0.95
    assert score_of(one).loss == pytest.approx(score_of(all_).loss)
    assert standard_error(before, one) >= score_of(before).loss - score_of(one).loss > LEAST_GAIN
    assert standard_error(before, all_) == pytest.approx(0, abs=1e-12)


def test_recordings_that_cannot_speak_each_other_are_told(training):
    with pytest.raises(CorpusError, match="None of the 1 recordings can be spoken by the others"):
        tune_weights(TrainingSet(training.recordings[:1], PHONES), select_viterbi, START)


positive = st.floats(0.1, 10)


@given(positive, positive, positive, st.floats(1.01, 3))
def test_less_error_calmer_joins_and_a_natural_range_are_better(error, peak, spread, factor):
    loss = Score(error, peak, spread).loss
    assert Score(error * factor, peak, spread).loss > loss
    assert Score(error, peak * factor, spread).loss > loss
    assert Score(error, peak, 1.0).loss <= loss
    assert Score(error, peak, 1 / spread).loss == pytest.approx(loss)
    # a mean has less error, and next to no range: it must not win
    assert Score(1.0, 1.0, 1.0).loss < Score(0.7, 1.0, 0.3).loss
