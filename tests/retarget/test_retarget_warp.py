"""The volume warp: exact landmarks, affine maps, derivative, equivariance, smoothing, folds."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import RBFInterpolator
from scipy.spatial.transform import Rotation

from corpus_tools.core import InputError, MeshError
from corpus_tools.retarget import (
    WARP_KERNELS,
    choose_smoothing,
    fit_volume_warp,
    fold_check,
    leave_one_out_mm,
)

seeds = st.integers(0, 2**16)


def landmarks(seed, n=40, bend=6.0):
    """Return source points over a face-sized box and their bent image, mm."""
    rng = np.random.default_rng(seed)
    source = rng.uniform([-60, -90, -40], [60, 60, 40], (n, 3))
    turned = source @ Rotation.from_rotvec([0.1, 0.2, -0.05]).as_matrix().T * 1.2 + [5, 600, 20]
    return source, turned + bend * np.sin(source[:, [1, 2, 0]] / 30.0)


@pytest.mark.parametrize("kernel", list(WARP_KERNELS))
class TestEveryKernel:
    """Laws of every kernel of the registry."""

    @given(seed=seeds)
    def test_passes_through_the_landmarks_without_smoothing(self, kernel, seed):
        source, target = landmarks(seed)
        warp = fit_volume_warp(source, target, kernel=kernel, smoothing=0.0)
        np.testing.assert_allclose(warp(source), target, rtol=1e-9, atol=1e-6)

    @given(seed=seeds)
    def test_reproduces_affine_maps_everywhere(self, kernel, seed):
        rng = np.random.default_rng(seed)
        source, _ = landmarks(seed)
        matrix = np.eye(3) + rng.normal(0, 0.2, (3, 3))
        warp = fit_volume_warp(source, source @ matrix.T + [1, 2, 3], kernel=kernel, smoothing=1e-2)
        points = rng.uniform(-100, 100, (20, 3))
        np.testing.assert_allclose(warp(points), points @ matrix.T + [1, 2, 3], atol=1e-6)

    @given(seed=seeds)
    def test_jacobian_is_the_derivative(self, kernel, seed):
        source, target = landmarks(seed)
        warp = fit_volume_warp(source, target, kernel=kernel, smoothing=1e-3)
        points = np.random.default_rng(seed).uniform(-50, 50, (5, 3))
        h = 1e-3
        steps = np.stack([(warp(points + h * e) - warp(points - h * e)) / (2 * h) for e in np.eye(3)], axis=2)
        np.testing.assert_allclose(warp.jacobian(points), steps, atol=2e-4)

    @given(seed=seeds)
    def test_turning_and_scaling_the_target_turns_and_scales_the_result(self, kernel, seed):
        source, target = landmarks(seed)
        rotation = Rotation.from_rotvec(np.random.default_rng(seed).normal(0, 2, 3)).as_matrix()
        points = source[:7] + 3.0
        one = fit_volume_warp(source, target, kernel=kernel)(points)
        other = fit_volume_warp(source, 1.7 * target @ rotation.T - 4.0, kernel=kernel)(points)
        np.testing.assert_allclose(other, 1.7 * one @ rotation.T - 4.0, atol=1e-6)

    def test_smoothing_trades_landmarks_for_smoothness(self, kernel):
        source, target = landmarks(1)
        noisy = target + np.random.default_rng(0).normal(0, 1.0, target.shape)
        missed = [
            np.abs(fit_volume_warp(source, noisy, kernel=kernel, smoothing=s)(source) - noisy).max()
            for s in (0.0, 1e-3, 1e-1, 10.0)
        ]
        assert missed[0] < 1e-6
        assert (np.diff(missed) > 0).all()


@pytest.mark.parametrize(
    ("kernel", "peer"), [("cubic", "cubic"), ("linear", "linear"), ("thin-plate", "thin_plate_spline")]
)
def test_agrees_with_scipy(kernel, peer):
    source, target = landmarks(3)
    box = (source - 0.5 * (source.max(0) + source.min(0))) / np.ptp(source, axis=0).max()
    warp = fit_volume_warp(source, target, kernel=kernel, smoothing=1e-2)
    points = np.random.default_rng(1).uniform(-40, 40, (30, 3))
    box_points = (points - warp.centre_mm) / warp.scale_mm
    expected = RBFInterpolator(box, target, kernel=peer, smoothing=1e-2, degree=1)(box_points)
    np.testing.assert_allclose(warp(points), expected, rtol=1e-9, atol=1e-7)


def test_shape_of_points_is_kept():
    source, target = landmarks(0)
    warp = fit_volume_warp(source, target)
    assert warp(source[0]).shape == (3,)
    assert warp(source[None, :4]).shape == (1, 4, 3)


def test_a_fold_is_found_and_smoothing_opens_it():
    source, target = landmarks(2, n=60, bend=0.0)
    crossed = target.copy()
    near = np.argsort(np.linalg.norm(source - source[0], axis=1))[1]
    crossed[[0, near]] = crossed[[near, 0]]
    folded = fold_check(fit_volume_warp(source, crossed, smoothing=0.0), source)
    assert folded.least_det < 0
    assert folded.n_folded >= 1
    assert np.linalg.norm(np.array(folded.at_mm) - source, axis=1).min() < 1e-9
    smoothed = fold_check(fit_volume_warp(source, crossed, smoothing=1.0), source)
    assert smoothed.least_det > 0
    assert smoothed.n_folded == 0


def test_leave_one_out_prefers_smoothing_for_noisy_landmarks():
    source, target = landmarks(4, n=60)
    noisy = target + np.random.default_rng(2).normal(0, 2.0, target.shape)
    assert choose_smoothing(source, noisy) > choose_smoothing(source, target)
    assert leave_one_out_mm(source, noisy).shape == (60,)
    assert leave_one_out_mm(source, noisy).mean() > leave_one_out_mm(source, target).mean()


@pytest.mark.parametrize(
    ("source", "target", "words"),
    [
        (np.zeros((5, 3)), np.zeros((4, 3)), r"\(n, 3\) twice"),
        (np.eye(3), np.eye(3), "at least 4"),
        (np.full((5, 3), np.nan), np.zeros((5, 3)), "not finite"),
        (np.c_[np.random.default_rng(0).normal(size=(9, 2)), np.zeros(9)], np.zeros((9, 3)), "one plane"),
        (np.zeros((6, 3)), np.zeros((6, 3)), "coincide"),
    ],
)
def test_landmarks_that_carry_no_warp_are_refused(source, target, words):
    with pytest.raises(MeshError, match=words):
        fit_volume_warp(source, target)


def test_unknown_kernel():
    source, target = landmarks(0)
    with pytest.raises(InputError, match="did you mean 'cubic'"):
        fit_volume_warp(source, target, kernel="cubik")
