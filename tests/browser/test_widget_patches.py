"""Bezier patches evaluated by the browser's GPU: the same vertices as the processor, and what shows them."""

import numpy as np
import pytest
from browser.shown import SIZE, Shown

from corpus_tools.mesh import DEFORMERS, bundled_head, level_neck, neck_rim, with_level_neck
from corpus_tools.pipeline import Head
from workbench.views.head_actors import OVERLAYS, head_actors
from workbench.views.mesh_view import MeshView


@pytest.fixture(scope="module")
def heads():
    mesh = bundled_head()
    names = tuple(mesh.markers)
    return {kind: Head(mesh, names, None, DEFORMERS[kind](mesh, names)) for kind in ("bid", "linear")}


def drawn(binding, moved):
    """Return where the vertices are drawn under displacements: the rim of the neck is level, and rests."""
    found = binding.apply(binding.rest_mm + moved, dtype=np.float64)
    return np.stack([with_level_neck(binding.mesh, vertices) for vertices in found])


def positions(shown, name):
    return shown.positions(name)


def test_patches_on_the_gpu_are_those_of_the_processor(heads, serve, browser_page):
    head = heads["bid"]
    binding, mesh = head.binding, head.mesh
    random = np.random.default_rng(11)
    poses = random.normal(0, 4, (6, len(head.names), 3)).astype(np.float32)
    poses[-2] = random.normal(0, 2, 3)  # all together: a shift of the face
    middle = binding.rest_mm.mean(axis=0)
    poses[-1] = middle - binding.rest_mm  # all in one point: no tangents, no normal
    made = [actor for name in OVERLAYS for actor in OVERLAYS[name](binding, "skin")]

    def make():
        view = MeshView(**SIZE)
        view.show_actors([*head_actors(head.mesh, binding), *made])
        moving = [a["name"] for a in view.actors if a["basis"] or a["patches"]]
        assert moving == ["skin", "markers", "surface", "edges", "attachment"]
        view.set_motion(120.0, displacements=dict.fromkeys(moving, poses))
        return view

    shown = Shown(serve, browser_page, make)
    assert len(shown.view.motion["tracks"]) == 1  # sent once for all
    skin = np.frombuffer(shown.view.actor("skin")["ids"], np.uint32)
    wanted = drawn(binding, poses)
    attachment = binding.attachment
    smooth = attachment.patch < 3 * len(binding.surface.chart.triangles)
    sums = np.asarray(binding.surface.net.sum(axis=1)).reshape(-1, 10)
    collapses = smooth & (np.abs(sums - 1) < 1e-9).all(axis=1)[attachment.patch] & (attachment.weight == 1)
    still = np.union1d(np.setdiff1d(skin, binding.driven), neck_rim(mesh))
    for frame in range(len(poses) - 1):
        shown.get(f"v.clock.seek({frame} / 120)")
        shown.until(f"v.shown === {frame}")
        found = positions(shown, "skin")
        assert np.isfinite(found).all()
        assert np.abs(found - wanted[frame][skin]).max() < 1e-3
        rest = level_neck(mesh).vertices_mm[still].astype(np.float32)
        np.testing.assert_array_equal(found[np.searchsorted(skin, still)], rest)
        np.testing.assert_allclose(positions(shown, "markers"), binding.rest_mm + poses[frame], atol=1e-4)
        ends = positions(shown, "attachment").reshape(2, -1, 3)
        hung = binding.apply(binding.rest_mm + poses[frame : frame + 1], dtype=np.float64)[0]
        assert np.abs(ends[0] - hung[attachment.vertices[smooth]]).max() < 1e-3
    shown.get(f"v.clock.seek({len(poses) - 1} / 120)")
    shown.until(f"v.shown === {len(poses) - 1}")
    found = positions(shown, "skin")
    assert np.isfinite(found).all()
    assert collapses.sum() > 50
    whole = np.searchsorted(skin, attachment.vertices[collapses])
    assert np.abs(found[whole] - middle).max() < 1e-3
    assert np.abs(wanted[0] - mesh.vertices_mm).max() > 5


def test_flat_triangles_are_patches_too(heads, serve, browser_page):
    head = heads["linear"]
    binding = head.binding
    pose = np.random.default_rng(2).normal(0, 4, (1, len(head.names), 3)).astype(np.float32)

    def make():
        view = MeshView(**SIZE)
        view.show_actors(head_actors(head.mesh, binding))
        view.set_motion(120.0, displacements={"skin": pose})
        return view

    shown = Shown(serve, browser_page, make)
    skin = np.frombuffer(shown.view.actor("skin")["ids"], np.uint32)
    wanted = drawn(binding, pose)[0, skin]
    assert np.abs(positions(shown, "skin") - wanted).max() < 1e-3


def test_several_heads_in_one_view_each_with_its_own_motion(heads, serve, browser_page):
    mesh, aside = heads["bid"].mesh, np.eye(4)
    aside[0, 3] = 250.0
    shifts = {}

    def make():
        view, actors = MeshView(**SIZE), []
        for name, kind, matrix in (("left/", "bid", None), ("right/", "linear", aside)):
            actors += head_actors(mesh, heads[kind].binding, name, matrix)
            shift = np.random.default_rng(len(name)).normal(0, 2, (1, len(heads[kind].names), 3))
            shifts[f"{name}skin"] = (shift.astype(np.float32), heads[kind].binding)
        view.show_actors(actors)
        view.set_motion(120.0, displacements={name: shift for name, (shift, _) in shifts.items()})
        return view

    shown = Shown(serve, browser_page, make)
    skin = np.frombuffer(shown.view.actor("left/skin")["ids"], np.uint32)
    for name, (shift, binding) in shifts.items():
        wanted = drawn(binding, shift)[0, skin]
        assert np.abs(positions(shown, name) - wanted).max() < 1e-3
    lit = shown.pixels().astype(int)
    halves = [np.abs(half - lit[0, 0]).max(axis=2).mean() for half in np.split(lit, 2, axis=1)]
    assert min(halves) > 10
    assert shown.get("v.camera.focal_point[0]") == pytest.approx(125, abs=15)
