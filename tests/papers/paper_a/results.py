"""Paper A section 7, "Results": skin of the cheeks, jaw and tongue."""

import functools

import numpy as np
from scipy.spatial.distance import cdist
from scipy.spatial.transform import Rotation

from corpus_tools.mesh import DEFORMERS, bundled_head, bundled_morph_mm, skin_regions
from corpus_tools.mesh.regions import SkinRegion


@functools.cache
def bound():
    mesh = bundled_head()
    return DEFORMERS["bid"](mesh, tuple(mesh.markers))


def spoken(unit: str, amount: float):
    """Return the markers of a pose of the bundled head, and how its own shape moves every vertex."""
    b = bound()
    truth = amount * bundled_morph_mm(unit)
    return b.rest_mm + truth[[b.mesh.markers[n] for n in b.names]], truth


def test_the_skin_of_the_cheeks_moves_with_speech():
    """ "evident in the movement of the skin in the cheeks": it follows as the head's own shapes do."""
    b = bound()
    markers_of_cheeks = [i for n, i in b.mesh.markers.items() if n.startswith("cheek")]
    near = cdist(b.mesh.vertices_mm, b.mesh.vertices_mm[markers_of_cheeks]).min(axis=1) < 20.0
    cheeks = near & b.mesh.part_mask("skin") & (skin_regions(b.mesh) == SkinRegion.FACE)
    for unit, amount in (("jawOpen", 0.5), ("mouthPucker", 0.8), ("mouthSmileLeft", 0.8)):
        markers, truth = spoken(unit, amount)
        moved = b.apply(markers[None], {}, np.float64)[0] - b.mesh.vertices_mm
        strong = cheeks & (np.linalg.norm(truth, axis=1) > 0.5)
        assert strong.sum() > 30
        left = np.linalg.norm(moved - truth, axis=1)[strong]
        print(
            unit, strong.sum(), np.sqrt((left**2).mean()) / np.sqrt((truth[strong] ** 2).sum(axis=1).mean())
        )
        assert np.sqrt((left**2).mean()) < 0.5 * np.sqrt((truth[strong] ** 2).sum(axis=1).mean()), unit


def test_the_jaw_is_determined_from_points_on_the_skin_that_covers_it():
    """ "determined directly from the motion of captured points on the skin covering the jaw" """
    b = bound()
    markers, _ = spoken("jawOpen", 0.5)
    others = [i for i, n in enumerate(b.names) if not n.startswith("chin")]
    whole = b.rigid(markers[None])["lower_teeth"][0]
    elsewhere = markers.copy()
    elsewhere[others] = b.rest_mm[others]
    np.testing.assert_allclose(b.rigid(elsewhere[None])["lower_teeth"][0], whole, atol=1e-12)
    turn = Rotation.from_matrix(whole[:3, :3]).as_rotvec(degrees=True)
    assert turn[0] > 3  # it opens, about the axis from ear to ear
    assert np.abs(turn[1:]).max() < 0.2 * turn[0]


def test_lower_teeth_and_tongue_go_with_the_jaw_and_upper_teeth_stay():
    b = bound()
    markers, _ = spoken("jawOpen", 0.5)
    frame = b.apply(markers[None], None, np.float64)[0]
    moved = np.linalg.norm(frame - b.mesh.vertices_mm, axis=1)
    for part, least in (("lower_teeth", 2.0), ("tongue", 1.0)):
        assert moved[b.mesh.part_mask(part)].max() > least
    assert moved[b.mesh.part_mask("upper_teeth")].max() == 0
