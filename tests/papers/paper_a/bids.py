"""Paper A section 6, equation (3): vertices on Bezier triangles, with an offset along the unit normal."""

import functools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.mesh import DEFORMERS, PatchBinding, bind_bid, bundled_head
from corpus_tools.mesh.attachment import frames_at


@functools.cache
def bound():
    mesh = bundled_head()
    return bind_bid(mesh, tuple(mesh.markers))


@given(seed=st.integers(0, 2**16))
def test_eq_3_a_vertex_is_the_point_of_its_patch_plus_d_times_the_unit_normal(seed):
    """ "Vdef = Bi(uV, vV) + dV ni(uV, vV)" """
    b, a = bound(), bound().attachment
    on_normal = np.flatnonzero((np.abs(a.offset[:, :2]).max(axis=1) < 0.02) & (a.weight == 1))
    pose = b.rest_mm + np.random.default_rng(seed).normal(0, 2, b.rest_mm.shape)
    point, t1, t2, normal = frames_at(b.surface.control_mm(pose)[a.patch[on_normal]], a.bary[on_normal])
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1.0)
    wanted = point + a.offset[on_normal, 2:] * normal
    slack = np.abs(a.offset[on_normal, :1] * t1 + a.offset[on_normal, 1:2] * t2)
    found = b.skin_mm(pose[None], np.float64)[0, on_normal]
    assert (np.abs(found - wanted) <= slack + 1e-9).all()
    assert len(on_normal) > 100


def test_eq_3_is_not_linear_in_the_markers():
    b = bound()
    shift = np.random.default_rng(0).normal(0, 3, b.rest_mm.shape)
    once, twice = (
        b.skin_mm(b.rest_mm + np.stack([shift, 2 * shift]), np.float64) - b.mesh.vertices_mm[b.driven]
    )
    assert np.abs(twice - 2 * once).max() > 0.1


def test_the_deformer_surface_is_a_triangulation_of_the_markers():
    """ "a triangulation of the motion captured points ... with continuity conditions at patch boundaries" """
    b = bound()
    chart = b.surface.chart
    used = np.unique(chart.triangles)
    assert set(range(len(b.names))) <= set(used.tolist())
    corners = b.surface.control_rest_mm[: 3 * len(chart.triangles) : 3, 0]
    np.testing.assert_allclose(corners, b.mesh.vertices_mm[chart.vertices[chart.triangles[:, 0]]], atol=1e-9)


def test_the_lips_move_entirely_independently_with_every_patch_deformer():
    """ "the movement of the lips which must be able to move entirely independently" """
    mesh = bundled_head()
    for name, bind in DEFORMERS.items():
        b = bind(mesh, tuple(mesh.markers))
        pose = b.rest_mm.copy()
        pose[[i for i, n in enumerate(b.names) if n in ("lip_in5", "lip_in6", "lip_in7")], 1] -= 8.0
        frame = b.apply(pose[None], {}, np.float64)[0]
        upper = mesh.lip_pairs[:, 0]
        np.testing.assert_allclose(frame[upper], mesh.vertices_mm[upper], atol=1e-9, err_msg=name)


def test_the_angle_threshold_is_the_papers_attachment():
    """ "thresholding the maximum angle allowed between the surface normals" """
    mesh = bundled_head()
    strict = bind_bid(mesh, tuple(mesh.markers), attachment="angle", angle_deg=45.0)
    loose = bind_bid(mesh, tuple(mesh.markers), attachment="angle", angle_deg=180.0)
    assert isinstance(strict, PatchBinding)
    n = min(len(strict.attachment.vertices), len(loose.attachment.vertices))
    assert (strict.attachment.patch[:n] != loose.attachment.patch[:n]).mean() == pytest.approx(0.05, abs=0.05)
