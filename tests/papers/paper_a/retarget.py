"""Paper A section 6: a mapping f: R3 -> R3 by RBFs between the neutral pose and the target mesh."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from corpus_tools.mesh import CHARACTERS, DEFORMERS, bundled_head, bundled_morph_mm, signed_lip_aperture_mm
from corpus_tools.retarget import fit_volume_warp, prepare_retarget, retarget

seeds = st.integers(0, 2**16)


@pytest.fixture(scope="module")
def actor():
    """The bundled child as the actor, speaking with the face units of the head: simulated motion."""
    mesh = bundled_head("child")
    names = tuple(mesh.markers)
    at = [mesh.markers[n] for n in names]
    neutral = mesh.vertices_mm[at]
    jaw, pucker = 0.4 * bundled_morph_mm("jawOpen")[at], 0.8 * bundled_morph_mm("mouthPucker")[at]
    u = np.linspace(0, 1, 9)[:, None, None]
    return names, neutral, neutral + np.concatenate([u * jaw, u * pucker])


@pytest.mark.parametrize("character", list(CHARACTERS))
def test_the_warp_maps_the_neutral_pose_to_the_target_mesh(actor, character):
    names, neutral, _ = actor
    mesh = bundled_head(character)
    rest = mesh.vertices_mm[[mesh.markers[n] for n in names]]
    np.testing.assert_allclose(fit_volume_warp(neutral, rest, smoothing=0.0)(neutral), rest, atol=1e-6)
    # smoothed for playback, the neutral pose still lands on the mesh exactly
    np.testing.assert_allclose(retarget(neutral[None], names, neutral, mesh)[0], rest, atol=1e-9)


@given(seed=seeds, scale=st.floats(0.2, 5))
def test_a_mesh_may_vary_in_scale_and_orientation(actor, seed, scale):
    names, neutral, motion = actor
    mesh = bundled_head("elder")
    rest = mesh.vertices_mm[[mesh.markers[n] for n in names]]
    rotation = Rotation.from_rotvec(np.random.default_rng(seed).normal(0, 2, 3)).as_matrix()
    one = fit_volume_warp(neutral, rest)(motion)
    other = fit_volume_warp(neutral, scale * rest @ rotation.T + 7.0)(motion)
    np.testing.assert_allclose(other, scale * one @ rotation.T + 7.0, atol=1e-5)


@given(seed=seeds)
def test_where_the_actor_stands_and_how_large_he_is_does_not_matter(actor, seed):
    names, neutral, motion = actor
    mesh = bundled_head("female")
    rng = np.random.default_rng(seed)
    rotation = Rotation.from_rotvec(rng.normal(0, 2, 3)).as_matrix()
    shift, scale = rng.normal(0, 300, 3), rng.uniform(0.3, 3)
    one = retarget(motion, names, neutral, mesh, smoothing=0.0)
    other = retarget(
        scale * motion @ rotation.T + shift, names, scale * neutral @ rotation.T + shift, mesh, smoothing=0.0
    )
    np.testing.assert_allclose(other, one, atol=1e-4)


def test_frames_are_retargetted_relative_to_the_neutral_pose(actor):
    names, neutral, motion = actor
    mesh = bundled_head("base")
    ready = prepare_retarget(neutral, names, mesh, contact=False)
    expected = ready.rest_mm + ready.warp(motion) - ready.warp(neutral)
    np.testing.assert_allclose(ready(motion), expected, atol=1e-9)


@pytest.mark.parametrize("character", ["base", "elder", "cartoon"])
def test_one_capture_opens_and_rounds_the_mouth_of_every_character(actor, character):
    names, neutral, motion = actor
    mesh = bundled_head(character)
    binding = DEFORMERS["bid"](mesh, names)
    ready = prepare_retarget(neutral, names, mesh, lip_response=binding.lip_response())
    assert ready.folds().n_folded == 0
    vertices = binding.apply(ready(motion))
    aperture = signed_lip_aperture_mm(vertices, mesh)
    assert (np.diff(aperture[:9]) > 0).all()
    assert aperture[8] > 3
    width = vertices[:, mesh.markers["lip_out6"], 0] - vertices[:, mesh.markers["lip_out0"], 0]
    assert width[17] < 0.95 * width[9]


def test_characters_keep_their_own_shape(actor):
    names, neutral, motion = actor
    results = {c: retarget(motion, names, neutral, bundled_head(c)) for c in ("base", "baby", "cartoon")}
    width = {c: float(np.ptp(r[0, :, 0])) for c, r in results.items()}
    assert width["baby"] < width["base"] < width["cartoon"]
    moved = {c: float(np.abs(r[8] - r[0]).max()) for c, r in results.items()}
    assert moved["baby"] < moved["base"] < moved["cartoon"]


def test_the_lips_move_entirely_independently(actor):
    names, _, _ = actor
    mesh = bundled_head("base")
    binding = DEFORMERS["bid"](mesh, names)
    targets = binding.rest_mm.copy()
    lower = [i for i, n in enumerate(names) if n in ("lip_in5", "lip_in6", "lip_in7", "lip_out8", "lip_out9")]
    targets[lower, 1] -= 8.0
    frame = binding.apply(targets[None])[0]
    upper = mesh.lip_pairs[:, 0]
    np.testing.assert_allclose(frame[upper], mesh.vertices_mm[upper], atol=1e-3)
    assert signed_lip_aperture_mm(frame, mesh)[0] > 3


@given(seed=seeds)
def test_closed_lips_never_pass_through_each_other(actor, seed):
    names, neutral, _ = actor
    mesh = bundled_head("base")
    binding = _binding(names)
    ready = prepare_retarget(neutral, names, mesh, lip_response=binding.lip_response())
    pressed = neutral + np.random.default_rng(seed).normal(0, 0.4, (5, *neutral.shape))
    pressed[:, [i for i, n in enumerate(names) if n in ("lip_in5", "lip_in6", "lip_in7")], 1] += 2.0
    frames = binding.apply(ready(pressed))
    assert signed_lip_aperture_mm(frames, mesh).min() > -0.1
    pairs = frames[:, mesh.lip_pairs[:, 0], 1] - frames[:, mesh.lip_pairs[:, 1], 1]
    assert pairs.min() > -0.3


_BINDINGS = {}


def _binding(names):
    if names not in _BINDINGS:
        _BINDINGS[names] = DEFORMERS["bid"](bundled_head("base"), names)
    return _BINDINGS[names]
