"""The deformer and the jaw: exact at markers, lips apart, still where nothing moves, near real face units."""

import functools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from corpus_tools.core import InputError, MeshError
from corpus_tools.mesh import (
    CHARACTERS,
    DEFORMERS,
    DISPLACEMENT_KERNELS,
    LOWER_LIP,
    STILL_MARKERS,
    UPPER_LIP,
    SkinRegion,
    bundled_head,
    bundled_morph_mm,
    displacement_basis,
    edges_of,
    geodesic_mm,
    jaw_hinge_mm,
    jaw_motion,
    signed_lip_aperture_mm,
    skin_regions,
    vertex_normals,
)

UNITS = {
    "jawOpen": (("jawOpen",), 0.5),
    "funnel": (("mouthFunnel",), 1.0),
    "pucker": (("mouthPucker",), 1.0),
    "smile": (("mouthSmileLeft", "mouthSmileRight"), 1.0),
    "stretch": (("mouthStretchLeft", "mouthStretchRight"), 1.0),
    "left": (("mouthLeft",), 1.0),
}


@pytest.fixture(scope="module")
def head():
    return bundled_head()


@pytest.fixture(scope="module")
def names(head):
    return tuple(head.markers)


@pytest.fixture(scope="module")
def binding():
    return bound_head("rbf", "base")[1]


def unit_mm(key):
    parts, amount = UNITS[key]
    return amount * sum(bundled_morph_mm(p) for p in parts)


@functools.cache
def bound_head(deformer, character):
    """A bundled head and its binding, made once."""
    mesh = bundled_head(character)
    return mesh, DEFORMERS[deformer](mesh, tuple(mesh.markers))


@pytest.mark.parametrize("deformer", list(DEFORMERS))
@pytest.mark.parametrize("character", list(CHARACTERS))
class TestEveryDeformer:
    """Laws of every entry of the registry, on every head."""

    def test_rest_stays_rest(self, deformer, character):
        mesh, bound = bound_head(deformer, character)
        frame = bound.apply(bound.rest_mm[None])
        assert frame.dtype == np.float32
        np.testing.assert_allclose(frame[0], mesh.vertices_mm, atol=2e-4)
        exact = bound.apply(bound.rest_mm[None], dtype=np.float64)
        assert np.abs(exact[0] - mesh.vertices_mm).max() <= 1e-9

    def test_marker_vertices_follow_their_markers_exactly(self, deformer, character):
        mesh, bound = bound_head(deformer, character)
        moving = [i for i, n in enumerate(bound.names) if n not in STILL_MARKERS]
        at = [mesh.markers[bound.names[i]] for i in moving]
        shift = np.random.default_rng(3).normal(0, 4, (len(bound.names), 3))
        frame = bound.apply((bound.rest_mm + shift)[None], {}, np.float64)[0]
        np.testing.assert_allclose(frame[at] - mesh.vertices_mm[at], shift[moving], atol=1e-6)

    def test_lips_never_pull_on_each_other(self, deformer, character):
        mesh, bound = bound_head(deformer, character)
        columns = {side: [bound.names.index(n) for n in side] for side in (UPPER_LIP, LOWER_LIP)}
        assert not bound.rise(mesh.lip_pairs[:, 0])[:, columns[LOWER_LIP]].any()
        assert not bound.rise(mesh.lip_pairs[:, 1])[:, columns[UPPER_LIP]].any()
        assert np.abs(bound.lip_response()).max() > 0.5

    def test_no_vertex_of_the_lips_follows_the_wrong_one(self, deformer, character):
        mesh, bound = bound_head(deformer, character)
        truth = 0.5 * bundled_morph_mm("jawOpen")
        at = [mesh.markers[n] for n in bound.names]
        moved = bound.apply((bound.rest_mm + truth[at])[None], {}, np.float64)[0] - mesh.vertices_mm
        lips = skin_regions(mesh) == SkinRegion.LIPS
        least = truth[lips, 1].min()
        lower, upper = lips & (truth[:, 1] < 0.7 * least), lips & (truth[:, 1] > 0.25 * least)
        assert min(lower.sum(), upper.sum()) > 20
        assert not (moved[lower, 1] > 0.5 * least).any()
        assert not (moved[upper, 1] < 0.5 * least).any()

    @pytest.mark.parametrize(
        ("unit", "amount"), [("jawOpen", 0.5), ("mouthPucker", 1.0), ("mouthFunnel", 1.0)]
    )
    def test_nothing_tears(self, deformer, character, unit, amount):
        mesh, bound = bound_head(deformer, character)
        at = [mesh.markers[n] for n in bound.names]
        heights = [np.ptp(m.vertices_mm[at], axis=0).max() for m in (mesh, bundled_head())]
        shift = min(heights[0] / heights[1], 1.0) * amount * bundled_morph_mm(unit)[at]
        frame = bound.apply((bound.rest_mm + shift)[None], {}, np.float64)[0]
        edges = edges_of(mesh.faces[mesh.part_mask("skin")[mesh.faces].all(axis=1)])
        ends = [v[edges[:, 0]] - v[edges[:, 1]] for v in (mesh.vertices_mm, frame)]
        before, after = (np.linalg.norm(e, axis=1) for e in ends)
        assert np.abs(after - before).max() < 0.6 * np.linalg.norm(shift, axis=1).max() + 2.0
        assert ((after + 1.0) / (before + 1.0)).max() < 2.6

    def test_eyelids_and_everything_away_from_the_face_stay(self, deformer, character):
        mesh, bound = bound_head(deformer, character)
        shift = np.random.default_rng(4).normal(0, 4, (3, len(bound.names), 3))
        still = bound.apply(bound.rest_mm + shift, {}, np.float64) - mesh.vertices_mm
        eyes = cKDTree(mesh.vertices_mm[mesh.part_mask("eyes")])
        lids = mesh.part_mask("skin") & (eyes.query(mesh.vertices_mm)[0] < 6.9)
        lids[list(mesh.markers.values())] = False
        assert not still[:, lids].any()
        assert lids.sum() > 100
        for part in ("eyes", "upper_teeth", "lower_teeth", "tongue"):
            assert not still[:, mesh.part_mask(part)].any()


@pytest.mark.parametrize("kernel", list(DISPLACEMENT_KERNELS))
def test_only_the_face_moves(head, names, kernel):
    basis = displacement_basis(head, names, kernel)
    for part in ("eyes", "upper_teeth", "lower_teeth", "tongue"):
        assert not basis[head.part_mask(part)].any()
    assert not basis[head.vertices_mm[:, 2] < 0].any()
    neck = head.part_mask("skin") & (head.vertices_mm[:, 1] < 600)
    assert not basis[neck].any()
    ears = np.abs(head.vertices_mm[:, 0]) > 80
    assert not basis[ears].any()


def test_the_default_kernel_is_nearest_to_real_face_units(head, names):
    at = [head.markers[n] for n in names]
    normals = vertex_normals(head.vertices_mm, head.faces)
    seen = head.part_mask("skin") & (head.vertices_mm[:, 2] > 60) & (normals[:, 2] > 0)
    error = {}
    for kernel in DISPLACEMENT_KERNELS:
        basis = displacement_basis(head, names, kernel)
        parts = []
        for key in UNITS:
            truth = unit_mm(key)
            left = (basis @ truth[at] - truth)[seen]
            parts.append(np.sqrt((left**2).sum() / (truth[seen] ** 2).sum()))
        error[kernel] = float(np.mean(parts))
    assert min(error, key=error.get) == "thin-plate"
    assert error["thin-plate"] < 0.23


@pytest.mark.parametrize(
    ("unit", "bar_mm"),
    [
        ("jawOpen", 0.65),
        ("funnel", 0.66),
        ("pucker", 0.5),
        ("smile", 1.05),
        ("stretch", 0.52),
        ("left", 0.64),
    ],
)
def test_driven_by_a_face_unit_the_skin_follows_it(head, binding, unit, bar_mm):
    at = [head.markers[n] for n in binding.names]
    truth = unit_mm(unit)
    normals = vertex_normals(head.vertices_mm, head.faces)
    seen = head.part_mask("skin") & (head.vertices_mm[:, 2] > 60) & (normals[:, 2] > 0)
    left = (binding.response(np.arange(head.n_vertices)) @ truth[at] - truth)[seen]
    assert np.sqrt((left**2).sum(axis=1).mean()) < bar_mm


def test_lips_open_with_the_markers_of_jaw_open(head, binding):
    at = [head.markers[n] for n in binding.names]
    frames = binding.apply(
        binding.rest_mm + np.linspace(0, 0.5, 6)[:, None, None] * unit_mm("jawOpen")[at] * 2
    )
    aperture = signed_lip_aperture_mm(frames, head)
    truth = signed_lip_aperture_mm(head.vertices_mm + unit_mm("jawOpen"), head)[0]
    assert (np.diff(aperture) > 0.5).all()
    assert aperture[-1] == pytest.approx(truth, rel=0.15)


def test_motion_is_symmetric(head, binding):
    at = [head.markers[n] for n in binding.names]
    frame = binding.apply((binding.rest_mm + unit_mm("pucker")[at])[None])[0]
    mirrored = frame * [-1, 1, 1]
    skin = np.flatnonzero(head.part_mask("skin"))
    order = np.lexsort(np.round(head.vertices_mm[skin], 2).T)
    other = np.lexsort(np.round(head.vertices_mm[skin] * [-1, 1, 1], 2).T)
    difference = np.linalg.norm(frame[skin[order]] - mirrored[skin[other]], axis=1)
    assert np.median(difference) < 0.05
    assert difference.max() < 1.0


@given(seed=st.integers(0, 2**16))
def test_displacement_is_linear_in_the_markers(seed):
    mesh = bundled_head()
    bound = _bound()
    rng = np.random.default_rng(seed)
    a, b = rng.normal(0, 2, (2, len(bound.names), 3))
    still = {part: np.eye(4)[None] for part in ("lower_teeth", "tongue")}
    frames = [
        bound.apply((bound.rest_mm + d)[None], still)[0] - mesh.vertices_mm.astype(np.float32)
        for d in (a, b, a + b)
    ]
    np.testing.assert_allclose(frames[0] + frames[1], frames[2], atol=2e-3)


_CACHE = {}


def _bound():
    if not _CACHE:
        mesh = bundled_head()
        _CACHE["rbf"] = DEFORMERS["rbf"](mesh, tuple(mesh.markers))
    return _CACHE["rbf"]


class TestJaw:
    def test_lower_teeth_follow_a_turned_chin_and_upper_teeth_stay(self, head, binding):
        hinge = jaw_hinge_mm(head).mean(axis=0)
        angle = np.radians(6)
        turn = np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])
        targets = np.array(binding.rest_mm)
        chin = [i for i, n in enumerate(binding.names) if n.startswith("chin")]
        targets[chin] = (targets[chin] - hinge) @ turn.T + hinge
        motion = binding.rigid(targets[None])
        assert set(motion) == {"lower_teeth", "tongue"}
        np.testing.assert_allclose(motion["lower_teeth"][0, :3, :3], turn, atol=1e-9)
        frame = binding.apply(targets[None])[0]
        teeth = head.part_mask("lower_teeth")
        expected = (head.vertices_mm[teeth] - hinge) @ turn.T + hinge
        np.testing.assert_allclose(frame[teeth], expected, atol=1e-3)
        upper = head.part_mask("upper_teeth")
        np.testing.assert_allclose(frame[upper], head.vertices_mm[upper], atol=1e-3)

    def test_follows_the_jaw_of_jaw_open(self, head, binding):
        at = [head.markers[n] for n in binding.names]
        truth = 0.3 * bundled_morph_mm("jawOpen")
        matrix = binding.rigid((head.vertices_mm + truth)[at][None])["lower_teeth"][0]
        teeth = head.part_mask("lower_teeth")
        moved = head.vertices_mm[teeth] @ matrix[:3, :3].T + matrix[:3, 3] - head.vertices_mm[teeth]
        error = np.sqrt(((moved - truth[teeth]) ** 2).sum(axis=1).mean())
        assert error < 0.25 * np.sqrt((truth[teeth] ** 2).sum(axis=1).mean())

    def test_one_wild_marker_hardly_moves_it(self, head, names):
        targets = np.array([head.vertices_mm[head.markers[n]] for n in names])[None]
        targets[0, names.index("chin4")] += [0, 9.0, 9.0]
        matrix = jaw_motion(targets, head, names)[0]
        teeth = head.vertices_mm[head.part_mask("lower_teeth")]
        assert np.abs(teeth @ matrix[:3, :3].T + matrix[:3, 3] - teeth).max() < 0.3

    @given(seed=st.integers(0, 2**16))
    def test_is_always_a_rotation(self, seed):
        mesh = bundled_head()
        names = tuple(mesh.markers)
        rest = np.array([mesh.vertices_mm[mesh.markers[n]] for n in names])
        noisy = rest + np.random.default_rng(seed).normal(0, 60, (4, *rest.shape))
        rotation = jaw_motion(noisy, mesh, names)[:, :3, :3]
        product = rotation @ rotation.transpose(0, 2, 1)
        np.testing.assert_allclose(product, np.broadcast_to(np.eye(3), product.shape), atol=1e-9)
        np.testing.assert_allclose(np.linalg.det(rotation), 1.0, atol=1e-9)

    def test_without_chin_markers_the_jaw_stands_still(self, head):
        np.testing.assert_array_equal(jaw_motion(np.zeros((2, 1, 3)), head, ("nose2",)), [np.eye(4)] * 2)


class TestErrors:
    def test_unknown_marker(self, head):
        with pytest.raises(MeshError, match="no vertex for the marker 'tail0'"):
            DEFORMERS["rbf"](head, ("nose2", "tail0"))

    def test_wrong_number_of_targets(self, binding):
        with pytest.raises(MeshError, match=r"\(frames, 66, 3\) was expected"):
            binding.apply(np.zeros((2, 65, 3)))

    def test_unknown_deformer(self):
        with pytest.raises(InputError, match="did you mean 'rbf'"):
            DEFORMERS["rbff"]


def test_a_layout_without_inner_lips_still_binds(head, names):
    fewer = tuple(n for n in names if not n.startswith("lip_in"))
    bound = DEFORMERS["rbf"](head, fewer)
    at = [head.markers[n] for n in fewer]
    frame = bound.apply((bound.rest_mm + unit_mm("jawOpen")[at])[None])
    assert signed_lip_aperture_mm(frame, head)[0] > 4
    assert geodesic_mm(head.vertices_mm, head.faces, at).min() == 0
