"""The retargeter: neutral to rest, wrong input, lips without a response, speed."""

import numpy as np
import pytest

from corpus_tools.core import MeshError
from corpus_tools.mesh import bundled_head
from corpus_tools.retarget import WARP_KERNELS, prepare_retarget, retarget


@pytest.fixture(scope="module")
def ready():
    child, base = bundled_head("child"), bundled_head("base")
    names = tuple(base.markers)
    return prepare_retarget(child.vertices_mm[[child.markers[n] for n in names]], names, base)


@pytest.mark.parametrize("kernel", list(WARP_KERNELS))
@pytest.mark.parametrize("smoothing", [0.0, 1e-2, 1.0])
def test_neutral_lands_on_rest_whatever_the_warp(kernel, smoothing):
    actor, mesh = bundled_head("male"), bundled_head("cartoon")
    names = tuple(mesh.markers)
    neutral = actor.vertices_mm[[actor.markers[n] for n in names]]
    found = retarget(neutral[None], names, neutral, mesh, kernel=kernel, smoothing=smoothing)[0]
    np.testing.assert_allclose(found, mesh.vertices_mm[[mesh.markers[n] for n in names]], atol=1e-8)


def test_some_of_the_markers_will_do():
    actor, mesh = bundled_head("male"), bundled_head("base")
    names = tuple(n for n in mesh.markers if not n.startswith("lip_in"))
    neutral = actor.vertices_mm[[actor.markers[n] for n in names]]
    assert retarget(neutral[None] + 1.0, names, neutral, mesh).shape == (1, len(names), 3)


def test_without_a_response_the_inner_lip_markers_are_kept_apart(ready):
    frame = ready.neutral_mm.copy()
    upper, lower = ready.names.index("lip_in2"), ready.names.index("lip_in6")
    frame[upper, 1] -= 4.0
    out = ready(frame[None])[0]
    assert out[upper, 1] - out[lower, 1] > -0.03 * 4.0
    free = prepare_retarget(ready.neutral_mm, ready.names, bundled_head("base"), contact=False)(frame[None])[
        0
    ]
    assert free[upper, 1] - free[lower, 1] < -3


def test_the_warp_of_every_character_is_free_of_folds():
    child = bundled_head("child")
    names = tuple(child.markers)
    neutral = child.vertices_mm[[child.markers[n] for n in names]]
    for character in ("base", "male", "female", "elder", "baby", "cartoon"):
        assert prepare_retarget(neutral, names, bundled_head(character)).folds().least_det > 0, character


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (np.zeros((2, 65, 3)), r"\(frames, 66, 3\) was expected"),
        (np.zeros((66, 3)), r"\(frames, 66, 3\) was expected"),
    ],
)
def test_motion_of_another_shape_is_refused(ready, values, words):
    with pytest.raises(MeshError, match=words):
        ready(values)


def test_markers_the_mesh_does_not_have_are_named():
    with pytest.raises(MeshError, match="no vertex for the marker 'wing0'"):
        prepare_retarget(np.eye(5, 3), ("nose0", "nose1", "nose2", "nose3", "wing0"), bundled_head())


def test_a_response_of_another_shape_is_refused(ready):
    with pytest.raises(MeshError, match=r"\(pairs, 66, 3\) was expected"):
        prepare_retarget(ready.neutral_mm, ready.names, bundled_head(), lip_response=np.zeros((9, 3)))
