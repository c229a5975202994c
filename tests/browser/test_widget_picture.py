"""The mesh view beside pyvista: the same scene, camera and lights give the same picture."""

import json

import numpy as np
import pytest
from browser.shown import GROUND, SIZE, Shown

from corpus_tools.mesh import bundled_head
from corpus_tools.render import scene
from workbench.views.mesh_view import MeshView
from workbench.views.scene_actors import DEFAULT_LIGHTS


@pytest.mark.parametrize("view", ["front", "three-quarter"])
def test_the_picture_agrees_with_pyvista(offscreen, serve, browser_page, view):
    plotter = scene(bundled_head(), view=view, size=(420, 380), markers=True)
    plotter.set_background(GROUND)
    oracle = np.asarray(plotter.screenshot(return_img=True))[..., :3]

    def make():
        return MeshView(plotter, ground=GROUND, **SIZE)

    shown = Shown(serve, browser_page, make)
    drawn = shown.pixels()
    masks = [np.abs(p.astype(int) - [0, 0, 255]).max(axis=2) > 12 for p in (drawn, oracle)]
    overlap = (masks[0] & masks[1]).sum() / (masks[0] | masks[1]).sum()
    both = masks[0] & masks[1]
    colour = np.abs(drawn[both].astype(int) - oracle[both]).mean()
    print(json.dumps({"view": view, "iou": round(float(overlap), 4), "colour": round(float(colour), 2)}))
    plotter.close()
    assert overlap >= 0.97
    assert colour < 12


def test_default_lights_are_those_of_the_scene(offscreen):
    from workbench.views.plotter_scene import lights_of

    plotter = scene(bundled_head(), size=(60, 60))
    for ours, theirs in zip(DEFAULT_LIGHTS, lights_of(plotter), strict=True):
        np.testing.assert_allclose(ours["colour"], theirs["colour"])
        unit = [np.array(v["direction"]) / np.linalg.norm(v["direction"]) for v in (ours, theirs)]
        np.testing.assert_allclose(*unit, atol=1e-9)
    plotter.close()
