"""The page of a small simulated corpus in a tab, as the tests of the page look at it."""

from __future__ import annotations

import re


def lane(tab):
    return tab.locator(".vsw-lane canvas")


def drawn(tab, served):
    """Open the page; return its session once lane and head show the first sentence."""
    url, workbench, _ = served
    before = set(workbench.pages)
    tab.goto(url)
    lane(tab).wait_for(timeout=30_000)
    (page,) = set(workbench.pages) - before
    session = page.session
    settled(tab, session)
    until(tab, lambda: lane(tab).evaluate("c => (c.vsw.state.score?.fragments.length ?? 0) > 0"))
    tab.get_by_role("button", name=re.compile("recordings")).wait_for()  # no control missed its first change
    return session


def until(tab, condition, timeout_ms=30_000):
    waited = 0
    while not condition():
        assert waited < timeout_ms, "the page did not get there"
        tab.wait_for_timeout(25)
        waited += 25


def settled(tab, session):
    """Wait until what is shown is what the settings say."""

    def shown():
        result, request = session.result, session.request()
        if result is None or session.working:
            return False
        return result.request.same_target(request) and result.request.config == request.config

    until(tab, shown)
