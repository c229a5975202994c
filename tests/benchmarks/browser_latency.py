"""From a change to its pixels, in a real Chromium with software WebGL.

Run it as a script; it prints one JSON object::

    python tests/benchmarks/browser_latency.py [--corpus FOLDER] [--json FILE]

`widget`: motion of 3 s at 120 Hz given to a mesh view of the bundled head, until its picture is complete; by
Bezier patches (`bid`) and by the linear basis (`rbf`). `page`: a drag of the g(u) slider with the mouse until
the head's picture is complete. `bars`: figure, bar, and whether it is met; `load`: of the machine before.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from answering import wait_until_answers
from browser import chromium

from workbench.apps.options import free_port

MESH = """(() => {
  const walk = (root) => {
    for (const e of root.querySelectorAll("*")) {
      if (e.tagName === "CANVAS" && e.vsw?.scene) return e.vsw;
      const inside = e.shadowRoot && walk(e.shadowRoot);
      if (inside) return inside;
    }
    return null;
  };
  return walk(document);
})()"""
N_FRAMES, RATE_HZ = 361, 120.0
START, SWING = 0.5, 0.4
"""Where on its length a slider is when its drag begins, and how far it goes to either side."""


def summary(values_ms: Sequence[float]) -> dict[str, float]:
    """Return median, 95th percentile and number of some times."""
    return {
        "median_ms": round(float(np.median(values_ms)), 1),
        "p95_ms": round(float(np.percentile(values_ms, 95)), 1),
        "n": len(values_ms),
    }


def wait_drawn(tab: Any) -> float:
    """Wait for the first picture of the mesh view; return the time since the page was asked for, ms."""
    tab.wait_for_function(f"() => ({MESH}?.first ?? 0) > 0", timeout=60_000)
    return float(tab.evaluate(f"() => {{ const v = {MESH}; v.exact = true; return v.first; }}"))


def playback(tab: Any, seconds: float = 2.5) -> float:
    """Return pictures a second while the clock runs, each complete before the next is begun."""
    return float(
        tab.evaluate(
            f"""async (seconds) => {{
              const v = {MESH};
              const [begun, before] = [performance.now(), v.draws];
              v.clock.start(() => (performance.now() - begun) / 1000);
              await new Promise((done) => setTimeout(done, 1000 * seconds));
              const rate = (v.draws - before) / ((performance.now() - begun) / 1000);
              v.clock.stop();
              v.clock.seek(0);
              return rate;
            }}""",
            seconds,
        )
    )


def triangle(turn: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Return 0 at turn 0, then 1, 0, -1 a quarter apart, in straight lines: no two steps lie close."""
    return np.abs((4 * turn + 3) % 4 - 2) - 1


def measure_drag(tab: Any, slider: Any, n_steps: int = 24) -> tuple[list[float], list[float]]:
    """Drag a slider to and fro with the mouse; return the times from each move to its picture, ms.

    The second list is the part from the arrival of the motion in the browser to its picture.

    Parameters
    ----------
    tab : Page
        Shows a mesh view that has been drawn.
    slider : Locator
        What the mouse takes hold of; its box is the length of the slider.
    n_steps : int
    """
    tab.evaluate(
        """() => addEventListener("pointermove", (e) => { globalThis.vswMoved = e.timeStamp; }, true)"""
    )
    box = slider.bounding_box()
    y = box["y"] + box["height"] / 2
    place = START + SWING * triangle(np.arange(n_steps + 1) / n_steps)
    tab.mouse.move(box["x"] + START * box["width"], y)
    tab.mouse.down()
    tab.wait_for_timeout(1000)
    whole, last = [], []
    for share in place[1:]:
        before = tab.evaluate(f"() => {MESH}.ack")
        tab.mouse.move(box["x"] + float(share) * box["width"], y)
        tab.wait_for_function(f"(n) => {MESH}.ack > n", arg=before, polling=5)
        change = tab.evaluate(f"() => ({{ ...{MESH}.changes.at(-1), moved: globalThis.vswMoved }})")
        whole.append(change["painted"] - change["moved"])
        last.append(change["painted"] - change["received"])
        tab.wait_for_timeout(60)
    tab.mouse.up()
    return whole, last


def measure_widget(browser: Any, deformer: str, n_changes: int = 25) -> dict[str, Any]:
    """Measure a mesh view of the bundled head alone, moved by a deformer."""
    import panel as pn

    from corpus_tools.mesh import DEFORMERS, bundled_head
    from workbench.views.cameras import head_camera
    from workbench.views.head_actors import head_actors
    from workbench.views.mesh_view import MeshView

    head = bundled_head()
    binding = DEFORMERS[deformer](head, tuple(head.markers))
    actors = head_actors(head, binding)
    made: list[tuple[Any, Any]] = []

    def page() -> Any:
        view = MeshView(width=640, height=480, sizing_mode="fixed")
        view.show_actors(actors, camera=head_camera(head))
        made.append((view, pn.state.curdoc))
        return view

    times = np.arange(N_FRAMES) / RATE_HZ
    wave = np.sin(2 * np.pi * 3 * times)[:, None, None] * np.ones((1, len(binding.names), 3), np.float32)
    url, server = chromium.serve(page)
    try:
        tab = browser.new_page(viewport={"width": 900, "height": 700})
        tab.goto(url)
        first_ms = wait_drawn(tab)
        view, doc = made[-1]
        tab.evaluate(f"() => {MESH}.clock.seek(0.1)")
        latencies = []
        for k in range(n_changes):
            told: list[float] = []
            ready = threading.Event()

            def change(k: int = k, told: list[float] = told, ready: threading.Event = ready) -> None:
                told.append(1000 * time.time())
                view.set_motion(RATE_HZ, displacements={"skin": wave * (1 + 0.1 * k)})
                ready.set()

            doc.add_next_tick_callback(change)
            ready.wait(10)
            tab.wait_for_function(f"(n) => {MESH}.changes.length >= n", arg=k + 1, polling=5)
            painted = tab.evaluate(f"() => performance.timeOrigin + {MESH}.changes.at(-1).painted")
            latencies.append(painted - told[0])
        rate = playback(tab)
        tab.close()
    finally:
        server.stop()
    return {
        "vertices": head.n_vertices,
        "markers": len(binding.names),
        "change_to_pixels": summary(latencies),
        "playback_fps": round(rate, 1),
        "first_picture_ms": round(first_ms),
    }


def measure_page(browser: Any, corpus: Path, n_steps: int = 24) -> dict[str, Any]:
    """Measure the blend page on a corpus: a drag of the crossover slider.

    The server is a process of its own, as a person has it: here it would share an interpreter with the mouse.
    """
    port = free_port()
    command = [sys.executable, "-c", "from workbench.apps.main import run; run()"]
    server = subprocess.Popen([*command, str(corpus), "--no-browser", "--port", str(port)])
    try:
        wait_until_answers(f"http://127.0.0.1:{port}/static/js/bokeh.min.js")
        first = []
        for _ in range(2):  # the first tab also opens the corpus; the second finds the server warm
            tab = browser.new_page(viewport={"width": 1440, "height": 900})
            tab.goto(f"http://127.0.0.1:{port}/")
            tab.wait_for_function(f"() => ({MESH}?.motion.frames ?? 0) > 0", timeout=120_000)
            first.append(wait_drawn(tab))
            if len(first) == 1:
                tab.close()
        tab.wait_for_timeout(1000)
        tab.evaluate(f"() => {MESH}.clock.seek(1.0)")
        slider = tab.get_by_role("slider", name="Crossover").locator("xpath=../..")
        latencies, drawing = measure_drag(tab, slider, n_steps)
        rate = playback(tab)
        tab.close()
    finally:
        server.terminate()
        server.wait(20)
    return {
        "drag_to_pixels": summary(latencies),
        "of_which_drawing": summary(drawing),
        "playback_fps": round(rate, 1),
        "first_picture_ms": round(first[0]),
        "first_picture_warm_ms": round(first[1]),
    }


def measure(corpus: Path | None = None) -> dict[str, Any]:
    """Measure widget and page; the page on a simulated corpus when none is given."""
    from playwright.sync_api import sync_playwright

    path = chromium.find_chromium()
    if path is None:
        raise SystemExit("There is no Chromium; on Debian or Ubuntu: apt-get install chromium")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        if corpus is None:
            from corpus_tools.demo import simulate_corpus

            corpus = Path(folder) / "corpus"
            simulate_corpus(corpus)
        browser = playwright.chromium.launch(executable_path=path, args=list(chromium.FLAGS))
        try:
            found: dict[str, Any] = {"load": [round(v, 2) for v in os.getloadavg()]}
            found["widget"] = {name: measure_widget(browser, name) for name in ("bid", "rbf")}
            found["page"] = measure_page(browser, corpus)
            return {**found, "bars": bars(found["page"])}
        finally:
            browser.close()


def bars(page: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Return each figure that has a bar, its bar, and whether it is met."""
    drag = page["drag_to_pixels"]
    figures = {
        "drag to pixels, median ms": (drag["median_ms"], 100),
        "drag to pixels, p95 ms": (drag["p95_ms"], 200),
        "first picture, warm server, ms": (page["first_picture_warm_ms"], 3000),
    }
    return {name: {"is": is_, "bar": bar, "met": is_ <= bar} for name, (is_, bar) in figures.items()}


def run(measured: Callable[[Path | None], dict[str, Any]], description: str) -> None:
    """Measure as the command line says, print the figures as JSON, and write them to a file when asked."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--corpus", type=Path, help="corpus folder for the page; a simulated one by default")
    parser.add_argument("--json", type=Path, help="file to write as well")
    given = parser.parse_args()
    text = json.dumps(measured(given.corpus))
    if given.json:
        given.json.write_text(text + "\n", encoding="utf-8")
    print(text)


if __name__ == "__main__":
    run(measure, "From a change to its pixels in Chromium.")
