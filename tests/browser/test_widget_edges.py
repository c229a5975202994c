"""Smooth edges: drawn quickly while something moves where the processor draws, smooth when it rests."""

import numpy as np
import pyvista as pv
from browser.shown import GROUND, SIZE, Shown

from workbench.views.mesh_view import MeshView
from workbench.views.scene_actors import surface_actor


def square():
    view = MeshView(ground=GROUND, **SIZE)
    surface = pv.Plane(i_size=3, j_size=3).rotate_z(17)
    view.show_actors([surface_actor("square", surface, color="white", ambient=1.0, diffuse=0.0)])
    return view


def test_a_picture_at_rest_has_smooth_edges_and_a_moving_one_is_quick(serve, browser_page):
    shown = Shown(serve, browser_page, square)
    assert shown.get("v.scene.slow")  # the browser of these tests draws with the processor
    smooth, quick = (
        shown.array(f"(v.draw({how}), v.scene.pixels())", np.uint8).reshape(380, 420, 4)[..., 0] / 255
        for how in ("true", "false")
    )
    assert np.mean((smooth > 0.1) & (smooth < 0.9)) > 200 / smooth.size
    assert shown.get("[v.scene.quick.width, v.scene.quick.height]") == [210, 190]
    assert 0 < np.abs(quick - smooth).mean() < 0.005  # only edges are coarser
    assert abs(quick.mean() - smooth.mean()) < 0.001

    shown.get("v.draw(false)")
    draws = shown.get("v.draws")
    shown.until("v.draws > a", draws)
    shown.tab.wait_for_timeout(400)
    assert shown.get("v.draws") == draws + 1  # once, not again and again
    picture = np.frombuffer(shown.tab.locator("canvas[role=img]").screenshot(), np.uint8)
    shown.get("v.draw(true)")
    again = np.frombuffer(shown.tab.locator("canvas[role=img]").screenshot(), np.uint8)
    np.testing.assert_array_equal(picture, again)


def test_in_a_drag_edges_stay_quick_whatever_loses_the_focus(serve, browser_page):
    shown = Shown(serve, browser_page, square)
    shown.tab.evaluate("() => document.body.prepend(document.createElement('input'))")
    shown.tab.locator("input").focus()
    shown.tab.mouse.move(300, 700)
    shown.tab.mouse.down()
    shown.tab.evaluate("() => document.activeElement.blur()")
    shown.get("v.draw(false)")
    draws = shown.get("v.draws")
    shown.tab.wait_for_timeout(500)
    assert shown.get("v.draws") == draws
    shown.tab.mouse.up()
    shown.until("v.draws > a", draws)


def test_another_size_has_smooth_edges_too(serve, browser_page):
    shown = Shown(serve, browser_page, square)
    small = shown.pixels()
    shown.call(lambda: shown.view.param.update(width=600, height=500))
    shown.until("v.canvas.width === 600 && v.canvas.height === 500")
    large = shown.pixels()
    assert large.shape == (500, 600, 3)
    share = [np.mean(p[..., 0] > 128) for p in (small, large)]
    assert abs(share[1] - share[0] * (500 / 600) / (380 / 420)) < 0.01
