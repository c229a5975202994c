"""Every metric on cases whose answer is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from strategies.talking import FACE, PHONES, talk

from corpus_tools.core import FrameFlag, Join, Trajectory
from corpus_tools.evaluate import METRICS, Comparison, natural_of
from corpus_tools.evaluate.comparison import curve_at
from corpus_tools.evaluate.metrics.error import dtw_distance
from corpus_tools.evaluate.metrics.realism import frechet_distance
from corpus_tools.evaluate.natural import Moments, articulators
from corpus_tools.methods import TrainingSet
from corpus_tools.pipeline.reading import face_only
from corpus_tools.speech import lip_aperture_mm
from corpus_tools.synthesis import natural_distribution

RATE = 120.0
RECORDINGS = [replace(r, capture=face_only(r.capture)) for r in talk(8)]
TRAINING = TrainingSet(RECORDINGS[1:], PHONES)
NATURAL = natural_of(TRAINING)
LIPS_CHIN = [i for i, n in enumerate(FACE) if n.startswith(("lip", "chin"))]


def compared(change=lambda motion: motion, recording=RECORDINGS[0], joins=(), words=None):
    """Return the recording against itself, changed: ``change((n_frames, n_markers, 3))`` at 120 Hz."""
    times = TRAINING.times_s(recording.utterance)
    motion = curve_at(recording.capture.times_s, recording.capture.positions_mm, times)
    made = Trajectory(times, change(motion.copy()), recording.capture.names, joins)
    return Comparison(recording, made, NATURAL, PHONES, words)


def value(name, *comparisons):
    shares = np.stack([METRICS[name].share(c) for c in comparisons])
    groups = np.zeros(len(shares), dtype=np.int64)
    return float(METRICS[name].combine(shares, np.ones((1, len(shares))), groups, [NATURAL])[0])


def moved(*offset, markers=None):
    def change(motion):
        motion[:, markers if markers is not None else slice(None)] += offset
        return motion

    return change


def scaled(factor):
    """Larger or smaller about the mean of the compared frames."""
    mean = compared().made_mm.mean(axis=0)
    return lambda motion: mean + factor * (motion - mean)


@pytest.mark.parametrize("name", METRICS)
def test_every_metric_says_what_it_is_and_likes_the_recording_itself(name):
    metric = METRICS[name]
    assert metric.name == name
    assert metric.summary.endswith(".")
    assert metric.better in ("low", "high", "one", "")
    words = np.ones(RECORDINGS[0].capture.n_frames, dtype=bool)
    perfect = value(name, compared(words=words))
    if metric.better == "one" or name.startswith("r_") or name == "word_r_aperture":
        assert perfect == pytest.approx(1, abs=0.25 if name == "acceleration_p95" else 1e-6)
    elif name == "bilabial_closure":
        assert perfect > 0.8
    elif name == "acceleration_max":
        assert 0.5 < perfect < 3
    elif metric.better == "low" and name != "frechet" and not name.startswith("join"):
        assert perfect == pytest.approx(0, abs=1e-6)


def test_an_error_of_3_and_4_mm_is_one_of_5():
    comparison = compared(moved(3, 4, 0))
    for name in ("rmse", "rmse_face", "rmse_lips", "rmse_chin", "rmse_cheek", "rmse_upper"):
        assert value(name, comparison) == pytest.approx(5)
    assert value("nrmse", comparison) == pytest.approx(5 / NATURAL.posture_sd_mm)
    assert value("rmse_centred", comparison) == pytest.approx(0, abs=1e-9)


def test_errors_look_at_their_own_markers():
    cheek = compared(moved(0, 0, 7, markers=[FACE.index("cheek0"), FACE.index("cheek1")]))
    assert value("rmse", cheek) == pytest.approx(0, abs=1e-9)
    assert value("rmse_cheek", cheek) == pytest.approx(7)
    assert value("rmse_face", cheek) == pytest.approx(7 * np.sqrt(2 / len(FACE)))
    chin = compared(moved(0, 2, 0, markers=[FACE.index("chin3"), FACE.index("chin4")]))
    assert value("rmse", chin) == pytest.approx(2 * np.sqrt(2 / len(LIPS_CHIN)))
    assert value("rmse_lips", chin) == pytest.approx(0, abs=1e-9)


def test_what_a_layout_lacks_is_not_told():
    positions = np.random.default_rng(0).normal(size=(3, len(FACE), 3))
    positions[1, FACE.index("chin3")] = np.nan
    whole = articulators(positions, FACE)
    assert np.isnan(whole).tolist() == [[False] * 4, [True, False, False, True], [False] * 4]
    without = [i for i, n in enumerate(FACE) if n not in ("lip_out6", "chin3")]
    found = articulators(positions[:, without], [FACE[i] for i in without])
    assert np.isnan(found).tolist() == [[False, True, False, True]] * 3
    np.testing.assert_allclose(found[::2, 0], whole[::2, 0])
    no_lips = [i for i, n in enumerate(FACE) if not n.startswith("lip")]
    found = articulators(positions[[0, 2]][:, no_lips], [FACE[i] for i in no_lips])
    assert (found[:, [0, 2]] == 0).all()
    assert np.isnan(found[:, 1]).all()


def test_filled_samples_do_not_count():
    recording = RECORDINGS[0]
    flags = np.array(recording.capture.flags)
    flags[:, FACE.index("chin3")] = FrameFlag.FILLED
    hidden = replace(recording, capture=replace(recording.capture, flags=flags))
    off = moved(0, 9, 0, markers=[FACE.index("chin3")])
    assert value("rmse", compared(off, hidden)) == pytest.approx(0, abs=1e-9)
    assert value("rmse", compared(off)) > 1


def test_correlation_knows_direction_and_not_size():
    for name in ("r_aperture", "r_width", "r_protrusion", "r_jaw"):
        assert value(name, compared(scaled(0.5))) == pytest.approx(1, abs=1e-4)
        assert np.isnan(value(name, compared(scaled(0.0))))  # of a constant it is not defined
    words = np.ones(RECORDINGS[0].capture.n_frames, dtype=bool)
    assert np.isnan(value("word_r_aperture", compared(scaled(0.0), words=words)))
    still, moving = compared(scaled(0.0), words=words), compared(scaled(0.5), words=words)
    assert value("word_r_aperture", still, moving) == pytest.approx(1, abs=1e-4)
    assert value("r_aperture", compared(scaled(-1.0))) == pytest.approx(-1)
    assert value("r_protrusion", compared(scaled(-1.0))) == pytest.approx(-1)


def test_dtw_forgives_time_and_not_posture():
    a = np.array([[0.0], [0], [1], [1]])
    assert dtw_distance(a, a, 2) == 0
    assert dtw_distance(a, np.array([[0.0], [1], [1], [1]]), 2) == 0
    # 3 apart everywhere: any path costs 3 per step
    assert dtw_distance(a[:2], a[:2] + 3, 1) == pytest.approx(3)
    # 0-0, 0-0, 3-3, 3-2: one step of four costs 1
    assert dtw_distance(np.array([[0.0], [0], [3]]), np.array([[0.0], [3], [2]]), 1) == pytest.approx(1 / 4)
    late = compared(lambda motion: np.roll(motion, 6, axis=0))  # 50 ms
    tracks = (late.made_articulators, late.truth_articulators)
    made, truth = (x[:, [0, 1, 3]] / NATURAL.articulator_sd_mm[[0, 1, 3]] for x in tracks)
    still = np.sqrt(((made - truth) ** 2).mean(axis=1)).mean()
    assert value("dtw", late) < 0.6 * still


def test_dynamic_range_is_the_factor():
    for factor in (0.0, 0.5, 1.4):
        assert value("dynamic_range", compared(scaled(factor))) == pytest.approx(factor, abs=1e-6)
        assert value("dynamic_range_aperture", compared(scaled(factor))) == pytest.approx(factor, abs=1e-6)


def test_modulation_is_the_square_of_the_factor():
    mean = compared().made_mm.mean(axis=0)
    vertical = np.array([0.0, 0.5, 0.0])

    def flatter(motion):  # aperture halves; corners and chin still
        motion[:] = mean + vertical * (motion - mean)
        return motion

    comparison = compared(flatter)
    ratio = np.divide(*(METRICS["modulation_4_8hz"].share(comparison)))
    aperture = value("dynamic_range_aperture", comparison)
    assert aperture == pytest.approx(0.5)
    assert 0.05 < ratio < 0.3  # 0.25 of the aperture's power, less of the others'
    assert value("modulation_4_8hz", compared(scaled(0.0))) == pytest.approx(0, abs=1e-9)


def test_the_frechet_distance_of_normals_is_that_of_the_formula():
    rng = np.random.default_rng(0)
    white = rng.normal(size=(4000, 3))
    white = (white - white.mean(0)) @ np.linalg.inv(np.linalg.cholesky(np.cov(white.T, bias=True))).T
    wide = white * [2.0, 1.0, 3.0] + [1.0, 0.0, -2.0]
    found = frechet_distance(Moments.of(wide).flat()[None], Moments.of(white))[0]
    assert found == pytest.approx(1 + 4 + (2 - 1) ** 2 + (3 - 1) ** 2)
    assert frechet_distance(Moments.of(white).flat()[None], Moments.of(white))[0] == pytest.approx(
        0, abs=1e-9
    )
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turned = frechet_distance(Moments.of(wide @ turn).flat()[None], Moments.of(white @ turn))[0]
    assert turned == pytest.approx(found)


def test_flat_motion_is_far_from_natural_speech():
    near = value("frechet", *(compared(recording=r) for r in RECORDINGS[1:]))
    flat = value("frechet", compared(scaled(0.3)))
    assert near < 0.1
    # half of 16 features by .7 each, in position and in speed
    assert flat > 4


def bilabials(recording):
    return [p for p in recording.utterance.phones if p.text in PHONES.bilabials]


def test_closures_that_are_kept_and_missed():
    closed = [r for r in RECORDINGS if value("bilabial_closure", compared(recording=r)) == 1]
    recording = next(r for r in closed if len(bilabials(r)) >= 2)
    n = len(bilabials(recording))
    upper = [FACE.index(f"lip_in{i}") for i in (1, 2, 3)]
    opened = compared(moved(0, 4, 0, markers=upper), recording)
    assert value("bilabial_closure", opened) == 0
    assert value("closure_depth", opened) == pytest.approx(4)
    last = bilabials(recording)[-1]
    times = TRAINING.times_s(recording.utterance)

    def all_but_the_last(motion):
        motion[np.ix_(times < last.start_s - 0.05, upper)] += [0, 4, 0]
        return motion

    assert value("bilabial_closure", compared(all_but_the_last, recording)) == pytest.approx(1 / n)


def test_vowels_that_close_are_counted():
    recording = RECORDINGS[0]
    vowels = [p for p in recording.utterance.phones if p.text in PHONES.vowels]
    times = TRAINING.times_s(recording.utterance)
    upper = [FACE.index(f"lip_in{i}") for i in (1, 2, 3)]
    phone = vowels[0]
    here = np.abs(times - phone.centre_s) < 0.03

    def closed(motion):
        motion[np.ix_(here, upper)] -= [0, 20, 0]
        return motion

    truth = compared()
    aperture = lip_aperture_mm(truth.truth_fine_mm, FACE)
    limit = NATURAL.closed_mm + abs(NATURAL.closed_mm) + 0.5
    n_open = sum(np.interp(p.centre_s, truth.fine_s, aperture) > limit for p in vowels)
    assert n_open >= 2
    assert value("vowel_false_closure", compared(closed)) == pytest.approx(1 / n_open)


def test_the_acceleration_of_a_parabola():
    times = TRAINING.times_s(RECORDINGS[0].utterance)
    thrown = np.zeros((len(times), len(FACE), 3))
    thrown[:, :, 1] = 0.5 * 700 * (times**2)[:, None]
    comparison = compared(lambda motion: thrown)
    wanted = 700 / NATURAL.acceleration_p95_mm_s2
    assert value("acceleration_p95", comparison) == pytest.approx(wanted, rel=1e-6)
    assert value("acceleration_max", comparison) == pytest.approx(wanted, rel=1e-6)


def test_joins_are_measured_by_natural_speech():
    times = TRAINING.times_s(RECORDINGS[0].utterance)
    at = float(times[len(times) // 2])
    gaps = (
        2 * NATURAL.face_sd_mm,
        0.5 * NATURAL.face_speed_p95_mm_s,
        3 * NATURAL.face_acceleration_p95_mm_s2,
    )
    join = Join(0, at, "T", "a:0-1", "b:1-2", 0.12, *gaps)
    jump = np.where(times >= at, 0.2, 0.0)[:, None, None] * np.ones((1, len(FACE), 3))
    comparison = compared(lambda motion: jump, joins=(join,))
    assert value("joins", comparison) == 1
    assert value("join_gap_position", comparison) == pytest.approx(2)
    assert value("join_gap_velocity", comparison) == pytest.approx(0.5)
    assert value("join_gap_acceleration", comparison) == pytest.approx(3)
    peak = 0.2 * np.sqrt(3) * RATE**2 / NATURAL.acceleration_p95_mm_s2
    assert value("join_peak", comparison) == pytest.approx(peak)
    assert value("join_unnatural", comparison) == 1
    for factor, unnatural in ((0.99, 0), (1.01, 1)):  # the yardstick is that of stretches
        step = factor * NATURAL.stretch_p95_mm_s2 / (np.sqrt(3) * RATE**2)
        near = compared(lambda motion, step=step: jump / 0.2 * step, joins=(join,))
        assert value("join_unnatural", near) == unnatural
    still = compared(scaled(0.0), joins=(join,))
    assert value("join_unnatural", still) == 0
    assert np.isnan(value("join_peak", compared()))
    # sentences are pooled join by join
    assert value("joins", comparison, compared()) == 0.5
    assert value("join_gap_position", comparison, compared()) == pytest.approx(2)


def test_natural_stretches_peak_higher_than_natural_frames():
    assert NATURAL.stretch_p95_mm_s2 > NATURAL.acceleration_p95_mm_s2
    found = natural_distribution(
        [r.capture for r in RECORDINGS[1:]], RATE, LIPS_CHIN, [(0.0, 99.0)] * len(RECORDINGS[1:])
    )
    assert NATURAL.stretch_p95_mm_s2 == pytest.approx(np.percentile(found.peaks_mm_s2, 95), rel=0.2)


def test_word_metrics_look_at_words_only():
    recording = RECORDINGS[0]
    words = (recording.capture.times_s > 0.6) & (recording.capture.times_s < 0.9)
    times = TRAINING.times_s(recording.utterance)

    def wrong_elsewhere(motion):
        motion[(times < 0.55) | (times > 0.95)] += 50
        return motion

    assert value("word_rmse", compared(wrong_elsewhere, words=words)) < 0.1
    assert value("word_rmse", compared(moved(0, 3, 4), words=words)) == pytest.approx(5)
    assert np.isnan(value("word_rmse", compared()))
    halves = (compared(scaled(0.5), words=words), compared(scaled(0.5), words=words))
    assert value("word_r_aperture", *halves) == pytest.approx(1, abs=1e-6)
