"""Head, transport and plot in separate cells of JupyterLab, and behind `panel serve`: one clock, offline."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest
from browser.shown import FIND, FIND_ALL, wait_drawn

from workbench.apps.serving import free_port

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


def start(command: list[str], folder: Path, ready: str) -> subprocess.Popen[bytes]:
    """Start a server of the project in a folder, wait for an address, return the process."""
    paths = os.pathsep.join(p for p in (str(Path.cwd()), os.environ.get("PYTHONPATH", "")) if p)
    private = {f"JUPYTER_{name}_DIR": str(folder / name.lower()) for name in ("CONFIG", "DATA", "RUNTIME")}
    environment = {**os.environ, **private, "PYTHONPATH": paths, "IPYTHONDIR": str(folder / "ipython")}
    environment["PANEL_INLINE"] = "true"  # as make lab does
    with (folder / "log.txt").open("wb") as log:
        process = subprocess.Popen(
            [sys.executable, "-m", *command], cwd=folder, env=environment, stdout=log, stderr=log
        )
    for _ in range(600):
        try:
            urllib.request.urlopen(ready, timeout=5).close()
            return process
        except OSError:
            assert process.poll() is None, (folder / "log.txt").read_text()
            try:
                process.wait(0.1)
            except subprocess.TimeoutExpired:
                continue
    process.terminate()
    raise AssertionError((folder / "log.txt").read_text())


def stop(process: subprocess.Popen[bytes]) -> None:
    process.terminate()
    try:
        process.wait(10)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def write_notebook(path: Path) -> None:
    cells = [
        {
            "cell_type": "code",
            "id": f"c{k}",
            "source": c,
            "metadata": {},
            "outputs": [],
            "execution_count": None,
        }
        for k, c in enumerate(CELLS)
    ]
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    path.write_text(
        json.dumps({"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5})
    )


def seek_and_compare(page) -> None:
    """Move the clock from one cell, and see the pixels and the plot's cursor of the others follow."""
    before = page.evaluate(f"() => {FIND}.vsw.hash()")
    page.evaluate(f"() => {FIND}.vsw.clock.seek(0.5)")
    assert page.evaluate(f"() => {FIND}.vsw.shown") == 60
    assert page.evaluate(f"() => {FIND}.vsw.hash()") != before
    draws = page.evaluate(f"() => {FIND}.vsw.draws")
    page.get_by_role("button", name="Play (Space)").click()
    page.wait_for_function(f"(n) => {FIND}.vsw.clock.t > 0.5 && {FIND}.vsw.draws > n", arg=draws)


def test_jupyterlab_offline_in_separate_cells(watched, tmp_path, project):
    context, watch = watched
    # JupyterLab asks its own server for what is not there; no word of our modules begins so
    watch.expected += ["404 (Not Found)", "400 (Bad Request)"]
    context.set_default_timeout(90_000)
    write_notebook(tmp_path / "cells.ipynb")
    settings = tmp_path / "lab"
    settings.mkdir()
    (settings / "overrides.json").write_text((project / ".ci/lab-overrides.json").read_text())
    port = free_port()
    options = [
        "jupyterlab",
        "--no-browser",
        "--allow-root",
        f"--ServerApp.port={port}",
        "--ServerApp.ip=127.0.0.1",
        "--IdentityProvider.token=widget",
        f"--ServerApp.root_dir={tmp_path}",
        f"--LabApp.app_settings_dir={settings}",
        "--LabApp.extension_manager=readonly",
    ]
    process = start(options, tmp_path, f"http://127.0.0.1:{port}/api?token=widget")
    try:
        page = context.new_page()
        page.goto(f"http://127.0.0.1:{port}/lab/tree/cells.ipynb?token=widget")
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
    port = free_port()
    options = ["panel", "serve", "head.py", "--port", str(port), "--address", "127.0.0.1"]
    options += ["--allow-websocket-origin", f"127.0.0.1:{port}"]
    process = start(options, tmp_path, f"http://127.0.0.1:{port}/static/js/bokeh.min.js")
    try:
        page = context.new_page()
        page.goto(f"http://127.0.0.1:{port}/head")
        wait_drawn(page)
        seek_and_compare(page)
    finally:
        context.close()
        stop(process)
