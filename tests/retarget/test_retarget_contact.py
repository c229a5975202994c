"""Lip contact: lips touch, never pass, and the change in time stays smooth."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import Mesh
from corpus_tools.retarget import (
    contact_aperture,
    contact_solver,
    keep_lips_apart,
    lip_marker_pairs,
    pair_response,
)

REST = np.array([[0, 1.0, 0], [0, 1.0, 0], [9, 5, 2]])
PAIRS = np.array([[0, 1]])
RESPONSE = pair_response(PAIRS, 3)
SOLVER = contact_solver(RESPONSE, ridge=0.0)


@given(a=st.floats(-20, 20), seal=st.floats(0, 2), soft=st.floats(1.0, 3))
def test_never_negative_and_unchanged_when_open(a, seal, soft):
    allowed = float(contact_aperture(a, seal_mm=seal, soft_mm=soft))
    assert allowed >= 0
    if a <= seal:
        assert allowed == 0
    if a >= seal + soft:
        assert allowed == a


@pytest.mark.parametrize(("seal", "soft"), [(0.0, 0.5), (0.5, 1.0), (0.9, 1.8)])
def test_grows_with_the_wish_and_has_no_corner(seal, soft):
    a = np.linspace(-1, 5, 60001)
    allowed = contact_aperture(a, seal_mm=seal, soft_mm=soft)
    slope = np.diff(allowed) / np.diff(a)
    assert slope.min() > -1e-9
    assert np.abs(np.diff(slope)).max() < 2e-3


def test_a_closed_mouth_at_rest_stays_exactly_at_rest():
    np.testing.assert_array_equal(keep_lips_apart(REST[None], REST, RESPONSE, SOLVER)[0], REST)


@given(gap=st.floats(-5, 5))
def test_lips_that_would_pass_meet_half_way(gap):
    targets = REST[None].copy()
    targets[0, 0, 1] += gap
    out = keep_lips_apart(targets, REST, RESPONSE, SOLVER)[0]
    aperture = out[0, 1] - out[1, 1]
    assert aperture >= -1e-12
    assert aperture == pytest.approx(float(contact_aperture(gap, seal_mm=0, soft_mm=0.5)), abs=1e-9)
    assert out[:2, 1].sum() == pytest.approx(targets[0, :2, 1].sum())
    np.testing.assert_array_equal(out[2], REST[2])
    np.testing.assert_array_equal(out[:, [0, 2]], targets[0][:, [0, 2]])


def test_seal_closes_what_a_tracker_leaves_open():
    targets = REST[None].copy()
    targets[0, 0, 1] += 0.6
    out = keep_lips_apart(targets, REST, RESPONSE, SOLVER, seal_mm=0.6, soft_mm=1.0)[0]
    assert out[0, 1] - out[1, 1] == pytest.approx(0.0, abs=1e-12)


def test_solver_changes_every_pair_as_wished():
    rng = np.random.default_rng(0)
    response = rng.normal(size=(5, 12))
    wish = rng.normal(size=5)
    np.testing.assert_allclose(response @ contact_solver(response, ridge=0.0) @ wish, wish, atol=1e-9)
    gentle = contact_solver(response, ridge=0.5) @ wish
    assert np.linalg.norm(gentle) < np.linalg.norm(contact_solver(response, ridge=0.0) @ wish)


def test_pairs_come_from_the_mesh_or_from_the_names():
    names = ("lip_in1", "lip_in7", "lip_in2", "lip_in6")
    markers = {n: i for i, n in enumerate(names)}
    faces, part = np.array([[0, 1, 2]]), np.zeros(4, np.int8)
    points = np.zeros((4, 3))
    own = Mesh("own", points, faces, part, markers=markers, lip_pairs=np.array([[3, 2], [0, 0]])[:1])
    assert lip_marker_pairs(own, names).tolist() == [[3, 2]]
    bare = Mesh("bare", points, faces, part, markers=markers)
    assert lip_marker_pairs(bare, names).tolist() == [[0, 1], [2, 3]]
    assert lip_marker_pairs(bare, ("chin0",)).shape == (0, 2)
