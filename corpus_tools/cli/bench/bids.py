"""Bezier induced deformations: exact at rest, smooth, on the right lip, and quick at 25000 vertices."""

from __future__ import annotations

import functools

import numpy as np
import numpy.typing as npt

from corpus_tools.cli.bench.rows import BENCHMARKS, Ground, Row
from corpus_tools.core import FloatArray
from corpus_tools.mesh import (
    CHARACTERS,
    PatchBinding,
    SkinRegion,
    bind_bid,
    bundled_head,
    bundled_morph_mm,
    skin_regions,
)
from corpus_tools.mesh.attachment import Attachment, frames_at
from corpus_tools.mesh.kernel import patch_frames, plan_for
from corpus_tools.mesh.patches import bernstein, tangent_rows

__all__ = ["measure_bids"]

N_VERTICES, N_BATCH, LIFT_MM = 25_000, 32, 3.0


@BENCHMARKS.register("bids")
def measure_bids(ground: Ground) -> list[Row]:
    """Measure the deformer of paper A: laws on the bundled heads, speed on as many vertices as promised."""
    heads = [_bound(name) for name in CHARACTERS]
    rest = max(
        float(np.abs(b.apply(b.rest_mm[None], {}, np.float64)[0] - b.mesh.vertices_mm).max()) for b in heads
    )
    wrong = sum(_wrong_lips(b) for b in heads)
    what = f"BID on {len(heads)} heads"
    return [
        Row(f"{what}: rest is kept to", rest, "mm", bar=1e-9),
        Row(f"{what}: normals across patches, mouth open", max(map(_jump_deg, heads)), "degrees", bar=1e-4),
        Row(f"{what}: lip vertices that follow the other lip", float(wrong), "vertices", bar=0.0),
        *_speed(ground, heads[0], round(ground.scale * N_VERTICES)),
    ]


@functools.cache
def _bound(character: str) -> PatchBinding:
    mesh = bundled_head(character)
    return bind_bid(mesh, tuple(mesh.markers))


def _opened(binding: PatchBinding) -> tuple[FloatArray, FloatArray]:
    """Return the markers with the jaw half open, and how every vertex truly moves then."""
    truth = 0.5 * bundled_morph_mm("jawOpen")
    return binding.rest_mm + truth[[binding.mesh.markers[n] for n in binding.names]], truth


def _wrong_lips(binding: PatchBinding) -> int:
    markers, truth = _opened(binding)
    moved = binding.apply(markers[None], {}, np.float64)[0] - binding.mesh.vertices_mm
    lips = skin_regions(binding.mesh) == SkinRegion.LIPS
    least = truth[lips, 1].min()
    lower, upper = lips & (truth[:, 1] < 0.7 * least), lips & (truth[:, 1] > 0.25 * least)
    return int((moved[lower, 1] > 0.5 * least).sum() + (moved[upper, 1] < 0.5 * least).sum())


def _jump_deg(binding: PatchBinding) -> float:
    """Return the largest angle between the normals of two patches on the edge that they share."""
    chart, control = binding.surface.chart, binding.surface.control_mm(_opened(binding)[0])
    n = len(chart.vertices)
    sides: dict[tuple[int, int], list[tuple[int, int, int]]] = {}
    for patch in range(3 * len(chart.triangles)):
        t, k = chart.triangles[patch // 3], patch % 3
        corners = [int(t[k]), int(t[(k + 1) % 3]), n + patch // 3]
        for pair in ((0, 1), (1, 2), (2, 0)):
            a, b = sorted(pair, key=lambda i: corners[i])
            sides.setdefault((corners[a], corners[b]), []).append((patch, a, b))
    shared = np.array([side for side in sides.values() if len(side) == 2])
    normals = []
    for patch, a, b in shared.transpose(1, 2, 0):
        bary = np.zeros((len(patch), 3))
        bary[np.arange(len(patch)), a], bary[np.arange(len(patch)), b] = 0.37, 0.63
        normals.append(frames_at(control[patch], bary)[3])
    sine = np.linalg.norm(np.cross(normals[0], normals[1]), axis=1)
    return float(np.degrees(np.arctan2(sine, (normals[0] * normals[1]).sum(axis=1))).max())


def _speed(ground: Ground, binding: PatchBinding, n: int) -> list[Row]:
    """Measure frames a second on `n` random places of the surface against dense products in numpy."""
    surface, random = binding.surface, np.random.default_rng(0)
    n_smooth = 3 * len(surface.chart.triangles)
    patch, bary = np.sort(random.integers(0, n_smooth, n)), random.dirichlet(np.ones(3), n)
    offset, weight = np.tile([0.0, 0.0, LIFT_MM], (n, 1)), np.ones(n)
    hung = Attachment(np.arange(n), patch, bary, offset, weight)
    point, _, _, normal = frames_at(surface.control_rest_mm[patch], bary)
    plan = plan_for(surface.control_rest_mm, surface.net, hung, point + LIFT_MM * normal, n_smooth, "f4")
    shifts = random.normal(0, 1, (N_BATCH, *binding.rest_mm.shape)).astype(np.float32)
    dense = [_dense(binding, patch, rows) for rows in (bernstein(bary), *tangent_rows(bary))]
    rows = []
    for frames, bar in ((1, 300.0), (N_BATCH, 1500.0)):
        part = shifts[:frames]
        columns = np.ascontiguousarray(part.transpose(1, 0, 2)).reshape(part.shape[1], -1)
        ours = ground.best_ms(lambda part=part: patch_frames(plan, part))  # type: ignore[misc]
        theirs = ground.best_ms(lambda columns=columns: _by_matmul(dense, columns))  # type: ignore[misc]
        what = f"BID, {n} vertices, {frames} frame{'s' * (frames > 1)} at a time, float32, one thread"
        peer = "numpy matmul of the same equation"
        speed, other = 1000.0 * frames / ours, 1000.0 * frames / theirs
        rows.append(Row(what, speed, "frames/s", bar, True, peer, other, 2.0))
    return rows


def _dense(binding: PatchBinding, patch: npt.NDArray[np.int64], blend: FloatArray) -> npt.NDArray[np.float32]:
    """Return blends of control points as one dense matrix of marker weights, float32."""
    net = binding.surface.net
    total = np.zeros((len(patch), net.shape[1]))
    for k in range(10):
        total += blend[:, k : k + 1] * net[10 * patch + k].toarray()
    return total.astype(np.float32)


def _by_matmul(
    dense: list[npt.NDArray[np.float32]], columns: npt.NDArray[np.float32]
) -> npt.NDArray[np.float32]:
    point, t1, t2 = (np.reshape(d @ columns, (len(d), -1, 3)) for d in dense)
    normal = np.cross(t1, t2)
    return np.asarray(point + LIFT_MM * normal / np.linalg.norm(normal, axis=2, keepdims=True), np.float32)
