"""A first set of markers for a mesh that names none: from the bundled head, over landmarks of both faces.

Paper A section 6 takes corresponding landmarks as given; how they are found here is our choice.
"""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
from scipy.interpolate import RBFInterpolator
from scipy.spatial import cKDTree

from corpus_tools.core import FloatArray, IntArray, Mesh, MeshError
from corpus_tools.mesh.bundle import bundled_head
from corpus_tools.mesh.checking import closing_faces
from corpus_tools.mesh.landmarks import FaceLandmarks, find_landmarks
from corpus_tools.mesh.lips import close_lips, skin_faces
from corpus_tools.mesh.topology import vertex_normals

__all__ = ["open_lips", "propose_markers", "ready_to_speak"]

N_LINE = 9
"""Points of the lip line that go into the warp, and lip pairs that are looked for."""
TOUCH = 0.1
"""Lips touch where vertices that look at each other are nearer than this share of the way nose to mouth."""
INNER_CORNERS = np.array([0.035, 0.965])
"""Inner corners lie this share of the lip line inside the outer ones, as on the bundled head."""
UPPER_RIM = {"lip_in1": 0.25, "lip_in2": 0.5, "lip_in3": 0.75}
LOWER_RIM = {"lip_in7": 0.25, "lip_in6": 0.5, "lip_in5": 0.75}

CANONICAL_SIZE = (468, 898)
CANONICAL_UPPER = (191, 80, 81, 82, 13, 312, 311, 310, 415)
CANONICAL_LOWER = (95, 88, 178, 87, 14, 317, 402, 318, 324)
CANONICAL_CORNERS = (78, 308)
"""Inner lips of the canonical face of MediaPipe, by its published numbering; it has no inside of a mouth."""


def propose_markers(mesh: Mesh) -> Mesh:
    """Return the mesh with the 66 markers of the face and lip pairs, put where the face seems to have them.

    The landmarks of :func:`find_landmarks` on the bundled head and on the mesh carry a thin-plate warp; the
    markers of the bundled head go through it to the nearest vertices that look the same way. Inner lips are
    the vertices along the lip line that look at each other.

    Raises
    ------
    MeshError
        No face is found, or the lips are one surface: no vertices look at each other along the lip line.
    """
    source, marks = _source()
    target = find_landmarks(mesh)
    warp = RBFInterpolator(_carriers(marks), _carriers(target), kernel="thin_plate_spline", smoothing=0.0)
    upper, lower, corners = _rims(mesh, target)
    names = [n for n in source.markers if not n.startswith("lip_in")]
    places = warp(source.vertices_mm[[source.markers[n] for n in names]])
    looks = vertex_normals(source.vertices_mm, source.faces)[[source.markers[n] for n in names]]
    inner = {"lip_in0": int(corners[0]), "lip_in4": int(corners[1])}
    for rim, shares in ((upper, UPPER_RIM), (lower, LOWER_RIM)):
        inner |= {n: int(rim[round(s * (len(rim) - 1))]) for n, s in shares.items()}
    taken = {*inner.values(), *upper.tolist(), *lower.tolist()}
    found = _nearest(mesh, places, looks, taken)
    markers = dict(zip(names, found, strict=True)) | inner
    return replace(
        mesh,
        markers={n: markers[n] for n in source.markers},
        lip_pairs=np.stack([upper, lower], axis=1),
    )


def open_lips(mesh: Mesh) -> tuple[Mesh, int]:
    """Return a copy without the faces that close the mouth between the inner lips, and how many they were."""
    closing = closing_faces(mesh)
    return replace(mesh, faces=mesh.faces[~closing]), int(closing.sum())


def ready_to_speak(mesh: Mesh) -> tuple[Mesh, int]:
    """Return a copy of a mesh with markers, its lips opened and then brought together, and the faces deleted.

    The lips are cut (:func:`open_lips`) and each pair meets at rest (:func:`close_lips`), within 6 mm of skin
    or the greatest gap, whichever is more: neutral is a closed mouth (our choice).
    """
    opened, n = open_lips(mesh)
    if not len(opened.lip_pairs):
        return opened, n
    v = opened.vertices_mm
    gap = np.abs(v[opened.lip_pairs[:, 0], 1] - v[opened.lip_pairs[:, 1], 1])
    reach = max(6.0, 1.5 * float(gap.max()))
    closed = close_lips(np.array(v), opened.faces[skin_faces(opened)], opened.lip_pairs, reach)
    return replace(opened, vertices_mm=closed), n


@functools.cache
def _source() -> tuple[Mesh, FaceLandmarks]:
    head = bundled_head()
    return head, find_landmarks(head)


def _carriers(marks: FaceLandmarks) -> FloatArray:
    """Return the points that carry the warp: the named ones, and the lip line in equal steps of x."""
    named = [p for n, p in marks.points.items() if n not in ("stomion", "corner_low", "corner_high")]
    return np.concatenate([named, _along(marks.lip_line, np.linspace(0.0, 1.0, N_LINE))])


def _along(line: FloatArray, shares: FloatArray) -> FloatArray:
    x = line[0, 0] + shares * (line[-1, 0] - line[0, 0])
    return np.stack([x, *(np.interp(x, line[:, 0], line[:, k]) for k in (1, 2))], axis=1)


def _rims(mesh: Mesh, marks: FaceLandmarks) -> tuple[IntArray, IntArray, IntArray]:
    """Return upper and lower vertices of the lip pairs and the two corners, each by growing x."""
    if (mesh.n_vertices, len(mesh.faces)) == CANONICAL_SIZE:
        return np.array(CANONICAL_UPPER), np.array(CANONICAL_LOWER), np.array(CANONICAL_CORNERS)
    upper, lower = _facing(mesh, marks)
    line = _along(marks.lip_line, np.linspace(0.0, 1.0, N_LINE + 2))
    pairs = []
    v = mesh.vertices_mm
    for place in line[1:-1]:
        above = upper[np.argmin(np.linalg.norm(v[upper] - place, axis=1))]
        below = lower[np.argmin(np.linalg.norm(v[lower] - v[above], axis=1))]
        pairs.append((int(above), int(below)))
    pairs = [p for i, p in enumerate(pairs) if not any(set(p) & set(q) for q in pairs[:i])]
    used = np.array(pairs, np.int64)
    free = np.setdiff1d(np.unique(mesh.faces[skin_faces(mesh)]), used)
    ends = _along(marks.lip_line, INNER_CORNERS)
    corners = [int(free[np.argmin(np.linalg.norm(v[free] - end, axis=1))]) for end in ends]
    return used[:, 0], used[:, 1], np.array(corners)


def _facing(mesh: Mesh, marks: FaceLandmarks) -> tuple[IntArray, IntArray]:
    """Return the vertices of either lip that look at the other one across the lip line."""
    v, span = mesh.vertices_mm, marks.span_mm
    skin = np.unique(mesh.faces[skin_faces(mesh)])
    near = skin[cKDTree(marks.lip_line).query(v[skin])[0] < 0.35 * span]
    normals = vertex_normals(v, mesh.faces)
    down, up = near[normals[near, 1] < -0.2], near[normals[near, 1] > 0.2]
    if not len(down) or not len(up):
        _one_surface(mesh)
    gap, partner = cKDTree(v[up]).query(v[down])
    meets = (gap < TOUCH * span) & (np.sum(normals[down] * normals[up[partner]], axis=1) < -0.3)
    if meets.sum() < N_LINE:
        _one_surface(mesh)
    return down[meets], np.unique(up[np.asarray(partner)[meets]])


def _one_surface(mesh: Mesh) -> None:
    raise MeshError(
        f"The lips of the mesh '{mesh.name}' are one surface: no vertices look at each other along the lip "
        "line; cut the mesh open there, or name its lips in a file of picks."
    )


def _nearest(mesh: Mesh, places: FloatArray, looks: FloatArray, taken: set[int]) -> list[int]:
    """Return for each place the nearest vertex of the skin that looks the same way, each vertex once."""
    skin = np.unique(mesh.faces[skin_faces(mesh)])
    normals = vertex_normals(mesh.vertices_mm, mesh.faces)[skin]
    used, found = set(taken), []
    for place, look in zip(places, looks, strict=True):
        away = np.linalg.norm(mesh.vertices_mm[skin] - place, axis=1)
        away = np.where(normals @ look > 0.3, away, away + 20.0)
        order = skin[np.argsort(away)[: len(used) + 1]]
        vertex = int(next(i for i in order if int(i) not in used))
        used.add(vertex)
        found.append(vertex)
    return found
