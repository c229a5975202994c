"""A mesh view served to a tab, as the tests of the mesh view look at it."""

from __future__ import annotations

import threading
import time

import numpy as np

SIZE = {"width": 420, "height": 380, "sizing_mode": "fixed"}
GROUND = "#0000ff"


class Shown:
    """A served view of one session, its tab, and a way to call its methods in the server's thread."""

    def __init__(self, serve, browser_page, make):
        self.views, self.docs = [], []
        self.tab = browser_page

        def page():
            import panel as pn

            view = make()
            self.views.append(view)
            self.docs.append(pn.state.curdoc)
            return view

        self.url = serve(page)
        self.tab.goto(self.url)
        wait_drawn(self.tab)
        # the server builds one page beforehand for nobody; the newest belongs to the tab
        self.view, self.doc = self.views[-1], self.docs[-1]
        if hasattr(self.view, "_line"):
            self.wait_heard()

    def wait_heard(self, longest_s=20.0):
        """Wait until the server knows that the tab draws; what is sent before goes out unasked."""
        until = time.monotonic() + longest_s
        while not self.view._line.listening:
            assert time.monotonic() < until, "the tab draws and the server was not told"
            self.tab.wait_for_timeout(20)

    def call(self, action):
        """Run `action` where the parameters of the session may be set, and wait for it."""
        done, caught = threading.Event(), []

        def run():
            try:
                action()
            except Exception as error:
                caught.append(error)
            done.set()

        self.doc.add_next_tick_callback(run)
        assert done.wait(20)
        if caught:
            raise caught[0]

    def until(self, expression, argument=None):
        self.tab.wait_for_function(f"(a) => {{ const v = {FIND}.vsw; return {expression}; }}", arg=argument)

    def get(self, expression):
        return self.tab.evaluate(f"() => {{ const v = {FIND}.vsw; return {expression}; }}")

    def pixels(self):
        """Return the picture, (height, width, 3), top row first."""
        found = self.get(
            "(() => { const p = v.pixels(); return [v.canvas.width, v.canvas.height, [...p]]; })()"
        )
        width, height, values = found
        return np.array(values, np.uint8).reshape(height, width, 4)[::-1, :, :3]


FIND_ALL = """(() => {
  const found = [];
  const walk = (root) => {
    for (const e of root.querySelectorAll("*")) {
      if (e.tagName === "CANVAS" && e.vsw?.scene) found.push(e);
      if (e.shadowRoot) walk(e.shadowRoot);
    }
  };
  walk(document);
  return found;
})()"""
FIND = f"{FIND_ALL}[0]"


def wait_drawn(tab):
    tab.wait_for_function(f"() => {FIND}?.vsw.draws > 0")
