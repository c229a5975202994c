"""Choose the vertices of the bundled head that stand for the 66 face markers; writes ``markers66.json``.

Run once per marker layout: ``python place_markers.py LAYOUT.npz``, where LAYOUT.npz holds `positions_mm`
(66, 3), a neutral pose with closed lips, `names` (66,) and `landmark` (66,), the MediaPipe index of each
marker. Only vertex numbers are kept, no position of the speaker. The same table serves every character, since
all share one topology. Lips are placed by topology, everything else by warping the layout onto the head.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np
from scipy.interpolate import RBFInterpolator
from scipy.spatial import cKDTree

from corpus_tools.core import FloatArray, IntArray
from corpus_tools.mesh.topology import edge_loop, edges_of, vertex_normals

__all__ = ["MIRRORED", "place_markers"]

HERE = Path(__file__).parent

MIRRORED: dict[str, str] = {
    **{f"brow{i}": f"brow{9 - i}" for i in range(10)},
    **{f"eye{a}": f"eye{b}" for a, b in zip(range(8), (6, 5, 4, 7, 2, 1, 0, 3), strict=True)},
    **{f"nose{a}": f"nose{b}" for a, b in zip(range(6), (0, 1, 2, 4, 3, 5), strict=True)},
    **{f"cheek{i}": f"cheek{(i + 7) % 14}" for i in range(14)},
    **{f"lip_out{i}": f"lip_out{(6 - i) % 12}" for i in range(12)},
    **{f"lip_in{i}": f"lip_in{(4 - i) % 8}" for i in range(8)},
    **{f"chin{a}": f"chin{b}" for a, b in zip(range(8), (0, 1, 2, 3, 5, 4, 7, 6), strict=True)},
}


class Head:
    """The head of ``head_arkit.npz`` in mm, with what placing needs to know of it."""

    def __init__(self, path: Path) -> None:
        data = np.load(path)
        self.vertices: FloatArray = data["vertices_dm"].astype(float) * 100.0
        self.quads: IntArray = data["quads"][data["part"] == 0].astype(np.int64)
        self.normals = vertex_normals(self.vertices, self.quads)
        morphs = [str(n) for n in data["morph_names"]]
        self.jaw_open: FloatArray = data["morph_delta_milli_dm"][morphs.index("jawOpen")] * 0.1
        self.skin: IntArray = np.unique(self.quads)

    def mirror(self, vertex: int) -> int:
        """Return the skin vertex at the mirrored place (the head is exactly symmetric)."""
        other = self.vertices[vertex] * [-1.0, 1.0, 1.0]
        return int(self.skin[np.abs(self.vertices[self.skin] - other).sum(axis=1).argmin()])


def rings(head: Head) -> list[list[int]]:
    """Return the edge loops around the mouth, from the nose inwards and on into the pouch behind the lips."""
    middle = [int(i) for i in head.skin if abs(head.vertices[i, 0]) < 1e-6]
    edges = edges_of(head.quads)
    found = []
    for vertex in middle:
        joined = edges[(edges == vertex).any(axis=1)].ravel()
        side = [int(i) for i in joined if head.vertices[i, 0] > 1e-6]
        if len(side) != 1:
            continue
        loop = edge_loop(head.quads, vertex, side[0])
        crossings = [i for i in loop if abs(head.vertices[i, 0]) < 1e-6]
        closed = len(crossings) == 2 and loop[-1] == head.mirror(side[0])
        if closed and head.jaw_open[crossings[1], 1] < -25 < head.jaw_open[vertex, 1]:
            found.append(loop)
    return found


def split_ring(head: Head, ring: list[int]) -> tuple[list[int], int, list[int]]:
    """Split the half of a ring at x >= 0 into upper vertices, corner and lower vertices, middle to corner."""
    half = ring[: len(ring) // 2 + 1]
    corner = int(np.argmax(head.vertices[half, 0]))
    return half[:corner], half[corner], half[corner + 1 :][::-1]


def inner_ring(head: Head, candidates: list[list[int]]) -> list[int]:
    """Return the ring along which the lips meet: the one whose two halves are closest at rest."""

    def gap(ring: list[int]) -> float:
        upper, _, lower = split_ring(head, ring)
        x, y = head.vertices[lower, 0], head.vertices[lower, 1]
        u = head.vertices[upper]
        return float(np.abs(np.interp(x, u[:, 0], u[:, 1]) - y).mean())

    return min(candidates, key=gap)


def outer_ring(head: Head, candidates: list[list[int]], inner: list[int]) -> list[int]:
    """Return the ring on the ridge of the upper lip: going up, the first that comes forward most."""
    front = [r for r in candidates if head.vertices[r[0], 1] > head.vertices[inner[0], 1]]
    front = sorted((r for r in front if head.vertices[r[0], 2] > 155.0), key=lambda r: head.vertices[r[0], 1])
    depth = [head.vertices[r[0], 2] for r in front]
    return next(r for r, here, onward in zip(front, depth, depth[1:], strict=False) if onward < here)


def chin_bottom(head: Head) -> int:
    """Return the middle vertex of the chin whose normal points 45 degrees down (the landmark is too high)."""
    middle = head.skin[(np.abs(head.vertices[head.skin, 0]) < 1e-6) & (head.jaw_open[head.skin, 1] < -15)]
    outside = middle[head.normals[middle, 2] > 0.3]
    return int(outside[np.abs(head.normals[outside, 1] + np.sqrt(0.5)).argmin()])


def facing_pairs(head: Head, inner: list[int]) -> list[tuple[int, int]]:
    """Pair each lower vertex of the inner ring with the upper one nearest in x, about 5 mm apart, x >= 0."""
    upper, corner, lower = split_ring(head, inner)
    reach = head.vertices[corner, 0] - 2.5
    xs = head.vertices[upper, 0]
    return [
        (upper[int(np.abs(xs - head.vertices[i, 0]).argmin())], i)
        for i in lower
        if head.vertices[i, 0] <= reach
    ]


def symmetric_layout(positions: FloatArray, names: list[str]) -> FloatArray:
    """Return the layout averaged with its mirror image, turned to face +z, mean at the origin, mm."""
    index = [names.index(MIRRORED[n]) for n in names]
    a = positions - positions.mean(axis=0)
    b = (a * [-1.0, 1.0, 1.0])[index]
    u, _, vt = np.linalg.svd(b.T @ a)
    turn = u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt))]) @ vt
    angle = np.arctan2(turn[2, 0] - turn[0, 2], turn[0, 0] + turn[2, 2]) / 2.0
    roll = np.arctan2(turn[1, 0] - turn[0, 1], turn[0, 0] + turn[1, 1]) / 2.0
    a = a @ _turn(angle, 0, 2).T @ _turn(roll, 0, 1).T
    a -= [a[[names.index(n) for n in ("nose2", "nose5", "chin3")], 0].mean(), 0.0, 0.0]
    result: FloatArray = 0.5 * (a + (a * [-1.0, 1.0, 1.0])[index])
    return result


def _turn(angle: float, i: int, j: int) -> FloatArray:
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = np.cos(angle)
    matrix[i, j], matrix[j, i] = np.sin(angle) * -1.0, np.sin(angle)
    return matrix


def place_lips(head: Head, layout: FloatArray, names: list[str]) -> tuple[dict[str, int], list[list[int]]]:
    """Return lip markers (name -> vertex) and the facing pairs [upper, lower] from left to right."""
    found = rings(head)
    inner, placed = inner_ring(head, found), {}
    outer = outer_ring(head, found, inner)
    pairs = facing_pairs(head, inner)
    for ring, name, n in ((inner, "lip_in", 8), (outer, "lip_out", 12)):
        upper, corner, lower = split_ring(head, ring)
        half = layout[names.index(f"{name}{n // 2}"), 0]
        placed[f"{name}{n // 2}"] = corner
        for k in range(n // 4, n // 2):
            x = layout[names.index(f"{name}{k}"), 0] / half * head.vertices[corner, 0]
            if ring is inner:
                up, low = min(pairs, key=lambda p: abs(head.vertices[p[1], 0] - x))
            else:
                up = min(upper, key=lambda i: abs(head.vertices[i, 0] - x))
                low = min(lower, key=lambda i: abs(head.vertices[i, 0] - x))
            placed[f"{name}{k}"], placed[f"{name}{n - k}"] = up, low
    both = [(head.mirror(u), head.mirror(d)) for u, d in pairs[:0:-1]] + pairs
    return placed, [[int(u), int(d)] for u, d in both]


def landmark_warp(
    head: Head, layout: FloatArray, ids: list[int], names: list[str], placed: dict[str, int]
) -> RBFInterpolator:
    """Warp from the layout to the head through shared landmarks; corners of the mouth from the topology."""
    known = json.loads((HERE / "landmarks52.json").read_text())
    vertex_of = dict(zip(known["mediapipe"], known["makehuman_head_arkit"], strict=True))
    lips = [n for n in names if n.startswith("lip")]
    use = {n: vertex_of[i] for n, i in zip(names, ids, strict=True) if i in vertex_of and n not in lips}
    use.update({n: v for n, v in placed.items() if n.startswith("lip_out")})
    use["chin3"] = chin_bottom(head)
    source = layout[[names.index(n) for n in use]]
    target = head.vertices[list(use.values())]
    mirrored = np.array([-1.0, 1.0, 1.0])
    both, index = np.unique(np.concatenate([source, source * mirrored]).round(6), axis=0, return_index=True)
    values = np.concatenate([target, target * mirrored])[index]
    return RBFInterpolator(both, values, kernel="thin_plate_spline", smoothing=2.0)


def open_skin(head: Head) -> IntArray:
    """Return skin vertices that face the front and have nothing in front of them."""
    front = head.skin[head.normals[head.skin, 2] > 0.1]
    near = cKDTree(head.vertices[head.skin, :2]).query_ball_point(head.vertices[front, :2], 4.0)
    ahead = np.array([head.vertices[head.skin[n], 2].max() for n in near]) - head.vertices[front, 2]
    return np.asarray(front[ahead < 10.0], np.int64)


def place_markers(layout_path: Path) -> dict[str, object]:
    """Return the table that ``markers66.json`` holds."""
    head = Head(HERE / "head_arkit.npz")
    given = np.load(layout_path)
    names, ids = [str(n) for n in given["names"]], [int(i) for i in given["landmark"]]
    layout = symmetric_layout(given["positions_mm"].astype(float), names)
    placed, pairs = place_lips(head, layout, names)
    warp = landmark_warp(head, layout, ids, names, placed)
    candidates = open_skin(head)
    for name, point in zip(names, warp(layout), strict=True):
        middle = MIRRORED[name] == name
        if name.startswith("lip") or (not middle and point[0] < 0):
            continue
        taken = list(placed.values())
        free = candidates[~np.isin(candidates, taken)]
        free = free[np.abs(head.vertices[free, 0]) < 1e-6] if middle else free[head.vertices[free, 0] > 1e-6]
        placed[name] = int(free[np.linalg.norm(head.vertices[free] - point, axis=1).argmin()])
    for name in names:
        if name not in placed:
            placed[name] = head.mirror(placed[MIRRORED[name]])
    return {"markers": {n: int(placed[n]) for n in names}, "lip_pairs": pairs}


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("layout", type=Path)
    table = place_markers(parser.parse_args().layout)
    (HERE / "markers66.json").write_text(json.dumps(table) + "\n")
