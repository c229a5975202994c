"""Binary glTF (GLB): the triangles of its meshes, where the nodes of the scene put them."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from corpus_tools.core import FloatArray, IntArray
from corpus_tools.mesh.formats import RawSurface

__all__ = ["read_glb"]

_GLTF_KINDS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_GLTF_WIDTH = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def read_glb(file: Path) -> RawSurface:
    """Read the triangles of all meshes of the scene, nodes' transforms applied; each mesh is a part.

    Vertices of a mesh at exactly the same place become one: the format doubles them along seams of textures.

    Raises
    ------
    ValueError
        Not binary glTF 2, or its geometry is compressed.
    """
    content, blob = _glb_chunks(file.read_bytes())
    points, faces, parts = [], [], []
    names: list[str] = []
    n = 0
    for matrix, mesh in _glb_nodes(content):
        local, triangles = _glb_mesh(content, blob, mesh)
        if not len(triangles):
            continue
        local, triangles = _joined(local, triangles)
        points.append(local @ matrix[:3, :3].T + matrix[:3, 3])
        faces.append(triangles + n)
        parts.append(np.full(len(triangles), len(names)))
        names.append(str(mesh.get("name", f"mesh{len(names)}")))
        n += len(local)
    if not points:
        raise ValueError("it holds no triangles")
    return RawSurface(np.concatenate(points), np.concatenate(faces), np.concatenate(parts), tuple(names))


def _glb_chunks(data: bytes) -> tuple[dict[str, Any], bytes]:
    if data[:4] != b"glTF" or struct.unpack_from("<I", data, 4)[0] != 2:
        raise ValueError("it is not binary glTF 2")
    chunks: dict[bytes, bytes] = {}
    place = 12
    while place + 8 <= len(data):
        size, kind = struct.unpack_from("<I4s", data, place)
        chunks.setdefault(kind, data[place + 8 : place + 8 + size])
        place += 8 + size
    return json.loads(chunks[b"JSON"]), chunks.get(b"BIN\x00", b"")


def _glb_nodes(content: dict[str, Any]) -> list[tuple[FloatArray, dict[str, Any]]]:
    """Return the world matrix and the mesh of every node of the scene that has one."""
    nodes = content.get("nodes", [])
    children = {c for node in nodes for c in node.get("children", [])}
    scenes = content.get("scenes", [])
    roots = scenes[content.get("scene", 0)].get("nodes", []) if scenes else set(range(len(nodes))) - children
    found, waiting = [], [(int(i), np.eye(4)) for i in roots]
    while waiting:
        i, above = waiting.pop(0)
        matrix = above @ _node_matrix(nodes[i])
        if "mesh" in nodes[i]:
            found.append((matrix, content["meshes"][nodes[i]["mesh"]]))
        waiting += [(int(c), matrix) for c in nodes[i].get("children", [])]
    return found


def _node_matrix(node: dict[str, Any]) -> FloatArray:
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0.0, 0.0, 0.0, 1.0))
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turn = np.eye(3) + 2.0 * (w * cross + cross @ cross)
    matrix = np.eye(4)
    matrix[:3, :3] = turn * np.array(node.get("scale", (1.0, 1.0, 1.0)))
    matrix[:3, 3] = node.get("translation", (0.0, 0.0, 0.0))
    return matrix


def _glb_mesh(content: dict[str, Any], blob: bytes, mesh: dict[str, Any]) -> tuple[FloatArray, IntArray]:
    points, faces, n = [np.zeros((0, 3))], [np.zeros((0, 3), np.int64)], 0
    for primitive in mesh["primitives"]:
        if "KHR_draco_mesh_compression" in primitive.get("extensions", {}):
            raise ValueError("its geometry is compressed, and it was expected plain")
        if primitive.get("mode", 4) != 4:
            continue
        local = _accessor(content, blob, primitive["attributes"]["POSITION"]).astype(float)
        own = np.arange(len(local))
        if "indices" in primitive:
            own = _accessor(content, blob, primitive["indices"]).astype(np.int64).ravel()
        points.append(local)
        faces.append(own.reshape(-1, 3) + n)
        n += len(local)
    return np.concatenate(points), np.concatenate(faces)


def _accessor(content: dict[str, Any], blob: bytes, index: int) -> npt.NDArray[Any]:
    accessor = content["accessors"][index]
    view = content["bufferViews"][accessor["bufferView"]]
    if "extensions" in view:
        raise ValueError("its geometry is compressed, and it was expected plain")
    kind = np.dtype(_GLTF_KINDS[accessor["componentType"]])
    width, count = _GLTF_WIDTH[accessor["type"]], int(accessor["count"])
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    step = view.get("byteStride", width * kind.itemsize)
    return np.ndarray((count, width), kind, blob, start, (step, kind.itemsize))


def _joined(points: FloatArray, faces: IntArray) -> tuple[FloatArray, IntArray]:
    places, back = np.unique(points, axis=0, return_inverse=True)
    joined = back.ravel()[faces]
    whole = (joined != np.roll(joined, 1, axis=1)).all(axis=1)
    return places, joined[whole]
