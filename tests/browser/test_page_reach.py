"""What the page shows can be reached, read whole and told apart, and what it writes is where it says."""

import itertools

import pytest
from browser import chromium as shared
from browser.paged import drawn, lane, settled, until
from browser.shown import FIND, FIND_ALL

from corpus_tools.config import load_config


@pytest.fixture(scope="module")
def opened(chromium, served):
    """Return one tab for all tests here, and its session: each leaves the page on the lane, in light."""
    context = chromium.new_context(viewport={"width": 1440, "height": 900}, device_scale_factor=1)
    context.set_default_timeout(shared.TIMEOUT_MS)
    watch = shared.Watch(context)
    tab = context.new_page()
    yield tab, drawn(tab, served)
    context.close()
    assert not watch.unexpected(), "\n".join(watch.unexpected())


def test_compare_and_history_are_in_view_and_settings_fold_out(opened):
    """At 1440 x 900 nothing of the inspector has to be scrolled to, with a join selected and A beside B."""
    browser_page, session = opened
    browser_page.keyboard.press("l")
    until(browser_page, lambda: session.selected == 1)
    browser_page.keyboard.press("1")
    settled(browser_page, session)
    until(browser_page, lambda: session.other is not None)
    inspector = browser_page.locator(".inspector > .scroll")
    row = browser_page.get_by_role("listbox", name="States of this session").get_by_role("option").first
    row.wait_for()

    def in_view(part):
        box, around = part.bounding_box(), inspector.bounding_box()
        bottom = around["y"] + around["height"]
        return box is not None and around["y"] <= box["y"] <= box["y"] + box["height"] <= bottom

    for part in (browser_page.get_by_role("button", name="Keep as A"), row):
        until(browser_page, lambda part=part: in_view(part), 5000)
    assert inspector.evaluate("e => e.scrollTop") == 0
    method = browser_page.get_by_label("Method")
    assert method.count() == 0 or not method.first.is_visible()
    browser_page.get_by_role("button", name="Settings").click()
    browser_page.get_by_label("Method").first.wait_for()
    browser_page.get_by_role("button", name="Settings").click()
    browser_page.get_by_label("Method").first.wait_for(state="hidden")


def test_every_join_in_view_has_a_badge_and_w_goes_to_the_overlap(opened):
    browser_page, session = opened
    until(browser_page, lambda: lane(browser_page).evaluate("c => c.vsw.state.badges?.length > 0"))
    badges = lane(browser_page).evaluate("c => c.vsw.state.badges.map(({left, w}) => [left, w])")
    assert len(badges) == len(session.result.trajectory.joins)
    assert all(a + w < b for (a, w), (b, _) in itertools.pairwise(badges))
    inside = lane(browser_page).evaluate("c => [c.vsw.state.box.left, c.vsw.state.box.right]")
    assert badges[0][0] >= inside[0] - 0.01
    assert sum(badges[-1]) <= inside[1] + 0.01

    browser_page.keyboard.press("w")
    browser_page.keyboard.press("ArrowLeft")
    until(browser_page, lambda: session.overlap_s == 0.115)
    browser_page.keyboard.press("2")  # letters and digits still act
    until(browser_page, lambda: session.weighting == "raised-cosine")


def test_the_wheel_zooms_the_recorded_head_too_and_0_resets_both(opened):
    browser_page, _ = opened
    far = "Math.hypot(...v.camera.position.map((p, k) => p - v.camera.focal_point[k]))"
    both = f"{FIND_ALL}.slice(0, 2).map((c) => c.vsw).map((v) => {far})"
    box = browser_page.locator(".over.inset:not(.gone)").bounding_box()
    at_first = browser_page.evaluate(both)
    browser_page.mouse.move(box["x"] + 60, box["y"] + 60)  # over the recorded head it is the same wheel
    browser_page.mouse.wheel(0, 300)
    browser_page.wait_for_function(f"(a) => {both}.every((f, i) => f > 1.2 * a[i])", arg=at_first)
    browser_page.keyboard.press("0")
    browser_page.wait_for_function(f"(a) => {both}.every((f, i) => Math.abs(f - a[i]) < 1e-6)", arg=at_first)


def test_an_export_goes_beside_the_corpus_and_its_line_is_copied_whole(opened, served):
    browser_page, session = opened
    browser_page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    field = browser_page.get_by_label("Config file")
    place = str(served[2] / "exports" / f"{session.sentence}.toml")  # under the root of the server
    until(browser_page, lambda: field.input_value() == place)
    field.fill("mine")
    browser_page.keyboard.press("Tab")
    browser_page.get_by_role("button", name="Export").click()
    browser_page.get_by_text(f"Config written: {served[2] / 'exports' / 'mine.toml'}").wait_for()
    assert load_config(served[2] / "exports" / "mine.toml").values() == session.config.values()
    line = browser_page.get_by_label("Command that replays it")
    assert line.evaluate("e => e.scrollHeight <= e.clientHeight")
    browser_page.get_by_role("button", name="Copy", exact=True).click()
    browser_page.get_by_role("button", name="Copied").wait_for()
    assert browser_page.evaluate("navigator.clipboard.readText()") == line.input_value()
    browser_page.get_by_role("button", name="Put this away").click()
    line.wait_for(state="detached")


def test_trajectories_say_that_they_are_drawn_and_follow_the_theme(opened):
    browser_page, _ = opened
    note = browser_page.get_by_text("Drawing the trajectories")
    browser_page.keyboard.press("v")
    note.wait_for()
    browser_page.locator(".slot.curves .bk-Canvas").first.wait_for()
    ground = """() => {
      const deep = (root, test) => {
        for (const e of root.querySelectorAll("*")) {
          if (test(e)) return e;
          const found = e.shadowRoot && deep(e.shadowRoot, test);
          if (found) return found;
        }
        return null;
      };
      const plot = deep(document, (e) => e.classList.contains("bk-Canvas"));
      const canvas = deep(plot.shadowRoot ?? plot, (e) => e.tagName === "CANVAS");
      return [...canvas.getContext("2d").getImageData(3, 3, 1, 1).data];
    }"""
    until(browser_page, lambda: browser_page.evaluate(ground)[3] == 255)
    seen = browser_page.evaluate(ground)
    browser_page.keyboard.press("t")
    until(browser_page, lambda: browser_page.evaluate(ground) != seen, 3000)
    browser_page.keyboard.press("t")
    browser_page.keyboard.press("v")
    lane(browser_page).wait_for()


def test_the_corpus_page_says_what_is_there_and_a_row_is_spoken(opened):
    browser_page, session = opened
    browser_page.get_by_role("button", name="Corpus", exact=True).click()
    browser_page.get_by_role("img", name="diphones recorded").wait_for()
    rows = browser_page.locator('tr[data-action="speak"]')
    assert rows.count() == len(session.corpus.names)
    name = rows.nth(2).get_attribute("data-value")
    rows.nth(2).click()
    until(browser_page, lambda: session.sentence == name)
    lane(browser_page).wait_for()


def test_several_heads_speak_side_by_side(opened):
    browser_page, session = opened
    browser_page.get_by_role("button", name="Several heads").click()
    browser_page.wait_for_function(f"() => {FIND}.vsw.scene.actors.has('female/skin')")
    until(browser_page, lambda: [r.head.mesh.name for r in session.cast] == ["female", "male"])
    browser_page.locator(".over.inset.gone").wait_for(state="attached")
    box = browser_page.locator(".slot.face").first.bounding_box()
    y, height = box["y"] + 0.45 * box["height"], 0.5 * box["height"]
    right = {"x": box["x"] + 0.7 * box["width"], "y": y, "width": 0.29 * box["width"], "height": height}

    def at_rest():  # a moving view draws fewer pixels than one that rests
        seen = []

        def still():
            seen.append(browser_page.screenshot(clip=right))
            return len(seen) > 4 and len(set(seen[-5:])) == 1

        until(browser_page, still)
        return seen[-1]

    before = at_rest()
    browser_page.keyboard.press("Space")
    browser_page.wait_for_function(f"() => {FIND}.vsw.shown > 60")
    browser_page.keyboard.press("Space")
    assert at_rest() != before
    browser_page.get_by_role("button", name="Several heads").click()
    browser_page.wait_for_function(f"() => !{FIND}.vsw.scene.actors.has('female/skin')")


def test_a_wrong_folder_is_said_where_it_was_typed(browser_page, served):
    drawn(browser_page, served)
    browser_page.get_by_role("button", name="Corpus", exact=True).click()
    field = browser_page.get_by_label("Folder of the corpus")
    field.fill(str(served[2] / "nothing"))
    field.press("Enter")
    browser_page.locator(".start .notice.err", has_text="corpus.toml").wait_for()
    browser_page.get_by_role("button", name="Back to the open corpus").click()
    lane(browser_page).wait_for()
