import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import SynthesisError
from corpus_tools.synthesis import fit_time_rbf, fit_uniform_rbf, resample_uniform
from tests.strategies.fragments import band_limited, seeds


@given(seeds, st.integers(2, 400), st.sampled_from([0.15, 0.2, 0.3]))
def test_samples_are_met_and_the_system_is_well_conditioned(seed, n, c):
    rng = np.random.default_rng(seed)
    times = 0.02 + np.arange(n) / 25
    motion = 3 * band_limited(rng)(times)
    noisy = motion + (rng.normal(0, 3, motion.shape) if c > 0.15 else 0)
    for values, residual in ((motion, 1e-10 if c > 0.15 else 2e-9), (noisy, 5e-9)):
        curve = fit_uniform_rbf(0.02, 25.0, values, c)
        assert np.abs(curve(times) - values).max() <= residual * np.ptp(values)
    assert curve.cond <= {0.15: 1e11, 0.2: 6e8, 0.3: 4e6}[c]


@given(seeds, st.integers(2, 60))
def test_straight_motion_stays_straight(seed, n):
    a, b = np.random.default_rng(seed).normal(0, 5, (2, 3))
    times = np.arange(n) / 25.0
    curve = fit_uniform_rbf(0.0, 25.0, a + b * times[:, None])
    dense = np.linspace(0, times[-1], 200)
    np.testing.assert_allclose(curve(dense), a + b * dense[:, None], atol=1e-8)


@given(seeds)
def test_the_uniform_way_is_the_general_way_on_a_uniform_clock(seed):
    rng = np.random.default_rng(seed)
    times = 1.3 + np.arange(40) / 25
    values = band_limited(rng)(times)
    dense = np.linspace(times[0], times[-1], 200)
    np.testing.assert_allclose(
        fit_uniform_rbf(1.3, 25.0, values)(dense), fit_time_rbf(times, values)(dense), atol=1e-7
    )


@given(seeds)
def test_a_linear_map_of_the_values_may_be_made_before_or_after(seed):
    rng = np.random.default_rng(seed)
    values, matrix = rng.normal(0, 2, (30, 3)), rng.normal(0, 1, (3, 3))
    dense = np.linspace(0, 29 / 25, 100)
    np.testing.assert_allclose(
        fit_uniform_rbf(0, 25.0, values @ matrix)(dense),
        fit_uniform_rbf(0, 25.0, values)(dense) @ matrix,
        atol=1e-7,
    )


def test_long_recordings_are_read_in_blocks_that_do_not_show():
    motion = band_limited(np.random.default_rng(1))
    values = motion(np.arange(1400) / 100)
    dense = np.linspace(0, 13.99, 5000)
    read, cond = resample_uniform(0.0, 100.0, values, dense)
    assert cond < 1e9
    whole = fit_uniform_rbf(0.0, 100.0, values)(dense)
    np.testing.assert_allclose(read, whole, atol=1e-4 * np.ptp(values))
    np.testing.assert_allclose(read[100:-100], whole[100:-100], atol=1e-8 * np.ptp(values))
    np.testing.assert_allclose(read[100:-100], motion(dense)[100:-100], atol=1e-4 * np.ptp(values))
    np.testing.assert_array_equal(
        resample_uniform(0.0, 100.0, values[:300], dense[:500])[0],
        fit_uniform_rbf(0.0, 100.0, values[:300])(dense[:500]),
    )


def test_a_flat_basis_is_refused_with_advice():
    with pytest.raises(SynthesisError, match=r"condition number .*raise alignment\.shape_c"):
        fit_uniform_rbf(0.0, 25.0, np.zeros((100, 3)), c=0.05)


def test_samples_that_fall_together_are_merged():
    times = np.array([0, 1, 2, 2 + 1e-7, 3, 4, 5]) / 25
    values = np.array([0.0, 1, 4, 4, 9, 16, 25])
    curve = fit_time_rbf(times, values)
    assert len(curve.centres_s) == 6
    np.testing.assert_allclose(curve(times), values, atol=1e-5)
    assert curve.cond < 1e8
