"""The neck of a head in pictures: a level edge below the face, and nothing else moved."""

from dataclasses import replace

import numpy as np
import pytest

from corpus_tools.mesh import CHARACTERS, bundled_head, level_neck, neck_rim, with_level_neck


@pytest.mark.parametrize("name", list(CHARACTERS))
def test_only_the_rim_moves_and_straight_down_to_one_level(name):
    head = bundled_head(name)
    drawn, rim = level_neck(head), neck_rim(head)
    moved = drawn.vertices_mm - head.vertices_mm
    rest = np.setdiff1d(np.arange(head.n_vertices), rim)
    assert len(rim) > 20
    assert not moved[rest].any()
    assert not moved[:, [0, 2]].any()
    assert (moved[rim, 1] < 0).all()
    assert np.ptp(drawn.vertices_mm[rim, 1]) < 1e-9
    assert drawn.vertices_mm[rim, 1].max() < drawn.vertices_mm[rest, 1].min()
    assert not set(rim.tolist()) & set(head.markers.values())


def test_a_skin_that_is_open_at_the_face_only_stays_as_it_is():
    head = bundled_head()
    marked_y = head.vertices_mm[list(head.markers.values()), 1]

    def cut_at(share):
        """Return what lies above a height between the lowest and the highest marker."""
        low = marked_y.min() + share * np.ptp(marked_y)
        return replace(head, faces=head.faces[(head.vertices_mm[head.faces][:, :, 1] > low).all(axis=1)])

    through_the_face = cut_at(0.5)
    assert len(neck_rim(through_the_face)) == 0
    assert level_neck(through_the_face) is through_the_face
    assert len(neck_rim(cut_at(-0.1))) > 20
    bare = replace(head, markers={})
    assert level_neck(bare) is bare


def test_a_pose_keeps_everything_but_the_rim():
    mesh = bundled_head()
    pose = mesh.vertices_mm + np.random.default_rng(0).normal(size=mesh.vertices_mm.shape)
    drawn, rim = with_level_neck(mesh, pose), neck_rim(mesh)
    others = np.setdiff1d(np.arange(mesh.n_vertices), rim)
    np.testing.assert_array_equal(drawn[others], pose[others])
    assert np.ptp(drawn[rim, 1]) == 0
    assert drawn[rim, 1].max() < mesh.vertices_mm[rim, 1].min()
