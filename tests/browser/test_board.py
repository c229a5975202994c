"""The work area of the blend page on its own."""

import panel as pn

from workbench.views.shell import Board

# every change of whether "computing" is shown, with its time: a look now and then could miss one
RECORD = """
window.said = [];
const attach = Element.prototype.attachShadow;
Element.prototype.attachShadow = function (options) {
  const root = attach.call(this, options);
  const look = () => {
    const busy = root.querySelector(".over.busy");
    if (busy && window.said.at(-1)?.[0] !== !busy.hidden) window.said.push([!busy.hidden, performance.now()]);
  };
  new MutationObserver(look).observe(root, { subtree: true, childList: true, attributeFilter: ["hidden"] });
  return root;
};
"""


def test_computing_is_said_after_a_second_without_motion(serve, browser_page):
    made = []

    def page():
        board = Board(working=True, width=1000, height=700, sizing_mode="fixed")
        made.append((board, pn.state.curdoc))
        return board

    def said(changes):
        browser_page.wait_for_function("(n) => window.said.length >= n", arg=changes)

    browser_page.add_init_script(RECORD)
    browser_page.goto(serve(page))
    said(2)
    board, doc = made[-1]
    doc.add_next_tick_callback(lambda: board.param.update(moves=1))
    said(4)
    doc.add_next_tick_callback(lambda: board.param.update(working=False))
    said(5)
    changes = browser_page.evaluate("window.said")
    assert [shown for shown, _ in changes] == [False, True, False, True, False]
    assert changes[3][1] - changes[2][1] > 950
