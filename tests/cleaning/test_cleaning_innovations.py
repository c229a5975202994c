"""Noise and cutoff found from innovations: near the optimum, exact at gaps, with true bands."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import butter, sosfiltfilt

from corpus_tools.cleaning import (
    clean_captures,
    estimated_smooth,
    likeliest_cutoffs,
    smooth_by_components,
    smooth_channels,
    smooth_estimated,
)
from corpus_tools.cleaning.innovations import CUTOFFS_HZ, LEAST_SAMPLES, _likelihoods
from corpus_tools.cleaning.kalman import process_noise
from corpus_tools.core import Capture, FrameFlag

RATE_HZ, N, NOISE_MM = 120.0, 2000, 0.15
seeds = st.integers(0, 2**31)


def band(rng, n, high_hz):
    """Return n channels of unit noise below a frequency."""
    made = sosfiltfilt(butter(3, high_hz, fs=RATE_HZ, output="sos"), rng.normal(size=(N, n)), axis=0)
    return made / made.std(axis=0)


@pytest.fixture(scope="module")
def simulated():
    """A simulated capture: 8 gestures below 6 Hz in 90 channels, .15 mm of skin, .15 mm of noise."""
    rng = np.random.default_rng(3)
    sizes = np.array([4, 2.5, 1.5, 1, 0.7, 0.5, 0.35, 0.25])
    truth = band(rng, 8, 6.0) * sizes @ rng.normal(size=(8, 90)) / np.sqrt(8) + 0.15 * band(rng, 90, 5.0)
    return truth, truth + rng.normal(0, NOISE_MM, truth.shape)


def gain_db(smoothed, truth, seen):
    return 10 * np.log10(((seen - truth) ** 2).mean() / ((smoothed - truth) ** 2).mean())


def within(smoothed, truth, sd):
    return float((np.abs(smoothed - truth) <= 1.645 * sd).mean())


def test_the_estimate_is_as_good_as_the_best_cutoff(simulated):
    """At least the 6 dB of one cutoff of 10 Hz (decision 012), and 8 dB through principal components."""
    truth, seen = simulated
    all_there = np.ones(N, bool)
    best = max(gain_db(smooth_channels(seen, all_there, RATE_HZ, c)[0], truth, seen) for c in CUTOFFS_HZ)
    smoothed, sd, _ = smooth_estimated(seen, all_there, RATE_HZ)
    found = gain_db(smoothed, truth, seen)
    assert found >= 6.0
    assert found >= best - 0.4
    assert 0.85 <= within(smoothed, truth, sd) <= 0.95
    by_components, sd = smooth_by_components(seen, RATE_HZ)
    assert gain_db(by_components, truth, seen) >= 8.0
    assert 0.75 <= within(by_components, truth, sd) <= 0.97


def test_the_noise_of_each_channel_is_found(simulated):
    truth, _ = simulated
    sizes = np.geomspace(0.05, 0.8, truth.shape[1])
    noisy = truth + np.random.default_rng(0).normal(size=truth.shape) * sizes
    cutoff, noise = likeliest_cutoffs(noisy, np.ones(N, bool), RATE_HZ)
    np.testing.assert_allclose(noise, sizes, rtol=0.2)
    assert np.corrcoef(np.log(cutoff), np.log(sizes))[0, 1] < -0.5  # what is noisier is smoothed more


def exact_likelihood(values, seen, cutoff_hz):
    """Twice the log-likelihood of one channel behind its first three samples, all covariances in full."""
    move, noise = np.array([[1, 1, 0.5], [0, 1, 1], [0, 0, 1]]), process_noise(RATE_HZ, cutoff_hz)
    omega = 2 * np.pi * cutoff_hz / RATE_HZ
    state, p = np.array([values[np.argmax(seen)], 0, 0]), 1e8 * np.diag([1, omega**2, omega**4])
    terms = []
    for k, value in enumerate(values):
        if k:
            state, p = move @ state, move @ p @ move.T + noise
        if seen[k]:
            expected, innovation = p[0, 0] + 1, value - state[0]
            terms.append((innovation**2 / expected, np.log(expected)))
            gain = p[:, 0] / expected
            state, p = state + gain * innovation, p - np.outer(gain, p[0])
    squares, logs = np.array(terms[3:]).T
    return -len(squares) * np.log(squares.mean()) - logs.sum(), squares.mean()


@settings(max_examples=10)
@given(seeds, st.sampled_from(CUTOFFS_HZ[3:9]))
def test_the_likelihood_is_that_of_the_filter_gaps_included(seed, cutoff_hz):
    rng = np.random.default_rng(seed)
    values = np.cumsum(rng.normal(size=(90, 2)), axis=0)
    seen = np.ones(90, bool)
    for first in rng.integers(5, 70, 2):
        seen[first : first + int(rng.integers(1, 14))] = False
    values[~seen] = np.nan
    found, variance = _likelihoods(values, seen, RATE_HZ, cutoff_hz)
    for channel in range(2):
        wanted, wanted_variance = exact_likelihood(values[:, channel], seen, cutoff_hz)
        assert found[channel] == pytest.approx(wanted, rel=1e-5)
        assert variance[channel] == pytest.approx(wanted_variance, rel=1e-4)


@settings(max_examples=8)
@given(seeds, st.floats(0.01, 100.0), st.floats(-500, 500))
def test_size_and_place_do_not_matter(simulated, seed, size, place):
    values = simulated[1][:400, seed % 80 : seed % 80 + 3]
    seen = np.ones(400, bool)
    one, one_sd, one_hz = smooth_estimated(values, seen, RATE_HZ)
    other, other_sd, other_hz = smooth_estimated(size * values + place, seen, RATE_HZ)
    np.testing.assert_array_equal(one_hz, other_hz)
    np.testing.assert_allclose(other, size * one + place, rtol=1e-6, atol=1e-6 * size)
    np.testing.assert_allclose(other_sd, size * one_sd, rtol=1e-4)


def test_the_band_grows_in_a_gap_that_is_left(simulated):
    truth, noisy = simulated
    positions = noisy.reshape(N, 30, 3).copy()
    positions[500:520, 4] = np.nan
    positions[:10, 7] = np.nan
    capture = Capture(positions, RATE_HZ, tuple(f"m{i}" for i in range(30)))
    for by_components in (False, True):
        smooth, sd_mm = estimated_smooth(capture, by_components=by_components)
        assert np.isfinite(smooth.positions_mm).all()
        assert (smooth.flags[500:520, 4] & FrameFlag.FILLED > 0).all()
        assert (smooth.flags[:10, 7] & FrameFlag.DOUBTFUL > 0).all()
    smooth, sd_mm = estimated_smooth(capture)
    assert sd_mm[510, 4].min() > 3 * sd_mm[400, 4].max()
    true = truth.reshape(N, 30, 3)
    assert (np.abs(smooth.positions_mm - true)[500:520, 4] < 4 * sd_mm[500:520, 4]).all()


def test_too_few_samples_say_nothing():
    values = np.random.default_rng(0).normal(size=(LEAST_SAMPLES - 1, 2))
    cutoff, noise = likeliest_cutoffs(values, np.ones(len(values), bool), RATE_HZ)
    assert np.unique(cutoff).size == 1
    assert not noise.any()


@pytest.mark.parametrize(("noise", "most"), [("channels", 1.0), ("components", 1.05)])
def test_cleaning_can_be_told_to_estimate(simulated, noise, most):
    """With head markers that show hardly any noise; in 5 s, components are no better than one cutoff."""
    truth, noisy = (x[:600].reshape(600, 30, 3).copy() for x in simulated)
    shape = 20.0 * np.random.default_rng(1).normal(size=(30, 3))
    noisy[:, :4] = 0.05 * (noisy - truth)[:, :4]
    truth[:, :4] = 0.0
    seen = Capture(shape + noisy, RATE_HZ, tuple(f"m{i}" for i in range(30)))
    usual, told = (
        clean_captures([seen], [0, 1, 2, 3], allow_scale=False, outliers=False, noise=n)
        for n in ("cutoff", noise)
    )
    assert told.captures[0].history[-1].name == "estimated_smooth"
    assert usual.captures[0].history[-1].name == "kalman_smooth"
    exact = told.head_motion[0].stabilise(shape + truth)
    errors = [np.sqrt(((c.captures[0].positions_mm - exact) ** 2)[:, 4:].mean()) for c in (usual, told)]
    assert errors[1] < most * errors[0]
