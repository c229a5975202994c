"""Nothing of a tested recording's motion reaches a prediction: whatever is done to it, they stay equal."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from strategies.talking import talking_corpus

from corpus_tools.core import Capture
from corpus_tools.evaluate import evaluate, k_folds, leave_one_out
from corpus_tools.methods import METHODS, Method, Variant, parse_variant
from corpus_tools.pipeline import cleaned_recordings, read_corpus


class Source:
    """A corpus as read, cleaned as the command cleans it."""

    def __init__(self, raw):
        self.raw, self.phones = raw, raw.phones

    def cleaned(self, learn_from, progress):
        return cleaned_recordings(self.raw, learn_from=learn_from, progress=progress)[0]


@pytest.fixture(scope="module")
def raw(tmp_path_factory):
    return read_corpus(talking_corpus(tmp_path_factory.mktemp("talk"), n=9))


def corrupted(raw, names):
    """Shake, squeeze, shift and partly hide the motion of some recordings, head included."""
    rng = np.random.default_rng(7)

    def spoil(capture: Capture) -> Capture:
        motion = 1.5 * capture.positions_mm[::-1] + rng.normal(0, 5, capture.positions_mm.shape)
        motion[10:30, 6] = np.nan
        return Capture(motion, capture.rate_hz, capture.names)

    captures = [spoil(c) if n in names else c for c, n in zip(raw.captures, raw.names, strict=True)]
    return replace(raw, captures=tuple(captures))


def predictions(raw, folds, method, keep):
    """Return what a method predicts in the folds that test `keep`."""
    found = {}

    def fit(training):
        predict = parse_variant(method).fit(training)

        def spy(utterance):
            motion = predict(utterance)
            found[utterance.name] = np.asarray(motion.values_mm)
            return motion

        return spy

    evaluate(Source(raw), folds, [Variant(method, Method(method, "", fit))])
    return {name: found[name] for name in keep}


@pytest.mark.parametrize("method", [*METHODS, "viterbi:weights=tuned"])
def test_predictions_do_not_depend_on_the_motion_of_tested_recordings(raw, method):
    fold = k_folds(raw.names, 3)[0]
    clean = predictions(raw, [fold], method, fold.test)
    spoiled = predictions(corrupted(raw, fold.test), [fold], method, fold.test)
    for name in fold.test:
        np.testing.assert_array_equal(clean[name], spoiled[name])


@pytest.mark.parametrize("method", METHODS)
def test_predictions_do_depend_on_the_motion_that_they_learn_from(raw, method):
    """Otherwise the test above could not fail."""
    fold = k_folds(raw.names, 3)[0]
    clean = predictions(raw, [fold], method, fold.test)
    spoiled = predictions(corrupted(raw, fold.train[:3]), [fold], method, fold.test)
    for name in fold.test:
        assert np.abs(clean[name] - spoiled[name]).max() > 0.1


def test_leave_one_out_does_not_leak_either(raw):
    folds = leave_one_out(raw.names)
    one = folds[3]
    mine = [f for f in folds if f.group == one.group]
    clean = predictions(raw, mine, "viterbi", one.test)
    spoiled = predictions(corrupted(raw, one.test), mine, "viterbi", one.test)
    np.testing.assert_array_equal(clean[one.test[0]], spoiled[one.test[0]])


def test_cleaning_learns_from_what_it_may(raw):
    """A corrupted recording changes the cleaning of the others, unless it is left out of what is learned."""
    spoiled = corrupted(raw, raw.names[:2])
    known = raw.names[2:]
    for may, equal in ((None, False), (known, True)):
        before, after = (cleaned_recordings(r, learn_from=may)[0][-1].capture for r in (raw, spoiled))
        assert np.array_equal(before.positions_mm, after.positions_mm) is equal
