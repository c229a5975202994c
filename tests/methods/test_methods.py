"""Laws of every method, and what each of the baselines is by definition."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from strategies.talking import FACE, PHONES, speak, talk

from corpus_tools.core import InputError
from corpus_tools.methods import METHODS, TrainingSet, parse_variant, phone_anchors_s
from corpus_tools.methods.targets import class_targets_mm
from corpus_tools.pipeline.reading import face_only


@pytest.fixture(scope="module")
def training():
    return TrainingSet([replace(r, capture=face_only(r.capture)) for r in talk(10)], PHONES)


@pytest.fixture(scope="module")
def target():
    return speak("target", ["bin", "two", "may"], np.random.default_rng(99))


@pytest.mark.parametrize("name", METHODS)
def test_every_method_moves_every_marker_from_start_to_end_and_twice_the_same(name, training, target):
    motion = METHODS[name].fit(training)(target)
    assert motion.names == FACE
    assert motion.values_mm.shape == (len(motion.times_s), len(FACE), 3)
    assert np.isfinite(motion.values_mm).all()
    assert motion.times_s[0] == 0
    assert target.duration_s - 1 / 120 <= motion.times_s[-1] <= target.duration_s + 1e-6
    np.testing.assert_allclose(np.diff(motion.times_s), 1 / 120)
    again = METHODS[name].fit(TrainingSet(training.recordings, PHONES))(target)
    np.testing.assert_array_equal(motion.values_mm, again.values_mm)


@pytest.mark.parametrize("name", METHODS)
def test_every_setting_has_a_default_that_can_be_written(name):
    method = METHODS[name]
    assert method.name == name
    assert method.summary.endswith(".")
    for key, value in method.settings.items():
        text = {True: "on", False: "off"}[value] if isinstance(value, bool) else str(value)
        assert parse_variant(f"{name}:{key}={text}").changes == {key: value}


def test_variants_change_what_they_name(training, target):
    freed, kept = (parse_variant(v).fit(training)(target) for v in ("greedy", "greedy:remove_bias=off"))
    assert np.abs(freed.values_mm - kept.values_mm).max() > 0.05
    variant = parse_variant("viterbi:mode=inertial+inertial_s=0.1+closure=off")
    assert variant.changes == {"mode": "inertial", "inertial_s": 0.1, "closure": False}
    names = [s.name for s in variant.fit(training)(target).history]
    assert "close_lips" not in names
    assert parse_variant("dominance-class:components=4").changes == {"components": 4}


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("gredy", "did you mean 'greedy'"),
        ("greedy:overlap=1", "did you mean 'overlap_s'"),
        ("greedy:closure", "KEY=VALUE"),
        ("greedy:closure=perhaps", "on or off"),
        ("dominance-class:components=2.5", "whole number"),
        ("viterbi:join=near", "a number from 0 to 1e[+]06 was expected"),
        ("viterbi:join=nan", "a number from 0"),
        ("viterbi:velocity=-1", "a number from 0"),
        ("greedy:overlap_s=2", "from 0 to 0.5"),
        ("greedy:inertial_s=0", "from 0.001 to 0.3"),
        ("dominance-phone:components=0", "components is '0'; a whole number from 1 to 60 was expected"),
        ("viseme-linear:interpolation=cubic", "one of linear, pchip was expected"),
        ("greedy:mode=fade", "one of crossfade, inertial was expected"),
        ("viterbi:weighting=smoth", "one of linear, raised-cosine, "),
    ],
)
def test_wrong_variants_are_told_in_a_sentence(text, says):
    with pytest.raises(InputError, match=says):
        parse_variant(text)


def test_the_mean_is_that_of_speech(training, target):
    motion = METHODS["mean"].fit(training)(target)
    frames = np.concatenate([r.capture.positions_mm[training.speaking(r)] for r in training.recordings])
    np.testing.assert_allclose(motion.values_mm, np.broadcast_to(frames.mean(0), motion.values_mm.shape))


@pytest.mark.parametrize("interpolation", ["linear", "pchip"])
def test_visemes_are_met_at_the_centres_of_their_phones(interpolation, training, target):
    motion = METHODS["viseme-linear"].fit(training, interpolation)(target)
    means = class_targets_mm(training)
    for phone in target.phones.intervals[1:-1]:
        nearest = np.abs(motion.times_s - phone.centre_s).argmin()
        wanted = means[PHONES.viseme_class(phone.text)]
        assert np.abs(motion.values_mm[nearest] - wanted).max() < 0.7  # within half a frame of 8 ms
    low = np.min(list(means.values()), axis=0) - 1e-9
    high = np.max(list(means.values()), axis=0) + 1e-9
    assert ((motion.values_mm >= low) & (motion.values_mm <= high)).all()


def test_silences_rest_and_phones_have_one_moment():
    spoken = speak("x", ["set", "now"], np.random.default_rng(1))
    anchors = phone_anchors_s(spoken, "SIL")
    assert anchors[0].tolist() == [-np.inf, pytest.approx(0.35)]
    assert anchors[-1, 1] == np.inf
    np.testing.assert_allclose(anchors[1:-1, 0], [p.centre_s for p in spoken.phones.intervals[1:-1]])
    np.testing.assert_array_equal(anchors[1:-1, 0], anchors[1:-1, 1])
