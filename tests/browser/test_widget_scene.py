"""What a mesh view shows beside surfaces: lines, scalars with a legend, several characters; and picking."""

import numpy as np
import pytest
import pyvista as pv
from browser.shown import GROUND, SIZE, Shown

from workbench.views.mesh_view import MeshView
from workbench.views.scalars import scalar_colours
from workbench.views.scene_actors import surface_actor

FRONT = {
    "position": [0.0, 0.0, 10.0],
    "focal_point": [0.0, 0.0, 0.0],
    "view_up": [0.0, 1.0, 0.0],
    "view_angle": 30.0,
    "parallel_scale": 0.0,
}
PX = 380 / (2 * 10 * np.tan(np.radians(15)))
UNLIT = {"ambient": 1.0, "diffuse": 0.0}


def plate(x=0.0, y=0.0, size=2.0, resolution=4):
    sides = {"i_size": size, "j_size": size, "i_resolution": resolution, "j_resolution": resolution}
    return pv.Plane(center=(x, y, 0), direction=(0, 0, 1), **sides)


def shown_with(serve, browser_page, *actors, **params):
    def make():
        view = MeshView(ground=GROUND, **{**SIZE, **params})
        view.show_actors(list(actors), camera=FRONT)
        return view

    return Shown(serve, browser_page, make)


def pixel(picture, x, y):
    return picture[int(190 - y * PX), int(210 + x * PX)].astype(int)


def test_lines_wireframes_and_moved_actors_are_drawn_where_they_belong(serve, browser_page):
    line = pv.PolyData([[-2.0, 1.5, 0], [2.0, 1.5, 0]], lines=[2, 0, 1])
    moved = np.eye(4)
    moved[:3, 3] = [1.5, -1, 0]
    shown = shown_with(
        serve,
        browser_page,
        surface_actor("line", line, color="red"),
        surface_actor("wires", plate(-1.5, -1, 1, 2), color="lime", style="wireframe"),
        surface_actor("plate", plate(0, 0, 1), color="white", matrix=moved, **UNLIT),
    )
    picture = shown.pixels().astype(int)
    red = np.argwhere((picture[..., 0] > 100) & (picture[..., 1] < 60))
    assert np.abs(red[:, 0] - (190 - 1.5 * PX)).max() <= 1
    assert np.ptp(red[:, 1]) == pytest.approx(4 * PX, abs=3)
    green = np.argwhere((picture[..., 1] > 100) & (picture[..., 0] < 60))
    assert np.ptp(green, axis=0) == pytest.approx([PX, PX], abs=3)
    assert len(green) < 14 * PX  # the edges of four squares, not their diagonals, not their faces
    assert list(pixel(picture, 1.5, -1)) == [255, 255, 255]
    assert list(pixel(picture, 0.1, 0)) == [0, 0, 255]
    bounds = shown.get('v.scene.actors.get("plate").bounds')
    np.testing.assert_allclose(bounds, [[1, -1.5, 0], [2, -0.5, 0]], atol=1e-6)


def test_scalars_their_legend_and_changes(serve, browser_page):
    surface = plate(size=3, resolution=30)
    height = surface.points[:, 1] * 10
    scalars = scalar_colours(
        height, cmap="gray", clim=(-10, 10), title="Height, mm", below="red", above="lime"
    )
    own = np.full((len(height), 3), 0.5)
    shown = shown_with(
        serve, browser_page, surface_actor("plate", surface, scalars=scalars, colours=own, **UNLIT)
    )
    picture = shown.pixels()
    for y in (-0.8, -0.3, 0.4, 0.9):
        assert np.abs(pixel(picture, 0, y) - 255 * (y + 1) / 2).max() <= 6
    assert list(pixel(picture, 0, 1.2)) == [0, 255, 0]
    assert list(pixel(picture, 0, -1.2)) == [255, 0, 0]
    legend = browser_page.get_by_role("img", name="Colours: Height, mm, \u221210 to 10")
    assert legend.count() == 1
    assert legend.inner_text().split() == ["Height,", "mm", "\u221210", "\u22125", "0", "5", "10"]

    holes = np.where(surface.points[:, 0] > 0, np.nan, height)
    shown.call(lambda: shown.view.set_scalars("plate", holes, cmap="gray", clim=(-10, 10), nan="blue"))
    shown.until("v.ack >= 1")
    picture = shown.pixels()
    assert list(pixel(picture, 0.8, 0.5)) == [0, 0, 255]
    assert np.abs(pixel(picture, -0.8, 0.5) - 191).max() <= 6
    shown.call(lambda: shown.view.set_scalars("plate", None))
    shown.until("v.ack >= 2")
    assert list(pixel(shown.pixels(), 0.8, 0.5)) == [128, 128, 128]
    assert browser_page.locator(".vsw-legend").count() == 0


def test_a_click_picks_vertex_and_place_on_what_moves(serve, browser_page):
    surface = plate(size=2, resolution=4)
    dots = pv.PolyData([[0.8, 1.5, 0.5]])
    shown = shown_with(
        serve,
        browser_page,
        surface_actor("plate", surface, basis=np.ones((25, 1)), ids=100 + np.arange(25)),
        surface_actor("dots", dots, color="red", point_size=9, labels=["chin_1"]),
        surface_actor("glass", plate(0, 1.2, 3), opacity=0.3, pickable=False),
    )
    shift = np.array([[[0.0, -1.0, 0.0]]])
    shown.call(lambda: shown.view.set_motion(1.0, displacements={"plate": shift}))
    shown.until("v.ack >= 1")
    box = browser_page.get_by_role("img", name="3-D view of a head").bounding_box()

    def at(x, y):
        return box["x"] + 210 + x * PX, box["y"] + 190 - y * PX

    def until(read):
        for _ in range(400):
            if read():
                return read()
            browser_page.wait_for_timeout(10)
        raise AssertionError("nothing came")

    browser_page.mouse.click(*at(0.45, -0.62))
    found = until(lambda: shown.view.picked)
    nearest = int(np.linalg.norm(surface.points + shift[0] - [0.45, -0.62, 0], axis=1).argmin())
    assert (found["name"], found["index"]) == ("plate", 100 + nearest)
    np.testing.assert_allclose(found["position"], [0.45, -0.62, 0], atol=0.6 / PX)
    browser_page.mouse.click(*at(0.8 * 10 / 9.5 + 3 / PX, 1.5 * 10 / 9.5))
    assert until(lambda: shown.view.picked.get("label")) == "chin_1"
    browser_page.mouse.click(*at(-2, 1.5))
    until(lambda: not shown.view.picked)

    browser_page.mouse.move(*at(0, -1))
    browser_page.wait_for_timeout(150)
    assert shown.view.hovered == {}
    shown.call(lambda: setattr(shown.view, "hover", True))
    shown.until("v.model.hover")
    browser_page.mouse.move(*at(0.01, -1))
    assert until(lambda: shown.view.hovered)["index"] == 112
    before = dict(shown.view.picked)
    browser_page.mouse.move(*at(0.5, -1))
    browser_page.mouse.down()
    browser_page.mouse.move(*at(1, -1), steps=4)
    browser_page.mouse.up()
    assert shown.view.picked == before  # a drag turns, it does not pick
