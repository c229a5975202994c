"""Faults of a mesh are told with their place; one mesh is the same whatever file it came in."""

import json
import struct
from dataclasses import replace

import numpy as np
import pytest

from corpus_tools.core import Mesh, MeshError
from corpus_tools.mesh import bundled_head, check_mesh, closing_faces, read_surface, refuse_fatal

TETRA = np.array([[0, 0, 0], [100, 0, 0], [0, 120, 0], [0, 0, 90]], float)
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


def obj_bytes(scale):
    rows = [f"v {x} {y} {z}" for x, y, z in TETRA * scale] + [
        f"f {a + 1} {b + 1} {c + 1}" for a, b, c in FACES
    ]
    return "\n".join(rows).encode()


def ply_bytes(scale, kind="ascii"):
    head = f"ply\nformat {kind} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    head += "property uchar red\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
    if kind == "ascii":
        rows = [f"{x} {y} {z} 9" for x, y, z in TETRA * scale] + [f"3 {a} {b} {c}" for a, b, c in FACES]
        return (head + "\n".join(rows)).encode()
    order = "<" if "little" in kind else ">"
    body = b"".join(struct.pack(f"{order}fffB", *p, 9) for p in TETRA * scale)
    return head.encode() + body + b"".join(struct.pack(f"{order}Biii", 3, *f) for f in FACES)


def glb_bytes(scale):
    """Every triangle with corners of its own, under a node that scales and turns half about y."""
    points = (TETRA * scale / 2 * [-1, 1, -1])[FACES.ravel()].astype("<f4").tobytes()
    content = {
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"children": [1], "scale": [2, 2, 2]}, {"mesh": 0, "rotation": [0, 1, 0, 0]}],
        "meshes": [{"name": "face", "primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 12, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": len(points)}],
        "buffers": [{"byteLength": len(points)}],
    }
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    chunks = (
        struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(points), b"BIN\0") + points
    )
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


KINDS = {
    "a.obj": obj_bytes,
    "b.ply": ply_bytes,
    "c.ply": lambda s: ply_bytes(s, "binary_little_endian"),
    "d.ply": lambda s: ply_bytes(s, "binary_big_endian"),
    "e.glb": glb_bytes,
}


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("unit", [1.0, 10.0, 100.0, 1000.0])
def test_one_mesh_whatever_the_format_and_the_unit(tmp_path, name, unit):
    (tmp_path / name).write_bytes(KINDS[name](1.0 / unit))
    mesh, scale = read_surface(tmp_path / name)
    assert scale == unit
    np.testing.assert_allclose(mesh.vertices_mm[mesh.faces].sum(axis=1), TETRA[FACES].sum(axis=1), atol=1e-3)
    assert mesh.n_vertices == 4
    assert check_mesh(mesh) == ()


@pytest.mark.parametrize("name", KINDS)
def test_a_cut_file_costs_one_sentence(tmp_path, name):
    data = KINDS[name](1.0)
    (tmp_path / name).write_bytes(data[: len(data) * 2 // 3])
    if name == "a.obj":
        (tmp_path / name).write_bytes(b"v 1 2 x\n")
    with pytest.raises(MeshError, match="cannot be read"):
        read_surface(tmp_path / name)


def test_no_size_of_a_head(tmp_path):
    (tmp_path / "a.obj").write_bytes(obj_bytes(1e-7))
    with pytest.raises(MeshError, match="a head in mm, cm, dm, m was expected"):
        read_surface(tmp_path / "a.obj")


def tetra(faces=FACES, points=TETRA, **extra):
    return Mesh(name="t", vertices_mm=points, faces=faces, part=np.zeros(len(points), np.int8), **extra)


def test_every_fault_is_found_where_it_was_made():
    more = np.concatenate([TETRA, [[0, 0, 0], [50, -60, 0]]])
    made = {
        "flipped faces": tetra(np.concatenate([FACES[:3], FACES[3:, ::-1]])),
        "loose vertices": tetra(points=more[[0, 1, 2, 3, 5]]),
        "doubles": tetra(points=more[:5]),
        "non-manifold edges": tetra(np.concatenate([FACES, [[0, 1, 4]]]), more[[0, 1, 2, 3, 5]]),
        "faces without area": tetra(
            np.concatenate([FACES, [[0, 4, 1]]]), np.concatenate([TETRA, [[50, 0, 0]]])
        ),
    }
    for kind, mesh in made.items():
        found = {f.kind: f for f in check_mesh(mesh)}
        assert kind in found, kind
        assert "the first at vertex" in found[kind].sentence
        assert not found[kind].fatal


def test_a_hole_in_the_cheek_is_told_and_the_neck_is_not():
    head = bundled_head()
    assert check_mesh(head) == ()
    cheek = head.markers["cheek4"]
    holed = replace(head, faces=head.faces[(head.faces != cheek).all(axis=1)])
    assert {f.kind: f.count for f in check_mesh(holed)} == {"holes": 1, "loose vertices": 1}


def test_faces_between_the_lips_are_fatal():
    head = bundled_head()
    (a, b), (c, d) = head.lip_pairs[3:5]
    sewn = replace(head, faces=np.concatenate([head.faces, [[a, b, c], [c, b, d]]]))
    assert closing_faces(sewn).sum() == 2
    assert check_mesh(sewn)[0].fatal
    with pytest.raises(MeshError, match="2 faces that close the mouth between the lips"):
        refuse_fatal(sewn)
    refuse_fatal(head)
