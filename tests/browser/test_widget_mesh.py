"""The mesh view in Chromium: what it draws, how it moves, and what the GPU computes."""

import numpy as np
import pytest
import pyvista as pv
from browser.shown import FIND, FIND_ALL, GROUND, SIZE, Shown, wait_drawn

from corpus_tools.mesh import bind_rbf, bundled_head
from workbench.views.mesh_view import MeshView
from workbench.views.scene_actors import surface_actor

FRONT = {
    "position": [0.0, 0.0, 10.0],
    "focal_point": [0.0, 0.0, 0.0],
    "view_up": [0.0, 1.0, 0.0],
    "view_angle": 30.0,
    "parallel_scale": 0.0,
}


def plane(name="plate", z=0.0, color="white", **style):
    style = {"ambient": 1.0, "diffuse": 0.0, **style}
    surface = pv.Plane(
        center=(0, 0, z), direction=(0, 0, 1), i_size=3, j_size=3, i_resolution=4, j_resolution=4
    )
    return surface_actor(name, surface, color=color, **style)


def single(*actors, **params):
    def make():
        view = MeshView(ground=GROUND, **{**SIZE, **params})
        view.show_actors(list(actors), camera=FRONT)
        return view

    return make


def share(picture, colour):
    return float((np.abs(picture.astype(int) - colour).max(axis=2) < 8).mean())


def test_it_draws_what_it_is_given_on_its_ground(serve, browser_page):
    shown = Shown(serve, browser_page, single(plane(color="red")))
    picture = shown.pixels()
    assert share(picture, [255, 0, 0]) == pytest.approx((3 / 5.359) ** 2 * 380 / 420, rel=0.02)
    assert share(picture, [255, 0, 0]) + share(picture, [0, 0, 255]) > 0.99
    assert shown.view.unavailable == ""
    canvas = browser_page.get_by_role("img", name="3-D view of a head")
    assert canvas.count() == 1


def test_a_new_motion_and_the_clock_change_the_pixels(serve, browser_page):
    actor = {**plane(color="red"), "basis": np.eye(25, dtype=np.float32).tobytes()}
    shown = Shown(serve, browser_page, single(actor))
    before = shown.get("v.hash()")
    away = np.zeros((10, 25, 3))
    away[:, :, 0] = np.arange(10)[:, None] * 0.1
    shown.call(lambda: shown.view.set_motion(10.0, displacements={"plate": away}))
    shown.until("v.ack >= 1")
    assert shown.get("v.hash()") == before
    shown.get("v.clock.seek(0.45)")
    shown.until("Math.abs(v.shown - 4.5) < 1e-9")
    assert shown.get("v.hash()") != before
    rest = np.frombuffer(actor["points"], np.float32).reshape(-1, 3)
    placed = shown.positions("plate")
    np.testing.assert_allclose(placed, rest + np.array([0.45, 0, 0]), atol=1e-5)
    shown.call(lambda: shown.view.set_motion(10.0, displacements={"plate": 0 * away}))
    shown.until("v.ack >= 2")
    assert shown.get("v.hash()") == before


def test_positions_on_the_gpu_are_those_of_numpy(serve, browser_page):
    head = bundled_head()
    binding = bind_rbf(head, tuple(head.markers))
    skin = pv.PolyData.from_regular_faces(head.vertices_mm, head.faces)
    actor = surface_actor("skin", skin, basis=binding.response(np.arange(head.n_vertices)))
    poses = np.random.default_rng(5).normal(0, 5, (8, len(binding.names), 3)).astype(np.float32)

    def make():
        view = MeshView(**SIZE)
        view.show_actors([actor])
        view.set_motion(120.0, displacements={"skin": poses})
        return view

    shown = Shown(serve, browser_page, make)
    for frame, pose in enumerate(poses):
        shown.get(f"v.clock.seek({frame} / 120)")
        shown.until(f"v.shown === {frame}")
        found = shown.positions("skin")
        wanted = head.vertices_mm + binding.response(np.arange(head.n_vertices)) @ pose.astype(float)
        assert np.abs(found - wanted).max() < 1e-3
        assert np.abs(wanted - head.vertices_mm).max() > 5


def test_rigid_parts_and_moving_points_follow_the_clock(serve, browser_page):
    dots = surface_actor(
        "dots", pv.PolyData(np.array([[0.0, 0, 1], [0.5, 0, 1]])), color="lime", point_size=12
    )
    shown = Shown(serve, browser_page, single(plane(color="red"), dots))
    matrices = np.tile(np.eye(4), (3, 1, 1))
    matrices[:, 0, 3] = [0, 1, 2]
    places = np.array([[[0.0, 0, 1], [0.5, 0, 1]], [[9, 9, 1], [9, 9, 1]], [[0, 1, 1], [9, 9, 1]]])
    shown.call(lambda: shown.view.set_motion(2.0, rigid={"plate": matrices}, points={"dots": places}))
    shown.until("v.ack >= 1")
    seen = []
    for time in (0.0, 0.5, 1.0):
        shown.get(f"v.clock.seek({time})")
        shown.until(f"v.shown === {2 * time}")
        picture = shown.pixels()
        red = np.argwhere((picture[..., 0] > 200) & (picture[..., 1] < 60))
        green = int(((picture[..., 1] > 60) & (picture[..., 0] < 60)).sum())
        seen.append((red[:, 1].mean(), green))
    per_unit = 380 / (2 * 10 * np.tan(np.radians(15)))
    assert seen[1][0] - seen[0][0] == pytest.approx(per_unit, abs=2)
    assert [green > 40 for _, green in seen] == [True, False, True]
    assert seen[0][1] > 1.5 * seen[2][1]


def test_latest_wins_and_everything_sent_is_acknowledged(serve, browser_page):
    actor = plane(color="red")
    shown = Shown(serve, browser_page, single(actor))
    rest = np.frombuffer(actor["points"], np.float32).reshape(-1, 3)

    def push():
        for step in range(40):
            shown.view.push_points("plate", rest - np.array([0, 0, step / 10]))

    shown.call(push)
    shown.until("v.waiting.length === 0 && v.ack >= 2")
    last = shown.positions("plate")
    np.testing.assert_allclose(last, rest - np.array([0, 0, 3.9]), atol=1e-5)
    assert shown.view.dropped == 38
    assert len(shown.get("v.changes")) == 2
    browser_page.wait_for_timeout(100)
    assert shown.view.acknowledged == 2


def test_translucent_and_hidden_actors(serve, browser_page):
    shown = Shown(serve, browser_page, single(plane("back", 0.0, "red"), plane("front", 0.5, "lime")))
    middle = (190, 210)
    assert list(shown.pixels()[middle]) == [0, 255, 0]
    shown.call(lambda: shown.view.set_style("front", opacity=0.5))
    shown.until('v.scene.actors.get("front").opacity === 0.5')
    assert np.abs(shown.pixels()[middle].astype(int) - [128, 128, 0]).max() <= 2
    shown.call(lambda: shown.view.set_style("front", visible=False))
    shown.until('!v.scene.actors.get("front").visible')
    assert list(shown.pixels()[middle]) == [255, 0, 0]


def test_the_mouse_turns_the_camera_and_python_hears_of_it(serve, browser_page):
    shown = Shown(serve, browser_page, single(plane(color="red")))
    before = shown.get("v.hash()")
    box = browser_page.get_by_role("img").bounding_box()
    x, y = box["x"] + 200, box["y"] + 190
    browser_page.mouse.move(x, y)
    browser_page.mouse.down()
    browser_page.mouse.move(x + 100, y, steps=3)
    browser_page.mouse.up()
    assert shown.get("v.hash()") != before
    angle = np.pi * 100 / 380
    expected = [-10 * np.sin(angle), 0, 10 * np.cos(angle)]
    for _ in range(200):
        if shown.view.camera["position"][0] != 0:
            break
        browser_page.wait_for_timeout(20)
    np.testing.assert_allclose(shown.view.camera["position"], expected, atol=1e-3)
    plotter = pv.Plotter(off_screen=True)
    shown.view.camera_to(plotter)
    np.testing.assert_allclose(plotter.camera.position, expected, atol=1e-3)
    assert plotter.camera.view_angle == 30
    browser_page.keyboard.press("r")
    assert shown.get("v.hash()") == before
    plotter.camera_position = [(4, 3, 8), (0, 0.1, 0), (0, 1, 0)]
    shown.call(lambda: shown.view.camera_from(plotter))
    shown.until("Math.abs(v.camera.position[0] - 4) < 1e-6")
    assert shown.get("v.hash()") != before


FAR = "Math.hypot(...v.camera.position.map((p, k) => p - v.camera.focal_point[k]))"


def test_the_wheel_keeps_its_limits_and_scrolls_where_it_needs_ctrl(serve, browser_page):
    shown = Shown(serve, browser_page, single(plane(color="red")))
    box = browser_page.get_by_role("img", name="3-D view of a head").bounding_box()
    x, y = box["x"] + 210, box["y"] + 190

    def wheel(turn, far):
        for _ in range(3):
            browser_page.mouse.wheel(0, turn)
        shown.until(f"Math.abs({FAR} - a) < 1e-6", far)

    near, away = shown.view.zoom_limits
    browser_page.mouse.move(x, y)
    wheel(-2000, 10 * near)
    wheel(4000, 10 * away)
    browser_page.keyboard.press("0")  # it is not for a view without the focus
    browser_page.mouse.dblclick(x, y)  # on the plate: two picks, and the camera stays
    assert shown.get(FAR) == pytest.approx(10 * away)
    browser_page.mouse.dblclick(box["x"] + 5, box["y"] + 5)
    shown.until(f"Math.abs({FAR} - 10) < 1e-6")
    browser_page.mouse.move(x, y)
    wheel(-2000, 10 * near)
    browser_page.keyboard.press("0")
    shown.until(f"Math.abs({FAR} - 10) < 1e-6")
    browser_page.evaluate("document.body.style.height = '3000px'")
    shown.call(lambda: setattr(shown.view, "wheel_needs_ctrl", True))
    shown.until("v.model.wheel_needs_ctrl")
    browser_page.mouse.wheel(0, 30)
    browser_page.get_by_text("Ctrl + wheel zooms").wait_for()
    browser_page.wait_for_function("() => scrollY === 30")
    assert shown.get(FAR) == 10
    browser_page.keyboard.down("Control")
    wheel(-2000, 10 * near)
    browser_page.keyboard.up("Control")


def test_two_sessions_do_not_share_clock_or_motion(serve, browser_page):
    actor = {**plane(color="red"), "basis": np.eye(25, dtype=np.float32).tobytes()}
    shown = Shown(serve, browser_page, single(actor))
    first = shown.view
    other = browser_page.context.new_page()
    other.goto(shown.url)
    wait_drawn(other)
    second = shown.views[-1]
    assert second is not first
    before = other.evaluate(f"() => {FIND}.vsw.hash()")
    shown.call(lambda: first.set_motion(1.0, displacements={"plate": np.full((1, 25, 3), 0.5)}))
    shown.until("v.ack >= 1")
    shown.get("v.clock.seek(0.7)")
    assert other.evaluate(f"() => {FIND}.vsw.hash()") == before
    assert other.evaluate(f"() => {FIND}.vsw.clock.t") == 0
    assert second.motion == {}


def test_two_views_of_one_clock_show_the_same_moment(serve, browser_page):
    import panel as pn

    actor = {**plane(color="red"), "basis": np.eye(25, dtype=np.float32).tobytes()}

    def make():
        pair = [MeshView(session="pair", **SIZE) for _ in range(2)]
        for view in pair:
            view.show_actors([actor], camera=FRONT)
            view.set_motion(60.0, displacements={"plate": np.zeros((120, 25, 3))})
        return pn.Row(*pair)

    url = serve(make)
    browser_page.goto(url)
    browser_page.wait_for_function(f"() => {FIND_ALL}.filter((c) => c.vsw.draws > 0).length === 2")
    disagreements = browser_page.evaluate(
        f"""async () => {{
          const [a, b] = {FIND_ALL}.map((c) => c.vsw);
          const begun = performance.now();
          a.clock.start(() => (performance.now() - begun) / 1000);
          const seen = [];
          while (performance.now() - begun < 800) {{
            await new Promise(requestAnimationFrame);
            seen.push([a.shown, b.shown]);
          }}
          a.clock.stop();
          return seen;
        }}"""
    )
    assert all(a == b for a, b in disagreements)
    assert disagreements[-1][0] > 30


def test_a_view_that_goes_away_gives_its_context_back(serve, browser_page):
    import panel as pn

    columns = []

    def make():
        column = pn.Column(single(plane())())
        columns.append((column, pn.state.curdoc))
        return column

    browser_page.goto(serve(make))
    wait_drawn(browser_page)
    browser_page.evaluate(f"() => {{ window.kept = {FIND}; }}")
    column, doc = columns[-1]
    doc.add_next_tick_callback(lambda: column.clear())
    browser_page.wait_for_function("() => kept.vsw.dead && kept.vsw.scene.gl.isContextLost()")
    assert browser_page.evaluate("() => kept.vsw.clock.views.size") == 0


def test_resize_keeps_the_whole_canvas_drawn(serve, browser_page):
    shown = Shown(serve, browser_page, single(plane(color="red"), width=300, height=200))
    assert shown.get("[v.canvas.width, v.canvas.height]") == [300, 200]
    shown.call(lambda: shown.view.param.update(width=500, height=400))
    shown.until("v.canvas.width === 500 && v.canvas.height === 400")
    assert share(shown.pixels(), [255, 0, 0]) == pytest.approx((3 / 5.359) ** 2 * 400 / 500, rel=0.02)
