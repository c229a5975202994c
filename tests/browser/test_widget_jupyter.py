"""Head, transport and plot in separate cells of JupyterLab, and behind `panel serve`: one clock, offline."""

from __future__ import annotations

import pytest
from browser.hosts import start_lab, start_panel, stop, write_notebook
from browser.shown import FIND, FIND_ALL, wait_drawn

from workbench.apps.options import free_port

pytestmark = pytest.mark.slow

CELLS = (
    "import numpy as np, panel as pn, pyvista as pv\n"
    "from bokeh.plotting import figure\n"
    "from workbench.views.clock_pane import ClockPane\n"
    "from workbench.views.mesh_view import MeshView\n"
    "from workbench.views.scene_actors import surface_actor\n"
    "from workbench.views.transport import Transport\n"
    "pn.extension(inline=True)",
    "view = MeshView(session='cells', width=300, height=220, sizing_mode='fixed', ground='#0000ff')\n"
    "view.show_actors([surface_actor('ball', pv.Sphere(radius=3), color='white')])\n"
    "places = np.tile(np.eye(4), (241, 1, 1))\n"
    "places[:, 0, 3] = np.linspace(-3, 3, 241)\n"
    "view.set_motion(120.0, rigid={'ball': places})\n"
    "view",
    "transport = Transport(session='cells')\ntransport.load_sound(None, 2.0)\ntransport",
    "import holoviews as hv\n"
    "hv.extension('bokeh', inline=True)\n"
    "curve = hv.Curve(([0, 2], [0, 1]), 't', 'y').opts(width=500, height=160, toolbar=None)\n"
    "pn.Row(ClockPane(pn.pane.HoloViews(curve), session='cells', width=520))",
)
SCRIPT = "\n".join(CELLS[:3]) + "\npn.Column(view, transport).servable()\n"
CURSOR = ".vsw-clock-cursor"


def seek_and_compare(page) -> None:
    """Move the clock from one cell, and see the pixels and the plot's cursor of the others follow."""
    before = page.evaluate(f"() => {FIND}.vsw.hash()")
    page.evaluate(f"() => {FIND}.vsw.clock.seek(0.5)")
    assert page.evaluate(f"() => {FIND}.vsw.shown") == 60
    assert page.evaluate(f"() => {FIND}.vsw.hash()") != before
    draws = page.evaluate(f"() => {FIND}.vsw.draws")
    page.get_by_role("button", name="Play (Space)").click()
    page.wait_for_function(f"(n) => {FIND}.vsw.clock.t > 0.5 && {FIND}.vsw.draws > n", arg=draws)


def test_jupyterlab_offline_in_separate_cells(watched, tmp_path):
    context, watch = watched
    # JupyterLab asks its own server for what is not there; no word of our modules begins so
    watch.expected += ["404 (Not Found)", "400 (Bad Request)"]
    context.set_default_timeout(90_000)
    write_notebook(tmp_path / "cells.ipynb", CELLS)
    process, address = start_lab(tmp_path, free_port())
    try:
        page = context.new_page()
        page.goto(address.format("cells.ipynb"))
        page.locator(".jp-Notebook .jp-CodeCell").nth(3).wait_for()
        page.locator(".jp-NotebookPanel-toolbar").wait_for()
        page.get_by_text("Python 3").first.wait_for()
        page.get_by_role("menuitem", name="Run", exact=True).click()
        page.get_by_text("Run All Cells", exact=True).click()
        wait_drawn(page)
        page.locator(CURSOR).first.wait_for(state="attached")
        told = page.locator(".jp-RenderedText[data-mime-type='application/vnd.jupyter.stderr']")
        assert told.all_inner_texts() == []
        seek_and_compare(page)
        page.wait_for_function(f"() => !{FIND}.vsw.clock.playing")
        place = page.locator(CURSOR).first.evaluate("(e) => e.getBoundingClientRect().x")
        page.evaluate(f"() => {FIND}.vsw.clock.seek(0.4)")
        assert page.evaluate(f"() => {FIND}.vsw.clock.t") == 0.4
        assert page.locator(CURSOR).first.evaluate("(e) => e.getBoundingClientRect().x") != place
        assert page.evaluate(f"() => {FIND_ALL}.length") == 1
    finally:
        context.close()
        stop(process)


def test_a_script_behind_panel_serve(watched, tmp_path):
    context, _ = watched
    context.set_default_timeout(60_000)
    (tmp_path / "head.py").write_text(SCRIPT)
    process, address = start_panel(tmp_path / "head.py", free_port())
    try:
        page = context.new_page()
        page.goto(address)
        wait_drawn(page)
        seek_and_compare(page)
    finally:
        context.close()
        stop(process)
