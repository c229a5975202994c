"""WebGL contexts: lost and given back, given up when a view goes, more views than a browser allows."""

import numpy as np
import panel as pn
import pytest
import pyvista as pv
from browser.shown import FIND, FIND_ALL, GROUND, SIZE, Shown, wait_drawn

from workbench.views.mesh_view import MeshView
from workbench.views.scene_actors import surface_actor

N_VIEWS = 17


def plate(colour="red", **style):
    surface = pv.Plane(i_size=3, j_size=3, i_resolution=4, j_resolution=4)
    basis = np.eye(25)
    return surface_actor("plate", surface, color=colour, basis=basis, ambient=1.0, diffuse=0.0, **style)


def view_of(*actors, **params):
    view = MeshView(ground=GROUND, **{**SIZE, **params})
    view.show_actors(list(actors))
    return view


def test_a_lost_context_comes_back_with_everything_that_changed_since(serve, browser_page):
    shown = Shown(serve, browser_page, lambda: view_of(plate()))
    wires = surface_actor("wires", pv.Plane(i_size=1, j_size=1), color="lime", style="wireframe")
    rest = np.frombuffer(shown.view.actor("plate")["points"], np.float32).reshape(-1, 3)

    def change():
        shown.view.add_actors([wires])
        shown.view.set_style("plate", opacity=0.5)
        shown.view.push_points("plate", rest * 0.9)
        shown.view.set_scalars("plate", rest[:, 0], cmap="plasma", title="x")

    shown.call(change)
    shown.until("v.ack >= 2")
    shown.call(lambda: shown.view.set_motion(1.0, displacements={"plate": np.full((1, 25, 3), 0.3)}))
    shown.until("v.ack >= 3")
    before = shown.get("v.hash()")
    shown.get('(v.loser = v.scene.gl.getExtension("WEBGL_lose_context")).loseContext()')
    shown.until("v.lost")
    # what comes while there is none is kept, too
    shown.call(lambda: shown.view.set_style("wires", visible=False))
    shown.call(lambda: shown.view.set_scalars("plate", rest[:, 1], cmap="plasma", title="x"))
    shown.until('v.specs.get("wires").visible === false && v.waiting.length > 0')
    shown.get("v.loser.restoreContext()")
    shown.until("!v.lost && v.ack >= 4")
    after = shown.get("v.hash()")
    assert after != before
    shown.call(lambda: shown.view.set_style("wires", visible=True))
    shown.call(lambda: shown.view.set_scalars("plate", rest[:, 0], cmap="plasma", title="x"))
    shown.until('v.ack >= 5 && v.scene.actors.get("wires").visible')
    assert shown.get("v.hash()") == before


# Bokeh sends a model that comes back whole, and then wonders that the server has it
@pytest.mark.filterwarnings("ignore:reference already known")
def test_a_view_rendered_again_shows_what_changed_since(serve, browser_page):
    columns = []

    def make():
        view = view_of(plate())
        columns.append((pn.Column(view), view, pn.state.curdoc))
        return columns[-1][0]

    shown = Shown(serve, browser_page, make)
    column, view, _ = columns[-1]

    def change():
        view.add_actors([surface_actor("more", pv.Plane(i_size=1, j_size=1), color="lime")])
        view.set_style("plate", visible=False)
        view.set_scalars("more", np.zeros(121), title="t", clim=(0, 1))

    shown.call(change)
    shown.until("v.ack >= 1")
    wanted = shown.get("v.hash()")
    browser_page.evaluate(f"() => {{ window.kept = {FIND}; }}")
    shown.call(column.clear)
    browser_page.wait_for_function("() => kept.vsw.dead")
    shown.call(lambda: column.append(view))
    wait_drawn(browser_page)
    shown.until('v.scene.actors.get("plate").visible === false && v.specs.get("more")?.scalars')
    assert shown.get("v.hash()") == wanted


def test_more_views_than_contexts_all_show_their_picture(serve, browser_page):
    def make():
        shades = [f"#ff{8 * k:02x}00" for k in range(N_VIEWS)]
        return pn.Column(*[view_of(plate(s), width=300, height=200) for s in shades])

    browser_page.goto(serve(make))
    browser_page.wait_for_function(f"() => {FIND_ALL}.length === {N_VIEWS}")
    live = "globalThis[Symbol.for('vsw.contexts')].size"
    browser_page.wait_for_function(f"() => {live} <= 14 && {FIND_ALL}[0].vsw.draws > 0")
    seen = []
    for k in range(N_VIEWS):
        browser_page.evaluate(f"() => {FIND_ALL}[{k}].scrollIntoView()")
        browser_page.wait_for_function(
            f"() => {{ const v = {FIND_ALL}[{k}].vsw; return !v.lost && v.draws > 0 && !v.loan.still; }}"
        )
        seen.append(browser_page.evaluate(f"() => [...{FIND_ALL}[{k}].vsw.pixels()].slice(120600, 120603)"))
        assert browser_page.evaluate(live) <= 14
    assert seen == [[255, 8 * k, 0] for k in range(N_VIEWS)]
    stills = browser_page.get_by_role("img", name="a still picture")
    assert stills.count() >= N_VIEWS - 14
    assert all(
        src.startswith("data:image/png") for src in stills.evaluate_all("all => all.map((e) => e.src)")
    )
