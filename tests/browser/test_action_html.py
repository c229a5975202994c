"""Buttons that are made as HTML."""

import panel as pn

from workbench.views.action_html import ActionHtml, action_button
from workbench.views.transport import Transport

COPY = '<button data-copy="line">Copy</button><textarea id="line">the line</textarea>'


def test_copy_is_called_copy_again_however_often_it_is_clicked(serve, browser_page):
    browser_page.goto(serve(lambda: ActionHtml(html=COPY)))
    button = browser_page.locator("[data-copy]")
    button.wait_for()
    browser_page.clock.install()
    for _ in range(3):  # the second click finds another label
        button.click()
        browser_page.locator("[data-copy]", has_text="Copied").wait_for()
    browser_page.clock.run_for(2000)
    assert button.inner_text() == "Copy"


def test_space_goes_to_the_transport_after_a_click_that_draws_the_button_anew(serve, browser_page):
    done = []

    def page():
        def act(action, value):
            done.append(action)
            shown.html = action_button("pin", f"Pinned {len(done)}")

        shown = ActionHtml(html=action_button("pin", "Pin"), on_action=act)
        transport = Transport(session="one")
        transport.load_sound(None, 9.0)
        return pn.Column(shown, transport, width=600)

    browser_page.goto(serve(page))
    play = browser_page.locator(".vsw-transport button.play:not([disabled])")
    play.wait_for()
    browser_page.get_by_role("button", name="Pin").click()
    browser_page.get_by_role("button", name="Pinned 1").wait_for()
    browser_page.keyboard.press("Space")
    browser_page.get_by_role("button", name="Pause (Space)").wait_for()
    assert done == ["pin"]
    browser_page.keyboard.press("Tab")  # who walks there with the keyboard means the button
    browser_page.keyboard.press("Shift+Tab")
    browser_page.keyboard.press("Space")
    browser_page.get_by_role("button", name="Pinned 2").wait_for()
