"""Reading what the bundled head is rebuilt from."""

import gzip
import runpy
import zipfile
from pathlib import Path

import numpy as np
import pytest

import corpus_tools.mesh

SCRIPT = Path(corpus_tools.mesh.__file__).parent / "data" / "rebuild_head.py"
# a quad high up, one below the neck, one loose; then a tooth
BASE = """v 0 7 0\nv 1 7 0\nv 1 8 0\nv 0 8 0
v 0 1 0\nv 1 1 0
v 5 7 0\nv 6 7 0\nv 6 8 0\nv 5 8 0
v 2 7 0\nv 2 8 0
g body
f 1/1 2/2 3/3 4/4
f 2/1 11/2 12/3 3/4
f 5/1 6/2 2/3 1/4
f 7/1 8/2 9/3 10/4
g helper-upper-teeth
f 1/1 2/2 3/3 4/4
"""


@pytest.fixture(scope="module")
def script():
    return runpy.run_path(str(SCRIPT))


@pytest.fixture
def wheel(tmp_path, script):
    path = tmp_path / "small.whl"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(script["BASE"], BASE)
        archive.writestr(script["UNITS"] + "jawOpen.target", "# by hand\n0 0.001 -0.25 0\n11 0 0 1\n")
        for recipe in script["CHARACTERS"].values():
            for shape in recipe:
                name = f"{script['SHAPES']}{shape}.target.gz"
                if name not in archive.namelist():
                    archive.writestr(name, gzip.compress(b"1 0.5 0 0\n"))
    return path


def test_head_is_cut_at_the_neck_and_loose_pieces_are_dropped(script, wheel):
    head, _ = script["rebuild"](wheel)
    assert head["orig_index"].tolist() == [0, 1, 2, 3, 10, 11]
    assert head["quads"].tolist() == [[0, 1, 2, 3], [1, 4, 5, 2], [3, 2, 1, 0]]
    assert head["part"].tolist() == [0, 0, 2]


def test_face_units_and_characters_are_thousandths_of_the_kept_vertices(script, wheel):
    head, characters = script["rebuild"](wheel)
    assert head["morph_names"].tolist() == ["jawOpen"]
    delta = head["morph_delta_milli_dm"][0]
    assert delta.dtype == np.int16
    assert delta[0].tolist() == [1, -250, 0]
    assert delta[5].tolist() == [0, 0, 1000]
    assert characters["names"].tolist() == ["male", "female", "elder", "child", "baby", "cartoon"]
    assert characters["delta_milli_dm"][0, 1].tolist() == [1000, 0, 0]


def test_committed_head_has_the_layout_that_rebuilding_gives(script, wheel):
    head, characters = script["rebuild"](wheel)
    for file, arrays in (("head_arkit.npz", head), ("characters.npz", characters)):
        with np.load(SCRIPT.parent / file) as kept:
            assert set(kept.files) == set(arrays)
            assert all(kept[k].dtype.kind == arrays[k].dtype.kind for k in arrays)
