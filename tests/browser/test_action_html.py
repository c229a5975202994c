"""Buttons that are made as HTML."""

from workbench.views.action_html import ActionHtml

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
