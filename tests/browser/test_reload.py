"""A tab that is reloaded goes on where it was."""

from browser.paged import drawn, settled, until


def page_of(served, session):
    return next(p for p in served[1].pages if p.session is session)


def test_a_reloaded_tab_goes_on_where_it_was_and_another_begins_anew(browser_page, served):
    session = drawn(browser_page, served)
    browser_page.keyboard.press("]")
    settled(browser_page, session)
    browser_page.keyboard.press("1")
    settled(browser_page, session)
    until(browser_page, lambda: session.weighting == "linear" and not page_of(served, session).journal.busy)
    again = drawn(browser_page, served)
    assert again is not session
    until(browser_page, lambda: again.values == session.values)
    settled(browser_page, again)
    assert len(again.history.entries) == len(session.history.entries) == 3
    browser_page.keyboard.press("Control+z")
    until(browser_page, lambda: again.weighting == "smootherstep")
    other = drawn(browser_page.context.new_page(), served)
    assert len(other.history.entries) == 1
    assert other.sentence != again.sentence


def test_an_exported_config_is_opened_again(browser_page, served):
    session = drawn(browser_page, served)
    browser_page.keyboard.press("1")
    until(browser_page, lambda: session.weighting == "linear")
    wanted = session.values
    browser_page.get_by_label("Config file").fill(str(served[2] / "again.toml"))
    browser_page.get_by_role("button", name="Export").click()
    browser_page.get_by_text("Config written").wait_for()
    browser_page.get_by_role("button", name="Undo").click()
    until(browser_page, lambda: session.weighting == "smootherstep")
    browser_page.get_by_label("Config file").fill(str(served[2] / "again.toml"))
    browser_page.get_by_role("button", name="Open the config of this file").click()
    browser_page.get_by_text("Config opened").wait_for()
    assert {**session.values, "base": None} == {**wanted, "base": None}
