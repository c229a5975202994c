"""Topology, lip sides and regions of the skin."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import Mesh, MeshError
from corpus_tools.mesh import (
    CHARACTERS,
    LOWER_LIP,
    UPPER_LIP,
    SkinRegion,
    bundled_head,
    bundled_morph_mm,
    close_lips,
    edge_loop,
    edges_of,
    geodesic_mm,
    lower_side,
    signed_lip_aperture_mm,
    skin_regions,
    triangles,
    vertex_normals,
)


def grid_quads(n):
    """A flat n x n sheet of unit squares, 10 mm a side."""
    y, x = np.mgrid[0 : n + 1, 0 : n + 1]
    points = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1) * 10.0
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    return points, np.stack([corner, corner + 1, corner + n + 2, corner + n + 1], axis=1)


def test_quads_become_triangles_of_the_same_area_and_side():
    points, quads = grid_quads(3)
    faces = triangles(quads)
    normals = np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])
    assert len(faces) == 18
    assert normals[:, 2].sum() / 2 == pytest.approx(900)
    np.testing.assert_allclose(vertex_normals(points, quads), np.tile([0, 0, 1.0], (16, 1)))


def test_edges_are_listed_once():
    _, quads = grid_quads(3)
    edges = edges_of(quads)
    assert len(edges) == 24
    assert len(np.unique(edges, axis=0)) == 24


def test_edge_loop_runs_straight_across_a_grid():
    _, quads = grid_quads(4)
    assert edge_loop(quads, 6, 7) == [6, 7, 8, 9]


@given(st.integers(0, 48))
def test_geodesics_bound_the_straight_distance_from_above_within_nine_per_cent(source):
    points, quads = grid_quads(6)
    found = geodesic_mm(points, triangles(quads), [source])
    straight = np.linalg.norm(points - points[source], axis=1)
    assert (found >= straight - 1e-9).all()
    assert (found <= 1.09 * straight + 1e-9).all()


def test_what_is_not_connected_is_infinitely_far():
    points = np.r_[np.eye(3), np.eye(3) + 100]
    distances = geodesic_mm(points, [[0, 1, 2], [3, 4, 5]], [0])
    assert np.isinf(distances[3:]).all()
    assert np.isfinite(distances[:3]).all()


def test_no_vertex_of_the_lips_is_on_the_wrong_side():
    # truth: the lower lip drops by more than 15 mm when the jaw opens, the upper by less than 8
    head = bundled_head()
    jaw = -bundled_morph_mm("jawOpen")[:, 1]
    side = lower_side(head)
    lips = [head.markers[n] for n in (*UPPER_LIP, *LOWER_LIP)]
    near = geodesic_mm(head.vertices_mm, head.faces, lips) < 9.0
    clear = near & (np.abs(head.vertices_mm[:, 0]) < 20.0)
    assert clear.sum() > 150
    assert np.array_equal(side[clear] == 1.0, jaw[clear] > 12.0)
    assert np.array_equal(side[clear] == 0.0, jaw[clear] < 12.0)


@pytest.mark.parametrize("name", list(CHARACTERS))
def test_lip_markers_are_wholly_on_their_own_side(name):
    head = bundled_head(name)
    side = lower_side(head)
    assert (side[[head.markers[n] for n in UPPER_LIP]] == 0).all()
    assert (side[[head.markers[n] for n in LOWER_LIP]] == 1).all()
    assert (side[head.lip_pairs[:, 0]] == 0).all()
    assert (side[head.lip_pairs[:, 1]] == 1).all()
    assert side.min() == 0
    assert side.max() == 1


def test_without_lip_markers_everything_is_upper():
    points, quads = grid_quads(2)
    mesh = Mesh("sheet", points, triangles(quads), np.zeros(9, np.int8))
    assert not lower_side(mesh).any()
    assert not skin_regions(mesh).any()
    with pytest.raises(MeshError, match="no lip pairs"):
        signed_lip_aperture_mm(points, mesh)


@pytest.mark.parametrize("name", list(CHARACTERS))
def test_regions_tell_the_inside_of_the_mouth_from_lips_and_face(name):
    head = bundled_head(name)
    region = skin_regions(head)
    assert 150 < (region == SkinRegion.LIPS).sum() < 250
    assert 400 < (region == SkinRegion.MOUTH).sum() < 500
    assert not region[~head.part_mask("skin")].any()
    behind = head.vertices_mm[region == SkinRegion.MOUTH, 2].max()
    assert behind < head.vertices_mm[region == SkinRegion.LIPS, 2].max()
    assert region[head.markers["nose2"]] == SkinRegion.FACE
    assert region[head.markers["lip_in2"]] == SkinRegion.LIPS


@given(st.floats(-2.0, 2.0))
def test_aperture_is_signed_and_measured_along_up(gap):
    head = bundled_head()
    moved = head.vertices_mm.copy()
    moved[head.lip_pairs[:, 0], 1] += gap
    moved[head.lip_pairs[:, 0], 0] += 1.0
    np.testing.assert_allclose(signed_lip_aperture_mm(moved, head), [gap], atol=1e-9)
    np.testing.assert_allclose(signed_lip_aperture_mm(moved[None].repeat(2, 0), head), [gap, gap], atol=1e-9)


def test_closing_moves_nothing_far_from_the_lips():
    head = bundled_head()
    opened = head.vertices_mm + 0.05 * bundled_morph_mm("jawOpen")
    closed = close_lips(opened, head.faces, head.lip_pairs, reach_mm=6.0)
    moved = np.abs(closed - opened).max(axis=1) > 0
    distance = geodesic_mm(opened, head.faces, head.lip_pairs.ravel())
    assert moved.any()
    assert distance[moved].max() < 6.0
    assert abs(signed_lip_aperture_mm(closed, head)[0]) < 1e-9
