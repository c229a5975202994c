"""Bezier triangles: C1 however the markers move, affine in them, on the right lip, exact."""

import functools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from corpus_tools.core import Mesh, MeshError
from corpus_tools.mesh import (
    CHARACTERS,
    CONTROL_POINTS,
    bind_bid,
    bind_linear,
    bundled_head,
    bundled_morph_mm,
    open_mouth_chart,
    signed_lip_aperture_mm,
    triangles,
)
from corpus_tools.mesh import kernel as kernel_module
from corpus_tools.mesh.attachment import frames_at, nearest_on_patches
from corpus_tools.mesh.patches import bernstein, gradients, linear_net, smooth_net, tangent_rows

seeds = st.integers(0, 2**16)


@functools.cache
def bound(character="base", bind=bind_bid):
    mesh = bundled_head(character)
    return bind(mesh, tuple(mesh.markers))


@functools.cache
def shared_edges(character):
    """Edges that two patches share: patches and barycentric coordinates of five places on either side."""
    chart = bound(character).surface.chart
    n, edges = len(chart.vertices), {}
    for patch in range(3 * len(chart.triangles)):
        t, k = chart.triangles[patch // 3], patch % 3
        corners = [int(t[k]), int(t[(k + 1) % 3]), n + patch // 3]
        for a, b in ((0, 1), (1, 2), (2, 0)):
            a, b = sorted((a, b), key=lambda i: corners[i])
            edges.setdefault((corners[a], corners[b]), []).append((patch, a, b))
    pairs = [e for e in edges.values() if len(e) == 2]
    assert len(pairs) > 500
    u, sides = np.linspace(0.05, 0.95, 5), []
    for side in (0, 1):
        bary = np.zeros((len(pairs), 5, 3))
        for row, edge in enumerate(pairs):
            bary[row, :, edge[side][1]], bary[row, :, edge[side][2]] = 1 - u, u
        sides.append((np.repeat([e[side][0] for e in pairs], 5), bary.reshape(-1, 3)))
    return sides


def jumps(character, markers):
    """Largest gap, mm, and largest angle between normals, degrees, across all shared edges."""
    control = bound(character).surface.control_mm(markers)
    (p0, _, _, n0), (p1, _, _, n1) = (
        frames_at(control[patch], bary) for patch, bary in shared_edges(character)
    )
    angle = np.degrees(np.arctan2(np.linalg.norm(np.cross(n0, n1), axis=1), (n0 * n1).sum(axis=1)))
    return np.abs(p0 - p1).max(), angle.max()


class TestSurface:
    @pytest.mark.parametrize("character", list(CHARACTERS))
    def test_is_smooth_at_rest_and_with_the_mouth_open(self, character):
        b = bound(character)
        at = [b.mesh.markers[n] for n in b.names]
        for pose in (b.rest_mm, b.rest_mm + 0.5 * bundled_morph_mm("jawOpen")[at]):
            gap, angle = jumps(character, pose)
            assert gap < 1e-9
            assert angle <= 1e-4

    @settings(max_examples=40)
    @given(seed=seeds, size=st.floats(0.1, 4.0))
    def test_is_smooth_however_the_markers_move(self, seed, size):
        rest = bound().rest_mm
        gap, angle = jumps("base", rest + np.random.default_rng(seed).normal(0, size, rest.shape))
        assert gap < 1e-9
        assert angle <= 1e-4

    def test_flat_triangles_are_not_smooth(self):
        surface = bound(bind=bind_linear).surface
        (patch, bary), (other, bary2) = shared_edges("base")
        control = surface.control_rest_mm
        cosine = (frames_at(control[patch], bary)[3] * frames_at(control[other], bary2)[3]).sum(axis=1)
        assert np.degrees(np.arccos(cosine.min())) > 5

    @pytest.mark.parametrize("net", [smooth_net, linear_net])
    def test_rows_sum_to_one(self, net):
        chart = bound().surface.chart
        np.testing.assert_allclose(net(chart).sum(axis=1), 1.0, atol=1e-12)

    def test_gradients_of_a_plane_are_exact(self):
        chart = bound().surface.chart
        values = chart.points_mm @ [2.0, -3.0] + 5.0
        np.testing.assert_allclose(
            gradients(chart) @ values, np.outer([2.0, -3.0], np.ones(len(values))), atol=1e-9
        )

    def test_a_marker_of_one_lip_never_looks_at_the_other(self):
        chart = bound().surface.chart
        slope = np.abs(gradients(chart)).sum(axis=0)
        assert not slope[np.ix_(chart.side > 0, chart.side < 0)].any()
        assert not slope[np.ix_(chart.corner, chart.side != 0)].any()

    @given(seed=seeds)
    def test_tangents_are_the_derivatives(self, seed):
        random = np.random.default_rng(seed)
        bary = random.dirichlet(np.ones(3), 4)
        for rows, step in zip(tangent_rows(bary), ([1, 0, -1], [0, 1, -1]), strict=True):
            h = 1e-5 * np.array(step)
            numeric = (bernstein(bary + h) - bernstein(bary - h)) / 2e-5
            np.testing.assert_allclose(rows, numeric, atol=1e-7)
        np.testing.assert_allclose(bernstein(bary).sum(axis=1), 1.0)
        assert CONTROL_POINTS.sum(axis=1).tolist() == [3] * 10


class TestChart:
    @pytest.mark.parametrize("character", list(CHARACTERS))
    def test_uses_every_marker_and_never_joins_the_lips(self, character):
        chart = bound(character).surface.chart
        assert set(chart.triangles.ravel()) == set(range(len(chart.vertices)))
        corners = chart.side[chart.triangles]
        assert not ((corners > 0).any(axis=1) & (corners < 0).any(axis=1)).any()
        a, b, c = chart.points_mm[chart.triangles].transpose(1, 0, 2)
        assert ((b - a)[:, 0] * (c - a)[:, 1] > (b - a)[:, 1] * (c - a)[:, 0]).all()

    def test_the_mouth_is_a_hole(self):
        b = bound()
        ring = [b.names.index(f"lip_in{i}") for i in range(8)]
        within = np.isin(b.surface.chart.triangles, ring).all(axis=1)
        assert not within.any()

    def test_markers_on_a_line_are_refused(self):
        line = np.stack([np.zeros(9), np.arange(9.0), np.zeros(9)], axis=1)
        points = np.concatenate([line, line + np.array([1.0, 0.0, 0.0])])
        part, markers = np.zeros(18, np.int8), {f"m{i}": i for i in range(9)}
        mesh = Mesh("line", points, triangles([[0, 1, 10]]), part, markers=markers)
        with pytest.raises(MeshError, match="span no surface"):
            open_mouth_chart(mesh, tuple(mesh.markers))

    def test_a_layout_without_inner_lips_still_opens_the_mouth(self):
        mesh = bundled_head()
        names = tuple(n for n in mesh.markers if not n.startswith("lip_in"))
        b = bind_bid(mesh, names)
        at = [mesh.markers[n] for n in names]
        frame = b.apply((b.rest_mm + 0.5 * bundled_morph_mm("jawOpen")[at])[None])
        assert signed_lip_aperture_mm(frame, mesh)[0] > 4


class TestAttachment:
    @given(seed=seeds)
    def test_finds_the_nearest_place(self, seed):
        control = bound().surface.control_rest_mm
        n = 3 * len(bound().surface.chart.triangles)
        random = np.random.default_rng(seed)
        patches = random.integers(0, n, 100)
        point, _, _, normal = frames_at(control[patches], random.dirichlet(np.ones(3), 100))
        allowed = np.arange(len(control)) < n
        found, bary = nearest_on_patches(point + 0.5 * normal, control, allowed)
        place = frames_at(control[found], bary)[0]
        distance = np.linalg.norm(place - point - 0.5 * normal, axis=1)
        # where the surface folds upon itself the search may end beside the best place
        assert np.quantile(distance, 0.9) <= 0.5 + 1e-6
        assert distance.max() < 1.5

    @pytest.mark.parametrize("bind", [bind_bid, bind_linear])
    @given(seed=seeds)
    def test_skin_follows_a_rigid_motion_of_its_markers(self, bind, seed):
        b = bound(bind=bind)
        turn, shift = Rotation.random(rng=seed).as_matrix(), np.array([3.0, -5.0, 9.0])
        own = own_vertices(b)
        frame = b.apply((b.rest_mm @ turn.T + shift)[None], {}, np.float64)[0]
        np.testing.assert_allclose(frame[own], b.mesh.vertices_mm[own] @ turn.T + shift, atol=1e-9, rtol=0)

    def test_deformed_skin_follows_a_rigid_motion_too(self):
        b, own = bound(), own_vertices(bound())
        turn = Rotation.from_euler("xyz", [20, -30, 10], degrees=True).as_matrix()
        pose = b.rest_mm + np.random.default_rng(1).normal(0, 2, b.rest_mm.shape)
        still, turned = b.apply(np.stack([pose, pose @ turn.T]), {}, np.float64)
        np.testing.assert_allclose(turned[own], still[own] @ turn.T, atol=1e-9, rtol=0)

    def test_the_angle_rule_can_be_had(self):
        mesh = bundled_head()
        by_angle = bind_bid(mesh, tuple(mesh.markers), attachment="angle", angle_deg=60.0)
        exact = by_angle.apply(by_angle.rest_mm[None], {}, np.float64)[0]
        assert np.abs(exact - mesh.vertices_mm).max() <= 1e-9
        assert (by_angle.attachment.patch != bound().attachment.patch).any()
        with pytest.raises(MeshError, match="'side' or 'angle'"):
            bind_bid(mesh, tuple(mesh.markers), attachment="nearest")


def own_vertices(b):
    """Vertices that move in full, on patches in which no still point has a share."""
    a, surface = b.attachment, b.surface
    by_markers = (surface.net @ b.rest_mm).reshape(-1, 10, 3)
    free = np.abs(by_markers - surface.control_rest_mm).max(axis=(1, 2)) < 1e-9
    own = a.vertices[(a.weight == 1) & free[a.patch]]
    assert len(own) > 50
    return own


class TestKernel:
    @given(seed=seeds, n=st.integers(1, 40))
    def test_is_equation_three_written_out(self, seed, n):
        b, a = bound(), bound().attachment
        poses = b.rest_mm + np.random.default_rng(seed).normal(0, 3, (n, *b.rest_mm.shape))
        rest = b.mesh.vertices_mm[a.vertices]
        point, t1, t2, normal = frames_at(b.surface.control_mm(poses[-1])[a.patch], a.bary)
        place = point + a.offset[:, :1] * t1 + a.offset[:, 1:2] * t2 + a.offset[:, 2:] * normal
        wanted = rest + a.weight[:, None] * (place - rest)
        np.testing.assert_allclose(b.skin_mm(poses, np.float64)[-1], wanted, atol=1e-9, rtol=0)
        assert np.abs(b.skin_mm(poses)[-1] - wanted).max() < 2e-4

    @given(seed=seeds)
    def test_rise_is_the_derivative_at_rest(self, seed):
        b = bound()
        vertices = b.mesh.lip_pairs.ravel()
        push = np.random.default_rng(seed).normal(0, 1, b.rest_mm.shape)
        h = 1e-4
        up, down = b.apply(b.rest_mm + h * np.stack([push, -push]), {}, np.float64)[:, vertices, 1]
        linear = np.tensordot(b.rise(vertices), push, axes=([1, 2], [0, 1]))
        np.testing.assert_allclose(linear, (up - down) / (2 * h), atol=1e-5)

    def test_works_where_no_cache_can_be_written(self, monkeypatch):
        import numba

        real = numba.njit

        def njit(**options):
            if options.get("cache"):
                raise RuntimeError("cannot cache function: no locator available")
            return real(**options)

        monkeypatch.setattr(numba, "njit", njit)
        kernel_module._compiled.cache_clear()
        try:
            assert callable(kernel_module._compiled())
        finally:
            monkeypatch.undo()
            kernel_module._compiled.cache_clear()
