import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import Interval, Trajectory
from corpus_tools.synthesis import close_lips, closure_direction
from corpus_tools.synthesis.closure import HOLD_S, LEAST_FLANK_S, PRESSED_MM
from tests.strategies.fragments import seeds

NAMES = ("lip_in1", "lip_in7", "chin3", "brow0")
FUNCTIONAL = np.zeros((4, 3))
FUNCTIONAL[0, 1], FUNCTIONAL[1, 1] = 1.0, -1.0
TARGET_MM = 0.3
BILABIALS = ("P", "B", "M")


def aperture(values):
    return np.einsum("fmk,mk->f", values, FUNCTIONAL)


def direction(seed=0):
    """Return the opening of a simulated face in which lower lip and chin go down together."""
    rng = np.random.default_rng(seed)
    frames = rng.normal(0, 0.2, (500, 12))
    jaw = np.zeros((4, 3))
    jaw[1, 1], jaw[2, 1], jaw[0, 1] = -1, -0.8, 0.1
    frames += rng.normal(0, 3, (500, 1)) * jaw.ravel()
    variances, vectors = np.linalg.eigh(np.cov(frames.T))
    return closure_direction(FUNCTIONAL, vectors.T, variances)


def speak(opening, phones):
    """Return a trajectory whose aperture follows `opening(times)`."""
    times = np.arange(0, phones[-1].end_s, 1 / 120)
    values = np.random.default_rng(1).normal(0, 10, (4, 3)) + np.zeros((len(times), 4, 3))
    values[:, 0, 1], values[:, 1, 1] = 5.0, 5.0 - opening(times)
    return Trajectory(times, values, NAMES)


def timeline(labels, durations):
    edges = np.concatenate([[0], np.cumsum(durations)])
    return [Interval(float(a), float(b), p) for a, b, p in zip(edges[:-1], edges[1:], labels, strict=True)]


def close(trajectory, phones, **settings):
    return close_lips(
        trajectory,
        phones,
        labels=BILABIALS,
        functional=FUNCTIONAL,
        direction=direction(),
        target_mm=TARGET_MM,
        **settings,
    )


@st.composite
def sentences(draw):
    n = draw(st.integers(3, 12))
    labels = draw(st.lists(st.sampled_from(["P", "B", "M", "A", "T"]), min_size=n, max_size=n))
    rng = np.random.default_rng(draw(seeds))
    phones = timeline(["SIL", *labels, "SIL"], [0.3, *rng.uniform(0.02, 0.25, n), 0.3])
    hz, phase = rng.uniform(1, 6, 4), rng.uniform(0, 6, 4)
    return phones, lambda t: 6 + 1.2 * np.sin(2 * np.pi * hz * t[:, None] + phase).sum(axis=1)


@given(sentences())
def test_every_bilabial_closes_to_within_a_twentieth_of_a_mm(sentence):
    phones, opening = sentence
    before = speak(opening, phones)
    after = close(before, phones)
    seen = aperture(after.values_mm)
    for phone in phones:
        inside = (after.times_s >= phone.start_s) & (after.times_s <= phone.end_s)
        if phone.text in BILABIALS:
            assert seen[inside].min() <= TARGET_MM + 0.05
    apart = [p for p in phones if p.text in BILABIALS]
    assert bool(apart) <= after.history[-1].as_dict()["closures"] <= len(apart)
    assert (seen <= aperture(before.values_mm) + 1e-12).all()


@given(sentences(), st.sampled_from([0.0, 0.03, HOLD_S, 0.1]))
def test_lips_stay_closed_as_long_as_asked_or_as_the_phone_lasts(sentence, hold_s):
    phones, opening = sentence
    after = close(speak(opening, phones), phones, hold_mm=TARGET_MM + 0.5, hold_s=hold_s)
    closed = aperture(after.values_mm) <= TARGET_MM + 0.55
    for phone in phones:
        inside = closed[(after.times_s >= phone.start_s) & (after.times_s <= phone.end_s)]
        if phone.text in BILABIALS and len(inside):
            longest = max(len(run) for run in "".join("x" if c else " " for c in inside).split(" "))
            assert longest >= min(1 + int(hold_s * 120 + 1e-9), len(inside))


def test_a_film_of_thirty_frames_a_second_shows_every_closure():
    phones = timeline(["SIL", "A", "P", "A", "SIL"], [0.3, 0.2, 0.06, 0.2, 0.3])
    after = close(speak(lambda t: np.full(len(t), 8.0), phones), phones)
    seen = aperture(after.values_mm)
    for phase_s in np.linspace(0, 1 / 30, 9):
        frames = np.arange(phase_s, 1.0, 1 / 30)
        assert np.interp(frames, after.times_s, seen).min() <= TARGET_MM + 0.05


@given(sentences())
def test_times_away_from_a_bilabial_are_not_touched(sentence):
    phones, opening = sentence
    before = speak(opening, phones)
    after = close(before, phones)
    reach = np.zeros(len(before.times_s), bool)
    for phone in phones:
        if phone.text in BILABIALS:
            wide = max(0.07, 0.5 * phone.duration_s + 0.04)
            reach |= (before.times_s >= phone.start_s - wide) & (before.times_s <= phone.end_s + wide)
    np.testing.assert_array_equal(after.values_mm[~reach], before.values_mm[~reach])


@given(sentences())
def test_lips_that_are_closed_already_are_left_alone(sentence):
    phones, opening = sentence
    once = close(speak(opening, phones), phones)
    twice = close(once, phones)
    np.testing.assert_array_equal(twice.values_mm, once.values_mm)
    assert twice.history[-1].as_dict()["closures"] == 0
    assert twice.history[-1].as_dict()["largest_mm"] == 0


@given(sentences(), st.floats(0, 0.2), st.sampled_from([1.0, 1.6]))
def test_lips_are_never_pressed_through_each_other(sentence, shift, depth):
    """Closed beside the phone, as with labels that come too early: the bump must not press on there."""
    phones, opening = sentence
    before = speak(lambda t: opening(t) * (1 - depth * np.exp(-(((t - 0.3 - shift) / 0.03) ** 2))), phones)
    seen, after = aperture(before.values_mm), aperture(close(before, phones).values_mm)
    assert (after >= np.minimum(seen, TARGET_MM - PRESSED_MM) - 1e-12).all()
    assert (after <= seen + 1e-12).all()


def test_a_shut_mouth_is_never_opened():
    phones = timeline(["SIL", "P", "SIL"], [0.2, 0.1, 0.2])
    before = speak(lambda t: np.full(len(t), -1.0), phones)
    np.testing.assert_array_equal(close(before, phones).values_mm, before.values_mm)


def test_the_largest_change_is_reported():
    phones = timeline(["SIL", "A", "P", "A", "SIL"], [0.3, 0.2, 0.1, 0.2, 0.3])
    before = speak(lambda t: np.full(len(t), 4.0), phones)
    after = close(before, phones)
    step = after.history[-1].as_dict()
    assert step["step"] == "close_lips"
    assert step["closures"] == 1
    assert step["largest_mm"] == pytest.approx(4 - TARGET_MM, abs=1e-4)
    moved = aperture(before.values_mm) - aperture(after.values_mm)
    assert moved.max() == pytest.approx(4 - TARGET_MM)
    wide = after.times_s[moved > 1e-12]
    assert wide[-1] - wide[0] == pytest.approx(2 * max(0.07, 0.05 + 0.04) + HOLD_S, abs=2.1 / 120)


def test_the_change_is_the_likeliest_one_of_this_face():
    """Of all changes that move the aperture by 1 mm, the least in the metric of the covariance."""
    rng = np.random.default_rng(3)
    mixing = rng.normal(0, 1, (12, 12))
    variances, vectors = np.linalg.eigh(mixing @ mixing.T)
    best = closure_direction(FUNCTIONAL, vectors.T, variances).ravel()
    inverse = np.linalg.inv(mixing @ mixing.T)
    assert best @ FUNCTIONAL.ravel() == pytest.approx(1)
    for _ in range(50):
        other = rng.normal(0, 1, 12)
        other /= other @ FUNCTIONAL.ravel()
        assert best @ inverse @ best <= other @ inverse @ other + 1e-9


def test_the_chin_follows_the_lower_lip_and_the_brow_does_not():
    opening = direction()
    assert opening[1, 1] == pytest.approx(-0.9, abs=0.1)
    assert opening[2, 1] == pytest.approx(0.8 * opening[1, 1], rel=0.1)
    assert np.abs(opening[3]).max() < 0.05


def test_a_face_whose_lips_never_move_is_left_alone():
    nothing = closure_direction(FUNCTIONAL, np.eye(12)[9:], np.ones(3))
    np.testing.assert_array_equal(nothing, 0)
    phones = timeline(["SIL", "P", "SIL"], [0.2, 0.1, 0.2])
    before = speak(lambda t: np.full(len(t), 4.0), phones)
    after = close_lips(
        before, phones, labels=BILABIALS, functional=FUNCTIONAL, direction=nothing, target_mm=TARGET_MM
    )
    np.testing.assert_array_equal(after.values_mm, before.values_mm)


def test_a_phone_shorter_than_a_frame_closes_too():
    phones = timeline(["SIL", "A", "P", "A", "SIL"], [0.3, 0.2021, 0.002, 0.2, 0.3])
    after = close(speak(lambda t: np.full(len(t), 4.0), phones), phones)
    assert aperture(after.values_mm).min() == pytest.approx(TARGET_MM)


@given(sentences())
def test_a_vowel_is_left_alone_from_its_centre_on(sentence):
    """A mouth that a bilabial shuts is open again at the centre of a vowel that is long enough."""
    phones, opening = sentence
    before = speak(opening, phones)
    after = close(before, phones, vowels=("A",))
    change = np.abs(aperture(after.values_mm) - aperture(before.values_mm))
    for k, phone in enumerate(phones):
        beside = {phones[k - 1].text, phones[k + 1].text} if phone.text == "A" else set()
        if beside & set(BILABIALS) and phone.duration_s >= 2 * LEAST_FLANK_S:
            assert np.interp(phone.centre_s, after.times_s, change) < 0.1
