"""One clock for all views of a page: heads, plots, transport."""

import io

import holoviews as hv
import numpy as np
import panel as pn
import pytest
import pyvista as pv
from bokeh.plotting import figure
from PIL import Image

from workbench.views.clock_pane import ClockPane
from workbench.views.mesh_view import MeshView
from workbench.views.theme import palettes
from workbench.views.transport import Transport

hv.extension("bokeh")
RATE_HZ = 120
N = 2401
MAGENTA = palettes()["light"]["cursor"]


def moving_sphere(session):
    scene = pv.Plotter(off_screen=True)
    scene.add_mesh(pv.Sphere(radius=5), name="ball", color="white")
    scene.view_xy()
    view = MeshView(scene, session=session, height=200, width=300, sizing_mode="fixed")
    matrices = np.tile(np.eye(4), (N, 1, 1))
    matrices[:, 0, 3] = np.linspace(-4, 4, N)
    view.set_motion(RATE_HZ, rigid={"ball": matrices})
    return view


def plot(mark_s):
    made = figure(width=500, height=160, x_range=(0.0, 2.0), y_range=(0, 1), toolbar_location=None)
    made.vspan([mark_s], line_color="#0000ff", line_width=1)
    return made


@pytest.fixture
def page(serve, browser_page):
    def make():
        transport = Transport(session="shared")
        transport.load_sound(None, 20.0)
        curve = hv.Curve(([0, 2], [0, 1]), "t", "y").opts(width=500, height=160, toolbar=None)
        return pn.Column(
            transport,
            pn.Row(moving_sphere("shared"), moving_sphere("shared"), moving_sphere("other")),
            ClockPane(plot(1.5), session="shared", width=520),
            ClockPane(pn.pane.HoloViews(curve), session="shared", width=520),
            width=1200,
        )

    browser_page.goto(serve(make))
    browser_page.locator(".vsw-clock-cursor").nth(1).wait_for(state="attached")
    browser_page.locator("canvas[role=img]").nth(2).wait_for()
    return browser_page


def test_all_views_show_the_same_time_in_the_same_frame(page):
    bar = page.locator(".vsw-transport")
    page.keyboard.press("Space")
    heads = [head.element_handle() for head in page.locator("canvas[role=img]").all()]
    seen = bar.evaluate(
        """(e, heads) => new Promise((done) => {
          const c = e.vsw.clock, rows = [];
          const off = c.add((t, playing) => {
            const text = e.querySelector(".now").textContent;
            if (playing) rows.push([t, c.frame, ...heads.map((h) => h.vsw.shown), text]);
            if (rows.length === 6) { off(); c.stop(); done(rows); }
          });
        })""",
        heads,
    )
    assert len({row[1] for row in seen}) == 6
    for t, _, one, two, other, text in seen:
        assert one == two == pytest.approx(min(t * RATE_HZ, N - 1), abs=2e-3)
        assert text == f"{t:.3f}"
        assert other == 0
    assert seen[-1][0] > seen[0][0]


def columns(png, colour):
    """Return the mean x of the pixels nearest a colour."""
    picture = np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), int)
    wanted = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)])
    near = np.abs(picture - wanted).sum(axis=2) < 60
    assert near.any(), f"nothing is {colour}"
    return np.nonzero(near)[1].mean()


def test_the_cursor_stands_where_the_plot_draws_that_time(page):
    bar = page.locator(".vsw-transport")
    box = page.locator(".bk-Figure").first.bounding_box()
    area = {"x": box["x"], "y": box["y"], "width": 520, "height": 160}
    bar.evaluate("e => e.vsw.clock.seek(0.5)")
    mark = columns(page.screenshot(clip=area), "#0000ff")
    places = []
    for t in (0.5, 1.5):
        bar.evaluate("(e, t) => e.vsw.clock.seek(t)", t)
        places.append(columns(page.screenshot(clip=area), MAGENTA))
    assert places[1] == pytest.approx(mark, abs=1.0)
    assert places[1] - places[0] > 150


def test_a_cursor_out_of_view_is_not_shown(page):
    bar = page.locator(".vsw-transport")
    cursor = page.locator(".vsw-clock-cursor").first
    assert cursor.is_visible()
    bar.evaluate("e => e.vsw.clock.seek(2.5)")
    assert not cursor.is_visible()


def test_a_view_that_fails_does_not_hold_up_the_others(page):
    # console.error is what it must leave behind; this page's watch would otherwise fail the test
    page.evaluate("() => { console.error = (e) => { window.said = String(e) } }")
    after = page.locator(".vsw-transport").evaluate(
        """e => {
          const c = e.vsw.clock;
          let seen = -1;
          const bad = c.add(() => { if (c.t === 0.25) throw new Error("broken view") });
          const good = c.add((t) => { seen = t });
          c.seek(0.25);
          bad(); good();
          return seen;
        }"""
    )
    assert after == 0.25
    assert "broken view" in page.evaluate("window.said")
