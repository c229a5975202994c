"""The transport in a real browser: exact ends, seeking, speed, loop, keys, playing without a sound device."""

import numpy as np
import panel as pn
import pytest

from corpus_tools.core import Audio
from workbench.views.transport import Transport

RATE_HZ = 16000
ROWS = [[0.0, 0.2, "SIL", "silence"], [0.2, 0.5, "P", "bilabial"], [0.5, 0.8, "SIL", "silence"]]
BAR = ".vsw-transport"
SPY = """
window.starts = [];
const start = AudioBufferSourceNode.prototype.start;
AudioBufferSourceNode.prototype.start = function (when, from, length) {
  starts.push({ from, length, rate: this.playbackRate.value, loop: this.loop, samples: this.buffer.length,
    values: [...this.buffer.getChannelData(0).subarray(3200, 3204)] });
  return start.call(this, when, from, length);
};
"""


def sound(duration_s=0.8):
    t = np.arange(int(duration_s * RATE_HZ)) / RATE_HZ
    return Audio(0.2 * np.sin(2 * np.pi * 150 * t), RATE_HZ)


@pytest.fixture
def transport(serve, browser_page):
    """Return a transport with a loaded sound, shown above a text field, and its locator."""
    made = []

    def page():
        view = Transport(session="test", theme="light")
        view.load_sound(sound(), 0.8, ROWS)
        made.append(view)
        return pn.Column(view, pn.widgets.TextInput(name="words"), width=1200)

    browser_page.add_init_script(SPY)
    browser_page.goto(serve(page))
    bar = browser_page.locator(BAR)
    bar.wait_for()
    return made[-1], bar, browser_page


def state(bar):
    return bar.evaluate("e => ({ t: e.vsw.clock.t, playing: e.vsw.clock.playing })")


def wait(bar, condition):
    """Wait until a condition on the clock `c` holds, looking at every frame."""
    bar.evaluate(
        """(e, text) => new Promise((done, fail) => {
          const holds = new Function("c", `return ${text}`);
          const end = performance.now() + 15000;
          const look = () => holds(e.vsw.clock) ? done() : performance.now() > end
            ? fail(`never: ${text}, ${e.vsw.clock.t}`) : requestAnimationFrame(look);
          look();
        })""",
        condition,
    )


def until_python(page, view, name, value):
    for _ in range(200):
        if getattr(view, name) == pytest.approx(value):
            return
        page.wait_for_timeout(25)
    raise AssertionError(f"{name} stayed {getattr(view, name)}")


def test_space_plays_all_samples_and_the_clock_ends_exactly(transport):
    view, bar, page = transport
    page.keyboard.press("Space")
    wait(bar, "c.playing")
    wait(bar, "!c.playing")
    assert state(bar) == {"t": 0.8, "playing": False}
    (started,) = page.evaluate("starts")
    assert (started["from"], started["length"], started["samples"]) == (0, 0.8, 12800)
    expected = np.round(sound().samples[3200:3204] * 32768) / 32768
    np.testing.assert_allclose(started["values"], expected, atol=1e-7)
    until_python(page, view, "time", 0.8)


def test_a_stretch_is_asked_for_to_the_sample(transport):
    view, bar, page = transport
    view.play(0.25, 0.4)
    wait(bar, "!c.playing && c.t === 0.4")  # so short that no frame need have seen it play
    (started,) = page.evaluate("starts")
    assert (started["from"], started["length"]) == (0.25, pytest.approx(0.15))


def test_clock_and_phone_are_shown(transport):
    view, bar, _ = transport
    view.seek(0.3456)
    wait(bar, "c.t === 0.3456")
    assert bar.get_by_role("timer", name="Clock").inner_text() == "0.346"
    assert bar.get_by_label("Phone at the clock").inner_text() == "/P/"
    assert "0.800" in bar.inner_text()


def test_a_drag_on_the_overview_seeks_and_goes_on_playing(transport):
    _, bar, page = transport
    strip = bar.get_by_role("slider", name="Time").bounding_box()
    y = strip["y"] + 10
    page.keyboard.press("Space")
    wait(bar, "c.playing")
    page.mouse.move(strip["x"] + 0.1 * strip["width"], y)
    page.mouse.down()
    page.mouse.move(strip["x"] + 0.25 * strip["width"], y, steps=4)
    assert not state(bar)["playing"]
    assert state(bar)["t"] == pytest.approx(0.2, abs=0.8 / strip["width"] + 1e-9)
    page.mouse.up()
    wait(bar, "c.playing && c.t > 0.25")


def test_half_speed_runs_half_as_fast(transport):
    _, bar, page = transport
    bar.get_by_role("button", name="Speed").click()
    page.keyboard.press("Space")
    wait(bar, "c.playing && c.t > 0.02")
    run = bar.evaluate(
        """e => new Promise((done) => {
          const c = e.vsw.clock, t = c.t, began = performance.now();
          const look = () => c.t > 0.6 ? done((c.t - t) / (performance.now() - began) * 1000)
            : requestAnimationFrame(look);
          look();
        })"""
    )
    assert run == pytest.approx(0.5, abs=0.06)
    assert page.evaluate("starts")[0]["rate"] == 0.5


def test_the_loop_goes_round(transport):
    _, bar, page = transport
    loop = bar.get_by_role("button", name="round")
    loop.click()
    assert loop.get_attribute("aria-pressed") == "true"
    page.keyboard.press("Space")
    wait(bar, "c.t > 0.6")
    wait(bar, "c.playing && c.t < 0.3")
    loop.click()
    wait(bar, "!c.playing")
    assert state(bar)["t"] == 0.8


def test_space_belongs_to_a_text_field_and_to_a_button_reached_by_key(transport):
    _, bar, page = transport
    page.get_by_label("words").click()
    page.keyboard.type("a b")
    assert page.get_by_label("words").input_value() == "a b"
    assert page.evaluate("starts") == []
    page.get_by_label("words").press("Shift+Tab")
    page.keyboard.press("Shift+Tab")
    speed = bar.get_by_role("button", name="Speed")
    assert speed.evaluate("e => e.matches(':focus-visible')")
    page.keyboard.press("Space")
    assert speed.inner_text() == "0.5×"
    assert page.evaluate("starts") == []


def test_another_utterance_stops_and_goes_to_its_start(transport):
    view, bar, page = transport
    page.keyboard.press("Space")
    wait(bar, "c.playing && c.t > 0.05")
    view.load_sound(sound(0.3), 0.5, ROWS[:1])
    wait(bar, "!c.playing")
    assert state(bar)["t"] == 0
    page.keyboard.press("Space")
    wait(bar, "c.playing")
    wait(bar, "!c.playing")
    assert state(bar)["t"] == 0.5
    assert page.evaluate("starts.at(-1).samples") == 8000


def test_two_clocks_on_one_page_are_apart(serve, browser_page):
    def page():
        views = [Transport(session=name, keys_everywhere=False) for name in ("one", "two")]
        for view in views:
            view.load_sound(sound(), 0.8, ROWS)
        return pn.Column(*views, width=1200)

    browser_page.goto(serve(page))
    one, two = (browser_page.locator(BAR).nth(i) for i in (0, 1))
    two.get_by_role("button", name="Play (Space)").click()
    wait(two, "c.t > 0.1")
    assert state(one) == {"t": 0, "playing": False}


def test_without_a_sound_device_it_plays_silently_and_says_so(serve, browser_page):
    def page():
        view = Transport(session="silent")
        view.load_sound(sound(), 0.8, ROWS)
        return view

    browser_page.add_init_script("delete window.AudioContext")
    browser_page.goto(serve(page))
    bar = browser_page.locator(BAR)
    bar.get_by_role("button", name="Play (Space)").click()
    wait(bar, "c.playing && c.t > 0.3")
    assert "No sound" in bar.get_attribute("title")
    wait(bar, "!c.playing")
    assert state(bar)["t"] == 0.8
