"""Mesh files: there and back, obj with parts, and every way a file can be wrong."""

import json

import numpy as np
import pytest

from corpus_tools.core import MeshError
from corpus_tools.mesh import CHARACTERS, bundled_head, mesh_by_name_or_file, read_mesh, write_mesh

OBJ = """# two parts
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 2
g skin
f 1/1 2/1 3/1 4/1
g teeth
f -5 -4 -1
"""


@pytest.fixture
def obj(tmp_path):
    file = tmp_path / "face.obj"
    file.write_text(OBJ, encoding="utf-8")
    table = {"markers": {"chin0": 1}, "lip_pairs": [[2, 3]], "scale_to_mm": 10.0}
    (tmp_path / "face.markers.json").write_text(json.dumps(table), encoding="utf-8")
    return file


def test_npz_comes_back_exactly(tmp_path):
    head = bundled_head("baby")
    write_mesh(tmp_path / "baby.npz", head)
    again = read_mesh(tmp_path / "baby.npz")
    assert again.name == "baby"
    assert dict(again.markers) == dict(head.markers)
    assert again.part_names == head.part_names
    for field in ("vertices_mm", "faces", "part", "lip_pairs"):
        np.testing.assert_array_equal(getattr(again, field), getattr(head, field))


def test_obj_polygons_become_triangles_and_groups_parts(obj):
    mesh = read_mesh(obj)
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3], [0, 1, 4]]
    assert mesh.part_names == ("skin", "teeth")
    assert mesh.vertices_mm[4].tolist() == [0, 0, 20]
    assert dict(mesh.markers) == {"chin0": 1}
    assert mesh.lip_pairs.tolist() == [[2, 3]]


def test_obj_without_markers_says_what_is_missing(obj):
    obj.with_suffix(".markers.json").unlink()
    with pytest.raises(MeshError, match=r"there is no 'face\.markers\.json'"):
        read_mesh(obj)


@pytest.mark.parametrize("name", list(CHARACTERS))
def test_bundled_heads_by_name(name):
    assert mesh_by_name_or_file(name) is bundled_head(name)


def test_file_by_path(tmp_path):
    write_mesh(tmp_path / "own.npz", bundled_head())
    assert mesh_by_name_or_file(str(tmp_path / "own.npz")).n_vertices == bundled_head().n_vertices


def test_neither_name_nor_file_lists_the_names():
    with pytest.raises(MeshError, match="give one of base, male"):
        mesh_by_name_or_file("bse")


def test_missing_file(tmp_path):
    with pytest.raises(MeshError, match="There is no mesh file"):
        read_mesh(tmp_path / "nothing.npz")


def test_cut_file(tmp_path):
    file = tmp_path / "cut.npz"
    write_mesh(file, bundled_head())
    file.write_bytes(file.read_bytes()[:1000])
    with pytest.raises(MeshError, match=r"cut\.npz' cannot be read"):
        read_mesh(file)


def test_pickled_arrays_are_refused(tmp_path):
    file = tmp_path / "evil.npz"
    np.savez(file, vertices_mm=np.array([{}], dtype=object), faces=np.zeros((0, 3), int))
    with pytest.raises(MeshError, match="cannot be read"):
        read_mesh(file)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            {"marker_names": np.array(["chin0"]), "marker_vertices": np.array([99])},
            "'chin0' stands at vertex 99",
        ),
        ({"lip_pairs": np.array([[0, 99]])}, "not pairs of its 3 vertices"),
        ({"vertices_mm": np.full((3, 3), np.nan)}, "not finite"),
        ({"faces": np.array([[0, 1, 7]])}, "not triangles of its 3 vertices"),
        ({"vertices_mm": np.zeros((3, 2))}, r"no vertices of shape \(n, 3\)"),
    ],
)
def test_wrong_content_is_named(tmp_path, change, words):
    fields = {"vertices_mm": np.eye(3), "faces": np.array([[0, 1, 2]])} | change
    np.savez(tmp_path / "bad.npz", **fields)
    with pytest.raises(MeshError, match=words):
        read_mesh(tmp_path / "bad.npz")


def test_missing_array_is_named(tmp_path):
    np.savez(tmp_path / "bad.npz", vertices_mm=np.eye(3))
    with pytest.raises(MeshError, match="no array 'faces'"):
        read_mesh(tmp_path / "bad.npz")


def test_other_kinds_of_files_are_refused(tmp_path):
    (tmp_path / "face.stl").write_text("solid", encoding="utf-8")
    with pytest.raises(MeshError, match=r"ends in '\.stl'"):
        mesh_by_name_or_file(str(tmp_path / "face.stl"))
