"""Markers are proposed from the shape alone: corners within 3 mm, lips on their own sides."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from corpus_tools.core import Mesh, MeshError
from corpus_tools.mesh import (
    DEFORMERS,
    LOWER_LIP,
    SkinRegion,
    bundled_head,
    closing_faces,
    edges_of,
    find_landmarks,
    open_lips,
    propose_markers,
    read_surface,
    ready_to_speak,
    signed_lip_aperture_mm,
    skin_regions,
    vertex_normals,
)
from corpus_tools.mesh.lips import lip_distances_mm

MESHES = Path(os.environ.get("SPEECH_CORPORA", "nowhere/real")).parent / "meshes"
"""Heads of other makers lie beside the recordings."""
LOST = np.zeros((0, 2), np.int64)
CORNER_MM = 3.0


def bare(mesh):
    return replace(mesh, markers={}, lip_pairs=LOST)


def ict():
    """The truth: the ends of the rim between skin and socket, 4 mm behind the lips' own corners."""
    data = np.load(MESHES / "ict_facekit" / "ict_head_speech.npz")
    quads, own = data["faces"], data["part"]
    part = np.zeros(len(data["vertices_cm"]), np.int8)
    for number in np.unique(own):
        part[quads[own == number]] = number
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    rim = np.intersect1d(quads[own == 0], quads[own == 1])
    v = data["vertices_cm"].astype(float) * 10
    rim = rim[v[rim, 1] < 0]
    names = tuple(map(str, data["part_names"]))
    return Mesh("ict", v, faces, part, names), v[rim[np.argsort(v[rim, 0])[[0, -1]]]]


def soma():
    """The truth: where the front of the pairs that look at each other across the lip line ends."""
    data = np.load(MESHES / "soma_head" / "soma_head_crop.npz")
    faces = np.concatenate([data["F"][:, [0, 1, 2]], data["F"][:, [0, 2, 3]]])
    mesh = Mesh("soma", data["V"] * 1000.0, faces, np.zeros(len(data["V"]), np.int8))
    v, normals = mesh.vertices_mm, vertex_normals(mesh.vertices_mm, faces)
    near = np.flatnonzero((np.abs(v[:, 1] - 597) < 12) & (v[:, 2] > 180) & (np.abs(v[:, 0]) < 40))
    pairs = near[cKDTree(v[near]).query_pairs(2.5, output_type="ndarray")]
    pairs = pairs[np.sum(normals[pairs[:, 0]] * normals[pairs[:, 1]], axis=1) < -0.5]
    middle = v[pairs].mean(axis=1)
    return mesh, middle[np.argsort(middle[:, 0])[[0, -1]]]


def canonical():
    mesh = read_surface(MESHES / "mediapipe_canonical" / "canonical_face_model.obj")[0]
    return mesh, mesh.vertices_mm[[61, 291]]


def base():
    head = bundled_head()
    return bare(head), head.vertices_mm[[head.markers["lip_out0"], head.markers["lip_out6"]]]


@pytest.fixture(scope="module", params=[base, ict, soma, canonical], ids=lambda f: f.__name__)
def case(request):
    if request.param is not base:
        request.getfixturevalue("corpora")  # skips without recordings; with them the heads are there
    mesh, truth = request.param()
    return mesh, truth, propose_markers(mesh)


def test_corners_chin_and_sides(case):
    mesh, truth, found = case
    at = {n: found.vertices_mm[i] for n, i in found.markers.items()}
    corners = np.array([at["lip_out0"], at["lip_out6"]])
    assert np.linalg.norm((corners - truth)[:, :2], axis=1).max() < CORNER_MM
    assert abs(corners[0, 0] + corners[1, 0]) < CORNER_MM
    assert at["nose2"][1] > at["lip_out3"][1] > at["lip_out9"][1] > at["chin1"][1]
    for name in ("lip_out1", "lip_out2", "lip_out3", "lip_out4", "lip_out5"):
        assert at[name][1] > corners[:, 1].mean()
    for name in ("lip_out7", "lip_out8", "lip_out9", "lip_out10", "lip_out11"):
        assert at[name][1] < corners[:, 1].mean()
    assert len(set(found.markers.values())) == 66
    np.testing.assert_array_equal(found.vertices_mm, mesh.vertices_mm)


def test_lips_meet_and_are_open(case):
    _, _, found = case
    ready, n = ready_to_speak(found)
    assert n == (18 if found.n_vertices == 468 else 0)
    assert not closing_faces(ready).any()
    v = ready.vertices_mm
    gap = v[ready.lip_pairs[:, 0], 1] - v[ready.lip_pairs[:, 1], 1]
    np.testing.assert_allclose(gap, 0.0, atol=0.2)
    assert not set(ready.lip_pairs[:, 0]) & set(ready.lip_pairs[:, 1])


def test_an_open_mouth_parts_the_lips_and_tears_nothing(case):
    """Half the way from lips to nose: every vertex near a lip goes with its own one, no edge is torn."""
    mesh = ready_to_speak(case[2])[0]
    names = tuple(mesh.markers)
    v = mesh.vertices_mm
    targets = v[list(mesh.markers.values())].copy()
    span = v[mesh.markers["nose2"], 1] - v[mesh.markers["lip_in2"], 1]
    drop = 0.5 * span
    targets[[n in LOWER_LIP or n.startswith("chin") for n in names], 1] -= drop
    targets[[n in ("lip_in0", "lip_in4", "lip_out0", "lip_out6") for n in names], 1] -= 0.35 * drop
    binding = DEFORMERS["bid"](mesh, names)
    moved = binding.apply(targets[None], rigid=binding.rigid(targets[None]))[0]
    face = skin_regions(mesh) != SkinRegion.MOUTH
    upper, lower = lip_distances_mm(mesh)
    middle = np.abs(v[:, 0]) < 0.55 * np.abs(v[mesh.markers["lip_out0"], 0])
    near = face & middle & (np.minimum(upper, lower) < 0.3 * span)
    down = v[:, 1] - moved[:, 1]
    assert not (near & (upper < lower - 0.05 * span) & (down > 0.5 * drop)).any()
    assert not (near & (lower < upper - 0.05 * span) & (down < 0.5 * drop)).any()
    edges = edges_of(mesh.faces)
    edges = edges[face[edges].all(axis=1)]
    before, after = (np.linalg.norm(x[edges[:, 0]] - x[edges[:, 1]], axis=1) for x in (v, moved))
    assert (after - before).max() < 0.75 * drop
    assert signed_lip_aperture_mm(moved, mesh)[0] > 0.5 * drop


def test_the_place_and_size_of_a_head_do_not_matter():
    head = bare(bundled_head())
    marks = find_landmarks(head)
    moved = find_landmarks(replace(head, vertices_mm=head.vertices_mm * 0.7 + [30.0, -500.0, 90.0]))
    for name, place in marks.points.items():
        np.testing.assert_allclose(moved.points[name], place * 0.7 + [30.0, -500.0, 90.0], atol=0.7)


def test_a_head_that_looks_elsewhere_is_told():
    head = bare(bundled_head())
    with pytest.raises(MeshError, match=r"No face was found .* turn it to \+y up"):
        propose_markers(replace(head, vertices_mm=head.vertices_mm[:, [0, 2, 1]] * [1, -1, 1]))


def test_opening_takes_only_faces_between_the_lips():
    head = bundled_head()
    (a, b), (c, d) = head.lip_pairs[3:5]
    sewn = replace(head, faces=np.concatenate([head.faces, [[a, b, c], [c, b, d]]]))
    opened, n = open_lips(sewn)
    assert n == 2
    np.testing.assert_array_equal(opened.faces, head.faces)
