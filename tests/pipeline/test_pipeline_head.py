"""Binding a head to a corpus: rest stays rest, lips part, and what cannot be bound says why."""

import dataclasses

import numpy as np
import pytest

from corpus_tools.config import Config, config_with
from corpus_tools.core import InputError, MeshError, Trajectory
from corpus_tools.mesh import CHARACTERS, bundled_head, signed_lip_aperture_mm
from corpus_tools.pipeline import animate, prepare_head, vertex_frames


@pytest.fixture(scope="module")
def head(opened_corpus):
    return prepare_head(opened_corpus, "base", Config())


def still(corpus, poses):
    """Return a trajectory that shows poses, one a frame."""
    poses = np.asarray(poses)
    return Trajectory(np.arange(len(poses)) / 120.0, poses, corpus.markers)


@pytest.mark.parametrize("name", CHARACTERS)
def test_the_neutral_pose_leaves_any_head_at_rest(opened_corpus, name):
    head = prepare_head(opened_corpus, name, Config())
    animation = animate(head, still(opened_corpus, [opened_corpus.neutral_mm] * 2))
    vertices = vertex_frames(head, animation)
    assert vertices.dtype == np.float32
    assert np.abs(vertices - head.mesh.vertices_mm).max() < 0.75
    for part, matrices in animation.rigid.items():
        np.testing.assert_allclose(
            matrices, np.broadcast_to(np.eye(4), matrices.shape), atol=0.5, err_msg=part
        )


def test_an_open_pose_of_the_actor_opens_the_mesh(opened_corpus, head):
    recording = opened_corpus.recordings[0]
    frames = np.asarray(recording.capture.positions_mm)
    aperture = np.einsum("fmk,mk->f", frames, opened_corpus.lips.functional)
    wide, shut = frames[np.argmax(aperture)], frames[np.argmin(aperture)]
    vertices = vertex_frames(head, animate(head, still(opened_corpus, [shut, wide])))
    on_mesh = signed_lip_aperture_mm(vertices, head.mesh)
    assert on_mesh[1] > on_mesh[0] + 5.0
    assert on_mesh[0] > -0.5


def test_markers_are_matched_by_name_whatever_their_order(opened_corpus, head):
    frames = np.asarray(opened_corpus.recordings[0].capture.positions_mm)[:40:10]
    order = np.random.default_rng(0).permutation(len(opened_corpus.markers))
    shuffled = Trajectory(
        np.arange(4) / 12.0, frames[:, order], tuple(opened_corpus.markers[i] for i in order)
    )
    one, two = animate(head, still(opened_corpus, frames)), animate(head, shuffled)
    np.testing.assert_array_equal(one.targets_mm, two.targets_mm)


def test_a_mesh_may_be_given_itself(opened_corpus, head):
    given = prepare_head(opened_corpus, bundled_head("base"), Config())
    frames = still(opened_corpus, np.asarray(opened_corpus.recordings[0].capture.positions_mm)[100:103])
    np.testing.assert_array_equal(animate(given, frames).targets_mm, animate(head, frames).targets_mm)


@pytest.mark.parametrize(("n", "works"), [(7, False), (8, True)])
def test_a_mesh_that_shares_too_few_markers_is_refused(opened_corpus, n, works):
    whole = bundled_head("base")
    names = [f"lip_out{i}" for i in range(n)]
    few = dataclasses.replace(whole, markers={k: whole.markers[k] for k in names})
    if works:
        assert prepare_head(opened_corpus, few, Config()).names == tuple(
            m for m in opened_corpus.markers if m in names
        )
    else:
        with pytest.raises(MeshError, match=r"share 7 markers of 66.*at least 8"):
            prepare_head(opened_corpus, few, Config())


def test_an_unknown_mesh_is_refused(opened_corpus):
    with pytest.raises(MeshError, match="femal"):
        prepare_head(opened_corpus, "femal", Config())


def test_a_file_that_is_no_mesh_is_refused(opened_corpus, tmp_path):
    path = tmp_path / "head.npz"
    path.write_bytes(b"no mesh at all")
    with pytest.raises(MeshError, match=r"head\.npz"):
        prepare_head(opened_corpus, str(path), Config())


@pytest.mark.parametrize(("key", "value"), [("deform__deformer", "rbff"), ("retarget__kernel", "cubicc")])
def test_unknown_methods_are_refused_with_a_suggestion(opened_corpus, key, value):
    with pytest.raises(InputError, match=rf"{value}.*{value[:-1]}"):
        prepare_head(opened_corpus, "base", config_with(Config(), **{key: value}))


def test_retarget_settings_are_used(opened_corpus, head):
    frames = still(opened_corpus, np.asarray(opened_corpus.recordings[0].capture.positions_mm)[150:160])
    for change in ({"retarget__smoothing": 10.0}, {"retarget__kernel": "multiquadric"}):
        other = prepare_head(opened_corpus, "base", config_with(Config(), **change))
        difference = np.abs(animate(other, frames).targets_mm - animate(head, frames).targets_mm).max()
        assert 1e-4 < difference < 10.0, change
