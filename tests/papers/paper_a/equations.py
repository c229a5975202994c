"""Paper A: eq. (1), the interpolant of radial basis functions, and eq. (2), the weighted blend."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import RBFInterpolator

from corpus_tools.synthesis import (
    WEIGHTINGS,
    align_fragments,
    blend_pieces,
    fit_time_rbf,
    fit_uniform_rbf,
    weighting,
)
from tests.strategies.fragments import NAMES, band_limited, seeds, spliced


def uneven_times(rng, n):
    return np.cumsum(rng.uniform(0.02, 0.06, n))


@given(seeds, st.integers(3, 60))
def test_eq_1_is_the_sum_of_basis_functions_and_a_polynomial(seed, n):
    """Eq. (1), f(x) = p(x) + sum alpha_i phi(|x - c_i|), against another implementation of it."""
    rng = np.random.default_rng(seed)
    times = uneven_times(rng, n)
    values = band_limited(rng)(times)
    curve = fit_time_rbf(times, values, c=0.3)
    oracle = RBFInterpolator(
        times[:, None], values.reshape(n, -1), kernel="inverse_multiquadric", epsilon=curve.eps_hz, degree=1
    )
    dense = np.linspace(times[0], times[-1], 300)
    np.testing.assert_allclose(curve(dense).reshape(300, -1), oracle(dense[:, None]), atol=1e-6)


@given(seeds, st.integers(2, 120))
def test_eq_1_interpolates_every_centre_exactly(seed, n):
    """ "the weights, alpha_i, which ensure that all of the basis centres are exactly interpolated" """
    rng = np.random.default_rng(seed)
    motion, uneven = band_limited(rng), uneven_times(rng, n)
    even = 0.3 + np.arange(n) / 25
    for times, fit in ((uneven, fit_time_rbf), (even, lambda t, v: fit_uniform_rbf(t[0], 25.0, v))):
        values = motion(times)
        assert np.abs(fit(times, values)(times) - values).max() <= 1e-10 * np.ptp(values)


def test_eq_1_the_weights_annihilate_the_polynomial():
    """The side conditions of the linear system: sum alpha = 0 and sum alpha_i c_i = 0."""
    values = band_limited(np.random.default_rng(0))(np.arange(50) / 25)
    curve = fit_uniform_rbf(0.0, 25.0, values)
    alpha = curve.weights[:-2]
    size = np.abs(alpha).sum()
    assert np.abs(alpha.sum(axis=0)).max() <= 1e-9 * size
    assert np.abs(np.tensordot(curve.centres_s, alpha, axes=1)).max() <= 1e-9 * size


def test_eq_1_the_curve_is_smooth_at_the_centres():
    """ "continuous in all derivatives": fourth differences do not see where the samples are."""
    values = band_limited(np.random.default_rng(3))(np.arange(50) / 25)
    curve = fit_uniform_rbf(0.0, 25.0, values)
    dense = np.linspace(0.5, 1.5, 2001)
    fourth = np.abs(np.diff(curve(dense), 4, axis=0)).max(axis=(1, 2))
    at_centre = np.abs(dense[2:-2] * 25 - np.round(dense[2:-2] * 25)) < 0.02
    assert fourth[at_centre].max() <= 1.5 * fourth[~at_centre].max()


@pytest.mark.parametrize("name", list(WEIGHTINGS))
@given(seeds, st.floats(-1, 1))
def test_eq_2_weighs_the_two_fragments_of_every_overlap(name, seed, shape):
    selection, target, fragments = spliced(np.random.default_rng(seed))
    aligned = align_fragments(selection, target, fragments, names=NAMES)
    blended = blend_pieces(aligned, weighting=name, shape=shape)
    g = weighting(name, shape)
    times, values = blended.times_s, blended.values_mm
    expected = np.full_like(values, np.nan)
    theta_0 = expected
    for piece, join_before, join_after in zip(
        aligned.pieces, [None, *blended.joins], [*blended.joins, None], strict=True
    ):
        own = np.full_like(values, np.nan)
        own[piece.start : piece.stop] = piece.motion_mm
        alone = np.ones(len(times), bool)
        if join_before is not None:
            t0, t1 = (join_before.time_s + s * join_before.overlap_s / 2 for s in (-1, 1))
            alone &= times > t1
            inside = np.flatnonzero((times >= t0) & (times <= t1))
            u = (times[inside] - t0) / (t1 - t0)
            weight = g(u)[:, None, None]
            expected[inside] = weight * theta_0[inside] + (1 - weight) * own[inside]
        if join_after is not None:
            alone &= times < join_after.time_s - join_after.overlap_s / 2
        expected[alone] = own[alone]
        theta_0 = own
    assert len(blended.joins) == 2
    np.testing.assert_allclose(values, expected, atol=1e-9)
