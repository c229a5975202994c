import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import Capture, CorpusError, MotionError, Recording
from corpus_tools.fragments import build_inventory
from corpus_tools.synthesis import join_features, posture_basis
from tests.strategies.inventories import MARKERS, corpora, recording, simulated_recordings, utterance


@given(corpora(least=2), st.integers(1, 15))
def test_components_are_orthonormal_and_ordered(recordings, n):
    basis = posture_basis(build_inventory(recordings), n=n)
    np.testing.assert_allclose(basis.components @ basis.components.T, np.eye(n), atol=1e-10)
    assert (np.diff(basis.explained) <= 1e-12).all()
    assert basis.explained.sum() <= 1 + 1e-9


@given(corpora(least=2))
def test_all_components_lose_nothing(recordings):
    inventory = build_inventory(recordings)
    basis = posture_basis(inventory, n=3 * (len(MARKERS) - 1))
    frames = inventory.recordings[0].capture.positions_mm[:, :-1]
    np.testing.assert_allclose(basis.reconstruct(basis.project(frames)), frames, atol=1e-9)


def test_it_is_the_decomposition_of_all_frames():
    inventory = build_inventory(simulated_recordings(5, 4))
    basis = posture_basis(inventory, n=4)
    frames = np.concatenate([r.capture.positions_mm[:, :-1].reshape(-1, 15) for r in inventory.recordings])
    np.testing.assert_allclose(basis.mean_mm, frames.mean(axis=0), atol=1e-10)
    _, sizes, axes = np.linalg.svd(frames - frames.mean(axis=0), full_matrices=False)
    np.testing.assert_allclose(basis.explained, (sizes**2 / (sizes**2).sum())[:4], atol=1e-10)
    np.testing.assert_allclose(np.abs(np.sum(basis.components * axes[:4], axis=1)), 1, atol=1e-8)


def test_head_markers_are_left_out_unless_named():
    inventory = build_inventory(simulated_recordings(3))
    assert posture_basis(inventory).names == MARKERS[:-1]
    assert posture_basis(inventory, ["chin0"], 2).names == ("chin0",)


def test_signs_do_not_depend_on_the_solver():
    basis = posture_basis(build_inventory(simulated_recordings(4, 9)), n=5)
    largest = np.abs(basis.components).argmax(axis=1)
    assert (basis.components[np.arange(5), largest] > 0).all()


def test_join_features_are_posture_and_velocity_at_the_phone_centres():
    spoken = utterance("a", ["SIL", "P", "A", "SIL"])
    times = np.arange(41) / 100
    motion = np.zeros((41, len(MARKERS), 3))
    motion[:, 2, 1] = 30 * times**2
    inventory = build_inventory([Recording(spoken, Capture(motion, 100.0, MARKERS))])
    joins = join_features(inventory, posture_basis(inventory, n=1))
    centres = np.array([0.05, 0.15, 0.25, 0.35])
    heights = joins.position[:, 0] * joins.position_sd_mm
    np.testing.assert_allclose(np.diff(heights), np.diff(30 * centres**2), atol=1e-9)
    np.testing.assert_allclose(joins.velocity[:, 0] * joins.velocity_sd_mm_s, 60 * centres, atol=1e-7)
    assert joins.velocity_sd_mm_s == pytest.approx(np.sqrt(np.mean((60 * centres) ** 2)))


def test_captures_that_were_not_cleaned_are_named():
    good = recording("a", ["SIL", "P", "SIL"])
    broken = good.capture.positions_mm.copy()
    broken[3] = np.nan
    bad = Recording(
        utterance("b", ["SIL", "P", "SIL"]), dataclasses.replace(good.capture, positions_mm=broken)
    )
    inventory = build_inventory([good, bad])
    with pytest.raises(MotionError, match="'b' has missing markers"):
        join_features(inventory, posture_basis(inventory))
    empty = dataclasses.replace(good.capture, positions_mm=np.full_like(broken, np.nan))
    with pytest.raises(CorpusError, match="fewer than two frames"):
        posture_basis(build_inventory([Recording(good.utterance, empty)]))
