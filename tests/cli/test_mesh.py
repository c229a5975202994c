"""``corpus-tools mesh``: faults and unit told, markers proposed, picks taken, the user's files left alone."""

import json

import numpy as np
import pytest

from corpus_tools.mesh import bundled_head, read_mesh
from tests.cli.answers import last_json, refused


@pytest.fixture(scope="module")
def face(tmp_path_factory):
    """The bundled skin as an .obj in cm, without markers."""
    head = bundled_head()
    skin = head.faces[head.part_mask("skin")[head.faces].all(axis=1)] + 1
    rows = [f"v {x} {y} {z}" for x, y, z in head.vertices_mm / 10] + [f"f {a} {b} {c}" for a, b, c in skin]
    file = tmp_path_factory.mktemp("mesh") / "face.obj"
    file.write_text("\n".join(rows), encoding="utf-8")
    return file


def test_check_tells_unit_and_faults(tool, face):
    code, out, _ = tool("mesh", "check", face, "--json")
    found = last_json(out)
    assert code == 0
    assert found["ok"]
    assert found["unit"] == "cm"
    assert [f["kind"] for f in found["faults"]] == ["loose vertices"]


def test_a_proposal_is_written_edited_and_given_back(tool, face, tmp_path):
    before = face.read_bytes()
    code, out, _ = tool("mesh", "propose", face, "--out", tmp_path / "one", "--json")
    assert code == 0
    assert last_json(out)["markers"] == 66
    table = json.loads((tmp_path / "one" / "face.markers.json").read_text(encoding="utf-8"))
    wanted = bundled_head().markers["cheek4"]
    table["markers"]["cheek4"] = (bundled_head().vertices_mm[wanted] / 10).tolist()
    picks = tmp_path / "picks.json"
    picks.write_text(json.dumps(table), encoding="utf-8")
    assert tool("mesh", "propose", face, "--out", tmp_path / "two", "--picks", picks)[0] == 0
    mesh = read_mesh(tmp_path / "two" / "face.npz")
    assert mesh.markers["cheek4"] == wanted
    assert mesh.markers["nose2"] == table["markers"]["nose2"]
    np.testing.assert_array_equal(mesh.lip_pairs, table["lip_pairs"])
    assert face.read_bytes() == before
    assert [p.name for p in face.parent.iterdir()] == ["face.obj"]


def test_the_folder_of_the_mesh_and_broken_picks_are_refused(tool, face, tmp_path):
    refused(tool("mesh", "propose", face, "--out", face.parent), "a folder of its own")
    (tmp_path / "picks.json").write_text("{", encoding="utf-8")
    answer = tool("mesh", "propose", face, "--out", tmp_path / "o", "--picks", tmp_path / "picks.json")
    refused(answer, "picks.json", "cannot be read")
    assert not (tmp_path / "o").exists()
