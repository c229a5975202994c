"""Folds, intervals, and what the natural repetition of a word is."""

from __future__ import annotations

import weakref
from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies.talking import PHONES, motion_of, speak, talk

from corpus_tools.core import InputError, Join, Recording
from corpus_tools.evaluate import METRICS, Fold, evaluate, k_folds, leave_one_out, one_split, tabulate
from corpus_tools.evaluate.bootstrap import drawn_values, estimate, jackknife_sd, ratio, resamples
from corpus_tools.evaluate.metrics import Metric
from corpus_tools.evaluate.metrics.registry import mean_of_sentences, quotient
from corpus_tools.evaluate.repetition import RepeatedWords
from corpus_tools.evaluate.runner import _as_prediction
from corpus_tools.methods import METHODS, parse_variant
from corpus_tools.pipeline.reading import face_only

NAMES = [f"n{i:02d}" for i in range(23)]


class Cleaned:
    """Recordings that need no cleaning."""

    phones = PHONES

    def __init__(self, recordings):
        self.recordings = recordings

    def cleaned(self, learn_from, progress):
        return self.recordings


@given(st.integers(2, 23), st.integers(0, 1000))
def test_folds_test_everything_once_and_never_train_on_it(k, seed):
    folds = k_folds(NAMES, k, seed)
    assert len(folds) == k
    assert sorted(n for f in folds for n in f.test) == NAMES
    sizes = [len(f.test) for f in folds]
    assert max(sizes) - min(sizes) <= 1
    for fold in folds:
        assert sorted((*fold.train, *fold.test)) == NAMES
    assert folds == k_folds(NAMES[::-1], k, seed)


def test_folds_are_drawn_by_the_seed():
    assert k_folds(NAMES, 5, 0) != k_folds(NAMES, 5, 1)


@given(st.integers(4, 23))
def test_leave_one_out_leaves_out_one(n):
    folds = leave_one_out(NAMES[:n])
    assert sorted(f.test[0] for f in folds) == NAMES[:n]
    assert all(len(f.test) == 1 and sorted((*f.train, *f.test)) == NAMES[:n] for f in folds)
    groups = [f.group for f in folds]
    assert groups == sorted(groups)  # a group is cleaned once
    assert all(groups.count(g) < n for g in groups)


@pytest.mark.parametrize("k", [-1, 0, 1, 24])
def test_impossible_folds_are_refused(k):
    with pytest.raises(InputError, match=f"--folds is {k}: a number from 2 to 23"):
        k_folds(NAMES, k)
    with pytest.raises(InputError, match=r"at least 2 usable recordings; 1 is there\.$"):
        k_folds(NAMES[:1], 5)
    with pytest.raises(InputError, match="at least 4"):
        leave_one_out(NAMES[:3])


def test_a_fold_cannot_train_on_what_it_tests():
    with pytest.raises(ValueError, match="'b' is trained on and tested"):
        Fold(0, ("a", "b"), ("b",))
    assert one_split(["b", "a"], ["c"]) == (Fold(0, ("a", "b"), ("c",)),)


GROUPS = np.repeat([0, 1, 2], [40, 40, 20])
COUNTS = resamples(GROUPS, seed=4, n_draws=2000)
MEAN = Metric("mean", "", "low", "", lambda c: np.zeros(1), mean_of_sentences)
QUOTIENT = Metric("quotient", "", "low", "", lambda c: np.zeros(2), quotient, per=1)


def test_resamples_keep_the_size_of_every_fold():
    for group, size in enumerate((40, 40, 20)):
        np.testing.assert_array_equal(COUNTS[:, group == GROUPS].sum(axis=1), size)
    np.testing.assert_array_equal(COUNTS, resamples(GROUPS, seed=4, n_draws=2000))
    assert (COUNTS[:5] != resamples(GROUPS, seed=5, n_draws=5)).any()


def test_the_interval_of_a_mean_is_that_of_the_textbook():
    values = np.random.default_rng(0).normal(3, 1, 100)
    found = estimate(drawn_values(MEAN, values[:, None], COUNTS, GROUPS, []))
    half = 1.96 * np.sqrt(sum((g == GROUPS).sum() * values[g == GROUPS].var() for g in range(3))) / 100
    assert found.value == pytest.approx(values.mean())
    assert found.low == pytest.approx(values.mean() - half, abs=0.15 * half)
    assert found.high == pytest.approx(values.mean() + half, abs=0.15 * half)
    assert found.n == 100


def test_sentences_without_a_value_do_not_count():
    values = np.full((100, 1), 2.0)
    values[:30] = np.nan
    found = estimate(drawn_values(MEAN, values, COUNTS, GROUPS, []))
    assert (found.value, found.low, found.high, found.n) == (2, 2, 2, 70)
    shares = np.array([[1.0, 2.0]] * 50 + [[0.0, 0.0]] * 50)
    found = estimate(drawn_values(QUOTIENT, shares, COUNTS, GROUPS, []))
    assert (found.value, found.n) == (0.5, 50)


def _holds(found):
    slack = 1e-9 * max(1.0, abs(found.value))
    return found.low - slack <= found.value <= found.high + slack


def test_every_interval_of_a_run_holds_its_estimate():
    """Of every metric and every paired ratio: 24 sentences in three folds, methods that move or do not."""
    recordings = [replace(r, capture=face_only(r.capture)) for r in talk(24, words=3)]
    methods = [parse_variant(m) for m in ("mean", "viseme-linear", "greedy:closure=off", "viterbi")]
    folds = k_folds([r.name for r in recordings], 3)
    table = tabulate(evaluate(Cleaned(recordings), folds, methods))
    assert {metric for _, metric in table.values} == set(METRICS)
    assert [key for key, found in table.values.items() if not _holds(found)] == []
    assert [key for key, found in table.ratios.items() if not _holds(found)] == []
    found = table.values["viterbi", "frechet"]
    assert found.low < found.value < found.high


class Untouched:
    """A method that speaks the recordings themselves and says that it joined at some phones."""

    method = METHODS["mean"]
    changes: ClassVar = {}

    def __init__(self, recordings, label, every):
        self.known, self.label, self.every = {r.name: r for r in recordings}, label, every

    def fit(self, training):
        def predict(utterance):
            phones = utterance.phones.intervals[1 : -1 : self.every]
            joins = tuple(Join(0, p.centre_s, p.text, "a:0-1", "b:0-1", 0.1, 0, 0, 0) for p in phones)
            return replace(_as_prediction(self.known[utterance.name], training), joins=joins)

        return predict


def test_natural_speech_is_looked_at_where_methods_join():
    recordings = [replace(r, capture=face_only(r.capture)) for r in talk(8)]
    folds = k_folds([r.name for r in recordings], 2)
    for every in (1, 3):
        methods = [Untouched(recordings, "untouched", every), parse_variant("mean")]
        values = tabulate(evaluate(Cleaned(recordings), folds, methods)).values
        for metric in ("join_peak", "join_unnatural"):
            assert values["natural", metric] == values["untouched", metric]
        assert 0 < values["natural", "join_peak"].value < 3
        assert values["natural", "joins"].value == 0
        assert ("natural", "join_gap_position") not in values
        assert ("mean", "join_peak") not in values
    silent = tabulate(evaluate(Cleaned(recordings), folds, [parse_variant("mean")])).values
    assert ("natural", "join_peak") not in silent


class Fresh(Cleaned):
    """Recordings made anew for every group; it sees how many of those before still stand in memory."""

    def __init__(self, recordings):
        super().__init__(recordings)
        self.given, self.alive = [], []

    def cleaned(self, learn_from, progress):
        self.alive.append(sum(known() is not None for known in self.given))
        captures = [replace(r.capture, positions_mm=r.capture.positions_mm + 0.0) for r in self.recordings]
        self.given += [weakref.ref(c.positions_mm) for c in captures]
        return [replace(r, capture=c) for r, c in zip(self.recordings, captures, strict=True)]


def test_recordings_of_a_group_are_let_go_before_the_next_are_cleaned():
    recordings = [replace(r, capture=face_only(r.capture)) for r in talk(8)]
    source = Fresh(recordings)
    methods = [parse_variant(m) for m in ("mean", "viterbi:mode=inertial")]
    evaluate(source, k_folds([r.name for r in recordings], 3), methods)
    assert len(source.given) == 24
    assert source.alive == [0, 0, 0]


@given(st.integers(0, 1000))
def test_the_jackknife_of_a_mean_is_its_standard_error(seed):
    values = np.random.default_rng(seed).normal(5, 1, 100)
    means = (values.sum() - values) / 99
    wanted = sum(n * values[g == GROUPS].var(ddof=1) for g, n in enumerate((40, 40, 20)))
    wanted *= 1 / 100**2
    assert jackknife_sd(means, GROUPS) == pytest.approx(np.sqrt(wanted), rel=0.05)


def test_paired_ratios_are_sharper_than_their_parts():
    rng = np.random.default_rng(1)
    hard = rng.uniform(1, 5, 100)  # sentences differ much, methods little
    a, b = (drawn_values(MEAN, (hard * f)[:, None], COUNTS, GROUPS, []) for f in (0.9, 1.0))
    noisy = drawn_values(MEAN, (hard * 0.9 * rng.normal(1, 0.02, 100))[:, None], COUNTS, GROUPS, [])
    assert (ratio(a, b).low, ratio(a, b).high) == (pytest.approx(0.9), pytest.approx(0.9))
    assert ratio(a, a).value == 1
    spread, whole = ratio(noisy, b), estimate(b)
    assert spread.low < 0.9 < spread.high
    assert spread.high - spread.low < 0.1 * (whole.high - whole.low)


def test_the_same_word_between_the_same_words_is_found_and_laid_onto_the_labels():
    rng = np.random.default_rng(0)
    spoken = [speak(f"w{i}", ["bin", "two", "set"], rng) for i in range(2)]
    mine, other = (Recording(s, motion_of(s, rng, noise_mm=0)) for s in spoken)
    words = RepeatedWords([other], PHONES.silence)
    here, again = words.repeated(mine, rng)
    times = mine.capture.times_s
    inside = (times >= 0.5) & (times <= spoken[0].words.intervals[-1].end_s)
    np.testing.assert_array_equal(here, inside)
    # laid onto itself a word is itself
    own, same = RepeatedWords([mine], PHONES.silence).repeated(mine, rng)
    np.testing.assert_allclose(same.values_mm[own], mine.capture.positions_mm[own], atol=1e-9)
    assert np.abs(again.values_mm[here] - mine.capture.positions_mm[here]).max() > 0.2


def test_other_neighbours_are_another_word():
    rng = np.random.default_rng(0)
    one, two = (
        Recording(s, motion_of(s, rng))
        for s in (speak("a", ["bin", "two", "set"], rng), speak("b", ["may", "two", "now"], rng))
    )
    here, _ = RepeatedWords([two], PHONES.silence).repeated(one, rng)
    assert not here.any()


def test_words_of_other_recordings_only():
    """The floor of a sentence never comes from the sentence itself."""
    recordings = [replace(r, capture=face_only(r.capture)) for r in talk(24, words=2)]
    folds = k_folds([r.name for r in recordings], 3)
    shares = evaluate(Cleaned(recordings), folds, [parse_variant("mean")]).shares["repetition", "word_rmse"]
    squares, samples = shares.T
    assert (samples > 0).sum() > 5
    assert (squares[samples > 0] > 0.01 * samples[samples > 0]).all()


def test_metric_ids_are_words_of_a_table():
    for name in METRICS:
        assert name == name.lower()
        assert name.replace("_", "").isalnum()
