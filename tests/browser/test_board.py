"""The work area of the blend page on its own."""

import panel as pn

from workbench.views.shell import Board


def test_computing_is_said_after_a_second_without_motion(serve, browser_page):
    made = []

    def page():
        board = Board(working=True, width=1000, height=700, sizing_mode="fixed")
        made.append((board, pn.state.curdoc))
        return board

    browser_page.goto(serve(page))
    busy = browser_page.locator(".over.busy")
    busy.wait_for(state="attached")
    assert busy.is_hidden()
    busy.wait_for()
    board, doc = made[-1]
    doc.add_next_tick_callback(lambda: board.param.update(moves=1))
    busy.wait_for(state="hidden")
    busy.wait_for()
    doc.add_next_tick_callback(lambda: board.param.update(working=False))
    busy.wait_for(state="hidden")
