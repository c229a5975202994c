"""The first page in a real browser: a sentence moves the head, g(u) moves pixels, tabs are independent."""

import re
import shlex

import pytest
from browser.paged import drawn, lane, settled, until

from corpus_tools.config import load_config
from workbench.actions import options_shown, replay_command


def at_rest(tab, where):
    """Return the box of the lane and what a script says of it, once three looks agree: layout has ended."""
    seen = []

    def look():
        seen.append((lane(tab).bounding_box(), lane(tab).evaluate(where)))
        return len(seen) > 3 and seen[-1] == seen[-2] == seen[-3]

    until(tab, look)
    return seen[-1]


def pixels(tab, part):
    return tab.locator(part).first.screenshot()


def changed(tab, part, before, timeout_ms=10_000):
    """Wait until a part of the page looks different."""
    waited = 0
    while pixels(tab, part) == before:
        assert waited < timeout_ms, f"{part} did not change"
        tab.wait_for_timeout(50)
        waited += 50


def drag(tab, label, share):
    """Drag a slider with the mouse to `share` of its length."""
    box = tab.get_by_role("slider", name=re.compile(label)).locator("xpath=../..").bounding_box()
    y = box["y"] + box["height"] / 2
    tab.mouse.move(box["x"] + 0.5 * box["width"], y)
    tab.mouse.down()
    for step in range(1, 9):
        tab.mouse.move(box["x"] + (0.5 + (share - 0.5) * step / 8) * box["width"], y)
    tab.mouse.up()


def seek_to_join(tab):
    """Put the clock a little before the first join, where g(u) matters."""
    box, x = at_rest(tab, "c => c.vsw.toX(c.vsw.state.joins[0].time - 0.01)")
    tab.mouse.click(box["x"] + x, box["y"] + 200)


def test_g_of_u_moves_pixels_of_lane_and_head(browser_page, served):
    session = drawn(browser_page, served)
    seek_to_join(browser_page)
    browser_page.wait_for_timeout(300)
    head, lane_before = pixels(browser_page, ".slot.face"), pixels(browser_page, ".vsw-lane")
    drag(browser_page, "Crossover", 0.95)
    until(browser_page, lambda: session.shape > 0.5)
    changed(browser_page, ".vsw-lane", lane_before)
    changed(browser_page, ".slot.face", head)


def test_a_click_and_a_key_select_a_fragment(browser_page, served):
    session = drawn(browser_page, served)
    middle = """c => {
      const { box, score } = c.vsw.state;
      const f = score.fragments[1];
      return [c.vsw.toX((f.start + f.end) / 2), (box.fragments[0] + box.fragments[1]) / 2];
    }"""
    box, (x, y) = at_rest(browser_page, middle)
    browser_page.mouse.click(box["x"] + x, box["y"] + y)
    browser_page.get_by_text(re.compile("^Fragment 2 of")).wait_for()
    assert session.selected == 1
    browser_page.keyboard.press("j")
    browser_page.get_by_text(re.compile("^Fragment 1 of")).wait_for()
    fragments = browser_page.get_by_role("listbox", name="Chosen fragments")
    chosen = fragments.get_by_role("option", selected=True)
    assert chosen.inner_text().startswith("1: ")


def test_nothing_changes_while_the_page_is_on_its_way(browser_page, served):
    """What is done before the browser has the page reaches it, however long the page takes."""
    url, workbench, _ = served
    before = set(workbench.pages)
    held = []
    browser_page.route("**/*.js*", lambda route: held.append(route) if not held else route.continue_())
    browser_page.goto(url, wait_until="commit")
    until(browser_page, lambda: held and set(workbench.pages) - before)
    (page,) = set(workbench.pages) - before
    until(browser_page, lambda: not page.desk.busy)
    assert page.session.corpus is None
    held[0].continue_()
    lane(browser_page).wait_for(timeout=30_000)
    until(browser_page, lambda: page.session.result is not None)


def has_focus(field):
    return field.evaluate("e => e.getRootNode().activeElement === e")


def test_a_picked_sentence_and_esc_let_the_keys_go(browser_page, served):
    session = drawn(browser_page, served)
    picker = browser_page.get_by_placeholder("Sentence: type a name")
    slider = browser_page.get_by_role("slider", name=re.compile("Longest overlap"))
    picker.fill(session.sentences[1])
    picker.press("ArrowDown")
    picker.press("Enter")
    until(browser_page, lambda: session.sentence == session.sentences[1])
    until(browser_page, lambda: not has_focus(picker) and session.sentence in picker.input_value())
    settled(browser_page, session)
    length_s = session.result.utterance.duration_s
    length = "e => e.vsw.sound.duration"
    until(browser_page, lambda: abs(transport(browser_page).evaluate(length) - length_s) < 0.01)
    played = Played(browser_page)
    browser_page.keyboard.press("Space")
    played.wait("began", 1)
    picker.click()
    browser_page.get_by_role("option").nth(2).click()
    until(browser_page, lambda: session.sentence == session.sentences[2] and not has_focus(picker))
    until(browser_page, lambda: session.sentence in picker.input_value())
    picker.click()  # its list is open
    picker.press("Escape")
    until(browser_page, lambda: not has_focus(picker))
    for field in (slider, browser_page.get_by_label("Config file")):
        field.focus()
        field.press("Escape")
        until(browser_page, lambda field=field: not has_focus(field))
    browser_page.keyboard.press("2")
    until(browser_page, lambda: session.weighting == "raised-cosine")


def test_next_sentence_and_presets_by_key(browser_page, served):
    session = drawn(browser_page, served)
    first = session.sentence
    browser_page.keyboard.press("]")
    until(browser_page, lambda: session.sentence != first)
    settled(browser_page, session)
    browser_page.locator(".chip", has_text="held out · ").wait_for()
    browser_page.keyboard.press("1")
    browser_page.locator("button.Mui-selected", has_text="Linear").wait_for()
    assert session.weighting == "linear"


def test_space_plays_and_every_cursor_moves(browser_page, served):
    drawn(browser_page, served)
    browser_page.keyboard.press("Space")
    clock = browser_page.locator(".vsw-transport .now")
    until(browser_page, lambda: float(clock.inner_text()) > 0.2)
    browser_page.keyboard.press("Space")
    browser_page.get_by_role("button", name="Play (Space)").wait_for()
    x = browser_page.locator(".vsw-lane-cursor").evaluate("e => new DOMMatrix(e.style.transform).m41")
    expected = lane(browser_page).evaluate(f"c => c.vsw.toX({clock.inner_text()})")
    assert abs(x - expected) < 1.0


def test_two_tabs_do_not_affect_each_other(browser_page, served):
    one = drawn(browser_page, served)
    other_tab = browser_page.context.new_page()
    two = drawn(other_tab, served)
    assert one is not two
    assert one.corpus is two.corpus
    kept, before = one.result, pixels(browser_page, ".vsw-lane")
    other_tab.keyboard.press("]")
    until(other_tab, lambda: two.sentence != one.sentence)
    drag(other_tab, "Longest overlap", 0.1)
    until(other_tab, lambda: two.overlap_s < 0.1)
    settled(other_tab, two)
    other_tab.keyboard.press("t")
    other_tab.locator('.vsw-shell[data-theme="dark"]').wait_for()
    assert one.result is kept
    assert (one.theme, one.overlap_s) == ("light", 0.12)
    assert pixels(browser_page, ".vsw-lane") == before


def test_export_equals_what_the_page_shows(browser_page, served):
    session = drawn(browser_page, served)
    drag(browser_page, "Crossover", 0.2)
    until(browser_page, lambda: session.shape < -0.3)
    target = served[2] / "exported.toml"
    browser_page.get_by_label("Config file").fill(str(target))
    browser_page.get_by_role("button", name="Export").click()
    browser_page.get_by_text("Config written").wait_for()
    assert load_config(target).values() == session.config.values()
    assert load_config(target).blend.shape == session.shape
    line = browser_page.get_by_label("Command that replays it").input_value()
    assert line.startswith("corpus-tools synth ")
    assert str(target) in line


def test_theme_changes_the_page_and_keeps_its_layout(browser_page, served):
    drawn(browser_page, served)
    shell = browser_page.locator(".vsw-shell")
    parts = (".rail", ".transport", ".work", ".status", ".vsw-transport .clock")
    places = [browser_page.locator(p).first.bounding_box() for p in parts]
    light = shell.evaluate("e => getComputedStyle(e).backgroundColor")
    browser_page.keyboard.press("t")
    browser_page.locator('.vsw-shell[data-theme="dark"]').wait_for()
    assert shell.evaluate("e => getComputedStyle(e).backgroundColor") != light
    assert places == [browser_page.locator(p).first.bounding_box() for p in parts]


@pytest.mark.parametrize("width", [1280, 1440, 1920])
def test_the_frame_keeps_its_sizes_and_nothing_is_clipped(browser_page, served, width):
    browser_page.set_viewport_size({"width": width, "height": 900})
    drawn(browser_page, served)
    parts = (".rail", ".bar", ".transport", ".inspector", ".status")
    boxes = {p: browser_page.locator(p).first.bounding_box() for p in parts}
    assert boxes[".rail"]["width"] == 64
    assert (boxes[".bar"]["y"], boxes[".bar"]["height"]) == (0, 40)
    assert (boxes[".transport"]["y"], boxes[".transport"]["height"]) == (40, 48)
    assert boxes[".inspector"]["width"] == (288 if width > 1360 else 256)
    assert boxes[".inspector"]["x"] + boxes[".inspector"]["width"] == width
    assert boxes[".status"]["y"] + boxes[".status"]["height"] == 900
    foot = browser_page.locator(".inspector > .foot").bounding_box()
    button = browser_page.get_by_role("button", name="Export").bounding_box()
    assert button["y"] + button["height"] <= foot["y"] + foot["height"] <= 876
    for header in browser_page.locator(".card > header:visible").all():
        assert header.evaluate("e => e.scrollWidth <= e.clientWidth")
    told = browser_page.locator(".fragments .sub")
    assert told.evaluate("e => e.scrollWidth <= e.clientWidth"), told.inner_text()
    for words in browser_page.locator(".slot.presets button").all():
        assert words.evaluate("e => e.scrollWidth <= e.clientWidth"), words.inner_text()


def test_the_keys_of_a_fragment_swap_pin_ban_undo_and_hear(browser_page, served):
    session = drawn(browser_page, served)
    result = session.result
    index = next(i for i, c in enumerate(result.selection.chosen) if len(c.rejected) > 1)
    first = result.selection.chosen[index].unit
    for _ in range(index):
        browser_page.keyboard.press("l")
    until(browser_page, lambda: session.selected == index)
    wanted = options_shown(session).options[1]
    browser_page.keyboard.press("Alt+ArrowDown")
    until(browser_page, lambda: session.pins == (wanted.pin,))
    settled(browser_page, session)
    row = browser_page.locator('tr.now[data-action="swap"]')
    until(browser_page, lambda: row.get_attribute("data-value") == "1")
    row.focus()
    row.press("ArrowUp")
    until(browser_page, lambda: session.pins and session.pins != (wanted.pin,))
    settled(browser_page, session)
    browser_page.keyboard.press("b")
    until(browser_page, lambda: session.bans == (first.key,))
    browser_page.get_by_role("button", name="Allow again").wait_for()
    browser_page.keyboard.press("k")
    until(browser_page, lambda: len(session.pins) == 1)
    for _ in range(4):
        before = session.edits
        browser_page.keyboard.press("Control+z")
        until(browser_page, lambda n=before: session.edits > n)
    until(browser_page, lambda: (session.pins, session.bans) == ((), ()))
    settled(browser_page, session)
    assert session.result.selection.chosen[index].unit == first
    browser_page.keyboard.press("h")
    until(browser_page, lambda: transport(browser_page).evaluate("e => e.vsw.sound.heard === 1"))
    browser_page.keyboard.press("p")
    until(browser_page, lambda: transport(browser_page).evaluate("e => e.vsw.clock.t > 0"))


def test_two_settings_are_compared_and_the_history_goes_back(browser_page, served):
    session = drawn(browser_page, served)
    browser_page.keyboard.press("1")
    sides = browser_page.get_by_role("group", name="Setting shown")
    sides.wait_for()
    until(browser_page, lambda: session.other is not None)
    browser_page.keyboard.press("x")
    until(browser_page, lambda: (session.side, session.weighting) == ("A", "smootherstep"))
    sides.get_by_role("button", name="B").click()
    until(browser_page, lambda: (session.side, session.weighting) == ("B", "linear"))
    states = browser_page.get_by_role("listbox", name="States of this session")
    states.get_by_role("option").last.click()
    until(browser_page, lambda: session.weighting == "smootherstep")
    browser_page.keyboard.press("Control+y")
    until(browser_page, lambda: session.weighting == "linear")


def test_inertial_joins_offer_their_duration_in_place_of_g_of_u(browser_page, served):
    session = drawn(browser_page, served)
    slider = browser_page.get_by_role("slider", name=re.compile("Inertial duration"))
    overlap = browser_page.get_by_role("slider", name=re.compile("Longest overlap"))
    overlap.wait_for()
    browser_page.get_by_role("button", name="Inertial").click()
    slider.wait_for()
    overlap.wait_for(state="hidden")
    assert browser_page.get_by_role("button", name="Linear").is_disabled()
    browser_page.keyboard.press("1")
    browser_page.keyboard.press("w")
    browser_page.keyboard.press("ArrowLeft")
    until(browser_page, lambda: session.inertial_s == 0.115)
    assert session.weighting == "smootherstep"
    assert (
        browser_page.locator(".slot.presets").get_attribute("title").startswith("Inertial joins use no g(u)")
    )


def transport(tab):
    return tab.locator(".vsw-transport").first


class Played:
    """How often the clock began and stopped, counted in the page: a short one may end between two looks."""

    def __init__(self, tab):
        self._tab, self._clock = tab, transport(tab)
        self._clock.evaluate("""e => {
          const { clock } = e.vsw;
          clock.told = { began: 0, ended: 0 };
          clock.addEventListener("state", () => (clock.told[clock.playing ? "began" : "ended"] += 1));
        }""")

    def count(self, what):
        return self._clock.evaluate("(e, what) => e.vsw.clock.told[what]", what)

    def wait(self, what, n):
        until(self._tab, lambda: self.count(what) >= n)


def playing(tab):
    return transport(tab).evaluate("e => e.vsw.clock.playing")


def test_a_typed_sentence_is_spoken_and_one_without_words_is_refused_in_its_place(browser_page, served):
    session = drawn(browser_page, served)
    browser_page.get_by_role("button", name="Text", exact=True).click()
    browser_page.get_by_text("Type a sentence above").wait_for()
    field = browser_page.get_by_placeholder("Type a sentence")
    played = Played(browser_page)
    until(browser_page, lambda: has_focus(field))  # the caret is in it without a click
    browser_page.keyboard.type("  the time is half past nine ")
    browser_page.keyboard.press("Enter")
    played.wait("began", 1)  # what was typed is heard and seen
    assert session.result.request.text == "the time is half past nine"
    browser_page.keyboard.press("Space")  # the field has let the keys go
    played.wait("ended", 1)
    assert field.input_value() == "the time is half past nine"
    states = len(session.history.entries)
    field.press("End")
    field.press_sequentially("  ")
    until(browser_page, lambda: not playing(browser_page))
    before = played.count("began")
    field.press("Enter")  # the same words: they are played again, and nothing else happens
    played.wait("began", before + 1)
    assert (len(session.history.entries), session.text) == (states, "the time is half past nine")
    field.press("Escape")
    browser_page.keyboard.press("Space")
    until(browser_page, lambda: not playing(browser_page))
    labels = session.result.utterance.labels
    until(
        browser_page,
        lambda: lane(browser_page).evaluate("c => c.vsw.state.score.phones.length") == len(labels),
    )
    assert "--text=the time is half past nine" in shlex.split(replay_command(session, "x.toml"))
    field.fill("?!")
    field.press("Enter")
    browser_page.locator(".fragments .notice.err").wait_for()
    until(browser_page, lambda: lane(browser_page).evaluate("c => c.vsw.state.score.phones.length") == 0)
    assert session.result is None  # nothing of another sentence stays
    browser_page.get_by_text("There is no result yet").wait_for()
    assert browser_page.locator(".fragments .sub").inner_text() == ""


def test_a_dragged_handle_makes_an_own_curve_and_keys_move_it(browser_page, served):
    session = drawn(browser_page, served)
    canvas = browser_page.locator(".vsw-curve canvas")
    place = """c => {
      const [x0, y0, x1, y1] = c.vsw.box();
      const [u, g] = c.vsw.handles.points[2];
      return [x0 + u * (x1 - x0), y1 - g * (y1 - y0)];
    }"""
    box, (x, y) = canvas.bounding_box(), canvas.evaluate(place)
    browser_page.mouse.move(box["x"] + x, box["y"] + y)
    browser_page.mouse.down()
    for step in range(1, 6):
        browser_page.mouse.move(box["x"] + x + 4 * step, box["y"] + y - 4 * step)
    browser_page.mouse.up()
    until(browser_page, lambda: session.weighting == "user")
    settled(browser_page, session)
    dragged = session.curve_weights
    off = """c => {
      const curve = c.vsw.values;
      return Math.max(...c.vsw.handles.points.map(([u, g]) => {
        const i = Math.min(curve.length - 2, Math.floor(u * (curve.length - 1)));
        return Math.abs(g - curve[i] - (u * (curve.length - 1) - i) * (curve[i + 1] - curve[i]));
      }));
    }"""
    until(browser_page, lambda: canvas.evaluate(off) < 1e-4)  # the handles lie on the curve again
    canvas.press("ArrowUp")
    until(browser_page, lambda: session.curve_weights != dragged)
    browser_page.keyboard.press("v")
    browser_page.locator(".slot.curves .bk-Canvas, .slot.curves canvas").first.wait_for()
