"""The bundled heads: one topology, seven characters (MakeHuman base head, CC0; see data/README.md)."""

from __future__ import annotations

import functools
import json
from importlib import resources

import numpy as np
import numpy.typing as npt

from corpus_tools.core import FloatArray, Mesh, Registry
from corpus_tools.mesh.lips import close_lips
from corpus_tools.mesh.topology import triangles

__all__ = ["CHARACTERS", "HIDDEN_PARTS", "bundled_head", "bundled_morph_mm", "bundled_morphs"]

CHARACTERS: Registry[str] = Registry("bundled head")
for _name, _what in (
    ("base", "the base head"),
    ("male", "young man"),
    ("female", "young woman"),
    ("elder", "old man"),
    ("child", "child"),
    ("baby", "baby"),
    ("cartoon", "big jaw, nose and ears"),
):
    CHARACTERS.add(_name, _what)

HIDDEN_PARTS = ("lashes",)
DM_TO_MM = 100.0
MILLI_DM_TO_MM = 0.1
TONGUE_SHRINK = 0.75
TONGUE_DROP_MM = 5.0
TEETH_NARROW = 0.86
TEETH_BACK_MM = 2.0
UPPER_TEETH_DROP_MM = 2.5


@functools.cache
def bundled_head(character: str = "base") -> Mesh:
    """Return a bundled head in mm, with all 66 face markers and lip pairs.

    Against the file: lashes are left out (opaque strips); the tongue, which fills the mouth, is shrunk to
    75 % about its root and lowered; the teeth, which reach the mouth corners and shine through any slit, are
    narrowed to 86 % and set back 2 mm, the upper ones lowered 2.5 mm (speech would never show them); the
    lips are brought together (:func:`close_lips`), so that the aperture at rest is zero. All our choice.

    Parameters
    ----------
    character : str
        One of :data:`CHARACTERS`.

    Raises
    ------
    InputError
        No such character; the message names them.
    """
    CHARACTERS[character]
    data, kept, faces, part = _topology()
    vertices = _shape(character)[kept]
    names = tuple(str(n) for n in data["part_names"] if n not in HIDDEN_PARTS)
    table = _markers()
    new = np.full(len(kept), -1)
    new[kept] = np.arange(int(kept.sum()))
    pairs = new[np.array(table["lip_pairs"])]
    skin = faces[(part[faces] == names.index("skin")).all(axis=1)]
    vertices = close_lips(vertices, skin, pairs)
    vertices = _smaller_tongue(vertices, part == names.index("tongue"))
    teeth = np.isin(part, [names.index("upper_teeth"), names.index("lower_teeth")])
    vertices[teeth] = vertices[teeth] * [TEETH_NARROW, 1.0, 1.0] - [0.0, 0.0, TEETH_BACK_MM]
    vertices[part == names.index("upper_teeth"), 1] -= UPPER_TEETH_DROP_MM
    return Mesh(
        name=character,
        vertices_mm=vertices,
        faces=faces,
        part=part,
        part_names=names,
        markers={n: int(new[i]) for n, i in table["markers"].items()},
        lip_pairs=pairs,
    )


def bundled_morphs() -> tuple[str, ...]:
    """Return the names of the 52 face units that the bundled head carries."""
    return tuple(str(n) for n in _file("head_arkit.npz")["morph_names"])


def bundled_morph_mm(name: str) -> FloatArray:
    """Return the displacement of every vertex of the bundled head under a face unit, (n_vertices, 3) mm.

    Raises
    ------
    InputError
        No such face unit.
    """
    units: Registry[int] = Registry("face unit")
    for i, unit in enumerate(bundled_morphs()):
        units.add(unit, i)
    data, kept, _, _ = _topology()
    return np.asarray(data["morph_delta_milli_dm"][units[name]][kept] * MILLI_DM_TO_MM, float)


@functools.cache
def _file(name: str) -> dict[str, npt.NDArray[np.generic]]:
    with (
        resources.as_file(resources.files("corpus_tools.mesh") / "data" / name) as path,
        np.load(path, allow_pickle=False) as data,
    ):
        return {key: data[key] for key in data.files}


@functools.cache
def _markers() -> dict[str, dict[str, int]]:
    text = (resources.files("corpus_tools.mesh") / "data" / "markers66.json").read_text(encoding="utf-8")
    table: dict[str, dict[str, int]] = json.loads(text)
    return table


def _shape(character: str) -> FloatArray:
    vertices = _file("head_arkit.npz")["vertices_dm"].astype(float) * DM_TO_MM
    if character != "base":
        others = _file("characters.npz")
        index = [str(n) for n in others["names"]].index(character)
        vertices = vertices + others["delta_milli_dm"][index].astype(float) * MILLI_DM_TO_MM
    return np.asarray(vertices, float)


def _topology() -> tuple[
    dict[str, npt.NDArray[np.generic]], npt.NDArray[np.bool_], npt.NDArray[np.int32], npt.NDArray[np.int8]
]:
    """Return the file, which vertices are kept, and triangles and parts of the kept ones."""
    data = _file("head_arkit.npz")
    quads, quad_part = data["quads"].astype(np.int64), data["part"].astype(np.int64)
    names = [str(n) for n in data["part_names"]]
    shown = ~np.isin(quad_part, [names.index(n) for n in HIDDEN_PARTS])
    kept = np.zeros(len(data["vertices_dm"]), bool)
    kept[quads[shown]] = True
    part = np.zeros(len(kept), np.int8)
    part[quads[shown]] = quad_part[shown][:, None]
    renumber = np.cumsum(kept) - 1
    return data, kept, triangles(renumber[quads[shown]]), part[kept]


def _smaller_tongue(vertices: FloatArray, tongue: npt.NDArray[np.bool_]) -> FloatArray:
    """Shrink the tongue about the middle of its root (rearmost tenth) and lower it."""
    points = vertices[tongue]
    root = points[points[:, 2] <= np.quantile(points[:, 2], 0.1)].mean(axis=0)
    moved = vertices.copy()
    moved[tongue] = root + TONGUE_SHRINK * (points - root) - [0.0, TONGUE_DROP_MM, 0.0]
    return moved
