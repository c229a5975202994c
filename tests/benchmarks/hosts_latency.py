"""A head and a slider of g(u) behind `panel serve` and in JupyterLab, as a script and as a cell have them.

Run it as a script; it prints one JSON object::

    python tests/benchmarks/hosts_latency.py [--corpus FOLDER] [--json FILE]

In both, the slider blends anew and the head moves: from each move of the mouse to the complete picture. The
first picture is timed from the moment the head is asked for: the page of `panel serve`, whose process has
served one before, or the cell of JupyterLab, whose kernel has opened the corpus.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

from benchmarks.browser_latency import MESH, bars, measure_drag, playback, run, summary, wait_drawn
from browser import chromium
from browser.hosts import start_lab, start_panel, stop, write_notebook

from workbench.apps.options import free_port

OPENED = """\
import panel as pn
from corpus_tools.config import Config, config_with
from corpus_tools.pipeline import align_units, animate, blend_units, open_corpus, prepare_head, synthesise
from workbench.views.prompt import prompt
from workbench.views.speaking_head import move_head, show_head
pn.extension(inline=True)
config = Config()
corpus = open_corpus({corpus!r})
target = corpus.recordings[0].utterance
head = prepare_head(corpus, config.deform.mesh, config)
synthesis = synthesise(corpus, target, config, head, exclude=[target.name])
pieces = align_units(corpus, target, synthesis.selection, config)
"""
SHOWN = """\
view = show_head(head, synthesis.animation, height=400)
slider = prompt(pn.widgets.FloatSlider(name="Crossover", start=-1, end=1, step=0.001, value=0.0, width=420))

def blend(event):
    changed = config_with(config, blend__shape=event.new)
    move_head(view, head, animate(head, blend_units(corpus, target, pieces, changed)))

slider.param.watch(blend, "value")
"""
LAID_OUT = "pn.Column(view, slider, width=640)"


def drag(tab: Any) -> dict[str, Any]:
    """Return the figures of a view that is drawn and of the slider beneath it, which is at its middle."""
    tab.evaluate(f"() => {MESH}.clock.seek(1.0)")
    slider = tab.locator(".noUi-target").first
    slider.scroll_into_view_if_needed()
    whole, drawing = measure_drag(tab, slider)
    return {
        "drag_to_pixels": summary(whole),
        "of_which_drawing": summary(drawing),
        "playback_fps": round(playback(tab), 1),
    }


def behind_panel_serve(browser: Any, corpus: Path, folder: Path) -> dict[str, Any]:
    """Measure the script behind `panel serve`; the first of two pages opens the corpus."""
    script = folder / "head.py"
    kept = "import panel as pn\n\n@pn.cache\ndef opened():\n"
    body = "".join(f"    {line}\n" for line in OPENED.format(corpus=str(corpus)).splitlines())
    script.write_text(
        f"{kept}{body}    return locals()\n\nglobals().update(opened())\n{SHOWN}{LAID_OUT}.servable()\n"
    )
    process, address = start_panel(script, free_port())
    try:
        first = []
        for _ in range(2):
            tab = browser.new_page(viewport={"width": 900, "height": 700})
            tab.goto(address, timeout=60_000)
            first.append(wait_drawn(tab))
            if len(first) == 1:
                tab.close()
        tab.wait_for_timeout(1000)
        return {**drag(tab), "first_picture_warm_ms": round(first[1])}
    finally:
        stop(process)


def in_jupyterlab(browser: Any, corpus: Path, folder: Path) -> dict[str, Any]:
    """Measure the cells of a notebook; the last of them shows the head."""
    write_notebook(folder / "cells.ipynb", [OPENED.format(corpus=str(corpus)) + "'opened'", SHOWN + LAID_OUT])
    process, address = start_lab(folder, free_port())
    try:
        tab = browser.new_page(viewport={"width": 1100, "height": 900})
        tab.set_default_timeout(90_000)
        tab.goto(address.format("cells.ipynb"))
        cells = tab.locator(".jp-Notebook .jp-CodeCell")
        tab.get_by_text("Python 3").first.wait_for()
        cells.nth(0).locator(".cm-content").click()
        tab.keyboard.press("Shift+Enter")
        tab.locator(".jp-OutputArea-output", has_text="opened").first.wait_for()
        cells.nth(1).locator(".cm-content").click()
        asked = time.monotonic()
        tab.keyboard.press("Control+Enter")
        wait_drawn(tab)
        first_ms = 1000 * (time.monotonic() - asked)
        tab.wait_for_timeout(1000)
        return {**drag(tab), "first_picture_warm_ms": round(first_ms)}
    finally:
        stop(process)


HOSTS = {"panel serve": behind_panel_serve, "JupyterLab": in_jupyterlab}


def measure(corpus: Path | None = None) -> dict[str, Any]:
    """Measure every host; on a simulated corpus when none is given."""
    import panel
    from playwright.sync_api import sync_playwright

    path = chromium.find_chromium()
    if path is None:
        raise SystemExit("There is no Chromium; on Debian or Ubuntu: apt-get install chromium")
    found: dict[str, Any] = {"load": [round(v, 2) for v in os.getloadavg()], "panel": panel.__version__}
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        if corpus is None:
            from corpus_tools.demo import simulate_corpus

            corpus = Path(folder) / "corpus"
            simulate_corpus(corpus)
        browser = playwright.chromium.launch(executable_path=path, args=list(chromium.FLAGS))
        try:
            for name, measure_host in HOSTS.items():
                (own := Path(folder) / name.replace(" ", "-")).mkdir()
                figures = measure_host(browser, corpus.absolute(), own)
                found[name] = {**figures, "bars": bars(figures)}
        finally:
            browser.close()
    return found


if __name__ == "__main__":
    run(measure, "A head and g(u) behind panel serve and in JupyterLab.")
