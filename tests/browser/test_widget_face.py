"""The face of a result: the same motion by every deformer, and what shows how it is moved on demand."""

from types import SimpleNamespace

import numpy as np
import panel as pn
from browser.shown import FIND, SIZE, Shown

from corpus_tools.mesh import DEFORMERS, bundled_head
from corpus_tools.pipeline import Animation, Head
from workbench.views.face import Face


def result(kind):
    mesh = bundled_head()
    names = tuple(mesh.markers)
    binding = DEFORMERS[kind](mesh, names)
    shift = np.zeros((31, len(names), 3))
    shift[:, [n.startswith("chin") for n in names], 1] = -np.linspace(0, 6, 31)[:, None]
    return SimpleNamespace(
        head=Head(mesh, names, None, binding),
        trajectory=SimpleNamespace(rate_hz=30.0, times_s=np.arange(31) / 30.0),
        animation=Animation(
            np.arange(31) / 30.0, binding.rest_mm + shift, binding.rigid(binding.rest_mm + shift)
        ),
    )


def shares(shown):
    """Return how much of the picture is blue, and how much orange."""
    return shown.get("""(() => {
      const p = v.pixels();
      let [blue, orange] = [0, 0];
      for (let i = 0; i < p.length; i += 4) {
        blue += p[i + 2] > p[i] + 30;
        orange += p[i] > 150 && p[i + 1] < 110 && p[i + 2] < 70;
      }
      return [blue, orange].map((n) => (4 * n) / p.length);
    })()""")


def test_overlays_appear_on_demand_move_and_go(serve, browser_page):
    faces, spoken = [], result("bid")

    def make():
        face = Face("one", "light")
        face.show(spoken)
        faces.append(face)
        return pn.Column(face, **SIZE)

    shown = Shown(serve, browser_page, make)
    face = faces[-1]
    assert face.has_surface
    blue, orange = shares(shown)
    assert blue == 0
    assert "surface" not in shown.get("[...v.scene.actors.keys()]")

    shown.call(lambda: face.param.update(show_surface=True, show_markers=True))
    shown.until('v.scene.actors.get("edges")?.deformer && v.motion.tracks[0].actors.includes("edges")')
    assert shares(shown)[0] > 0.1
    before = shown.positions("surface").ravel()
    shown.get("v.clock.seek(0.9)")
    assert np.abs(shown.positions("surface").ravel() - before).max() > 3

    shown.call(lambda: face.param.update(show_surface=False, show_markers=False, show_attachment=True))
    shown.until('v.scene.actors.get("attachment")?.visible && !v.scene.actors.get("surface").visible')
    after = shares(shown)
    assert after[0] == 0
    assert after[1] > orange + 0.005
    # hidden ones do not move; shown again they stand where the clock is
    shown.get("v.clock.seek(0.2)")
    shown.call(lambda: face.param.update(show_surface=True, show_attachment=False))
    shown.until('v.scene.actors.get("surface").visible && !v.scene.actors.get("attachment").visible')
    there = shown.positions("surface")
    shown.get("v.clock.seek(0.9), v.clock.seek(0.2)")
    np.testing.assert_allclose(shown.positions("surface").ravel(), there.ravel(), atol=1e-4)

    shown.call(lambda: face.show(result("rbf")))
    shown.until('v.scene.actors.get("skin").deformer.constructor.name === "BasisDeformer"')
    assert not face.has_surface
    assert "surface" not in shown.get("[...v.scene.actors.keys()]")
    assert browser_page.evaluate(f"() => {FIND}.vsw.scene.actors.get('skin').opacity") == 1
