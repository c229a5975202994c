"""A mesh view served to a tab, as the tests of the mesh view look at it."""

from __future__ import annotations

import base64
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
        picture = self.array("v.pixels()", np.uint8)
        width, height = self.get("[v.canvas.width, v.canvas.height]")
        return picture.reshape(height, width, 4)[::-1, :, :3]

    def array(self, expression, dtype=np.float32):
        """Return a typed array of the browser; as text, for a list of numbers takes seconds."""
        return np.frombuffer(base64.b64decode(self.get(f"({AS_TEXT})({expression})")), dtype)

    def positions(self, name):
        """Return the points of an actor as the graphics has them, (n, 3)."""
        return self.array(f"v.positions({name!r})").reshape(-1, 3)


AS_TEXT = """(values) => {
  const bytes = new Uint8Array(values.buffer, values.byteOffset, values.byteLength);
  const parts = [];
  for (let i = 0; i < bytes.length; i += 8192)
    parts.push(String.fromCharCode(...bytes.subarray(i, i + 8192)));
  return btoa(parts.join(""));
}"""


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
