"""A browser without WebGL2: pictures drawn by the server, the sentence why, and none where VTK fails."""

import io
import threading

import numpy as np
import panel as pn
import pytest
from browser.shown import GROUND, SIZE
from PIL import Image

import workbench.views.stills as stills
from corpus_tools.mesh import bind_bid, bundled_head, level_neck, neck_rim
from corpus_tools.render import OffscreenStatus
from workbench.views.cameras import head_camera
from workbench.views.head_actors import head_actors
from workbench.views.mesh_view import MeshView
from workbench.views.posed import PosedScene
from workbench.views.transport import Transport

NO_WEBGL = """const real = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
  return kind === "webgl2" ? null : real.call(this, kind, ...rest); };"""
WHY = "this browser offers no WebGL2"


@pytest.fixture(scope="module")
def spoken():
    head = bundled_head()
    binding = bind_bid(head, tuple(head.markers))
    shift = np.zeros((61, len(binding.names), 3), np.float32)
    lower = [n.startswith("chin") or n in {f"lip_in{k}" for k in (5, 6, 7)} for n in binding.names]
    shift[:, lower, 1] = -np.linspace(0, 9, 61)[:, None]
    return head, binding, shift


def make_view(spoken, **params):
    head, binding, shift = spoken
    view = MeshView(ground=GROUND, **{**SIZE, **params})
    view.show_actors(head_actors(head, binding), camera=head_camera(head))
    rigid = {part: m for part, m in binding.rigid(binding.rest_mm + shift).items()}
    view.set_motion(30.0, displacements={"skin": shift}, rigid=rigid)
    return view


def test_the_pose_drawn_by_the_server_is_that_of_the_deformer(offscreen, spoken):
    head, binding, shift = spoken
    view = make_view(spoken)
    scene = PosedScene(view.actors, view.lights)
    scene.pose(view.actors, {**view.motion}, 45.5 / 30)
    wanted = binding.apply(binding.rest_mm + 0.5 * (shift[45:46] + shift[46:47]))[0]
    rim = neck_rim(head)  # level in pictures, and at rest
    wanted[rim] = level_neck(head).vertices_mm[rim]
    skin = np.frombuffer(view.actor("skin")["ids"], np.uint32)
    points = np.asarray(scene.plotter.actors["skin"].mapper.dataset.points)
    np.testing.assert_allclose(points, wanted[skin], atol=1e-3)
    pictures = []
    for time in (0.0, 2.0):
        scene.pose(view.actors, view.motion, time)
        jpeg = scene.picture(view.camera, GROUND, (200, 180))
        pictures.append(np.asarray(Image.open(io.BytesIO(jpeg)), int))
    assert pictures[0].shape == (180, 200, 3)
    assert np.abs(pictures[0] - pictures[1]).max(axis=2).mean() > 1
    assert np.abs(pictures[0][2, 2] - [0, 0, 255]).max() < 12
    scene.close()


def test_pictures_follow_the_clock_the_mouse_and_the_motion(offscreen, serve, browser_page, spoken):
    views = []

    def make():
        views.append((make_view(spoken, session="still"), pn.state.curdoc))
        transport = Transport(session="still")
        transport.load_sound(None, 2.0)
        return pn.Column(views[-1][0], transport, width=600)

    browser_page.add_init_script(NO_WEBGL)
    browser_page.goto(serve(make))
    picture = browser_page.get_by_role("img", name="3-D view of a head")
    browser_page.get_by_text(f"The server draws this, a few pictures a second: {WHY}.").wait_for()
    shown = picture.evaluate_handle("(e) => e.parentElement.vsw")

    def settled():
        """Wait until nothing is on its way; return the picture."""
        browser_page.wait_for_function("(v) => v.pictures > 0 && !v.asked && !v.again", arg=shown)
        return picture.evaluate("(e) => e.src")

    before = settled()
    assert picture.evaluate("(e) => [e.naturalWidth, e.naturalHeight]") == [420, 380]
    shown.evaluate("(v) => v.clock.seek(1.5)")
    browser_page.wait_for_function("([e, src]) => e.src !== src", arg=[picture.element_handle(), before])
    at_rest = settled()
    count = shown.evaluate("(v) => v.pictures")
    box = picture.bounding_box()
    browser_page.mouse.move(box["x"] + 200, box["y"] + 150)
    browser_page.mouse.down()
    browser_page.mouse.move(box["x"] + 260, box["y"] + 150, steps=3)
    browser_page.mouse.up()
    browser_page.wait_for_function("([v, n]) => v.pictures > n", arg=[shown, count])
    assert settled() != at_rest
    browser_page.get_by_role("button", name="Play (Space)").click()
    count = shown.evaluate("(v) => v.pictures")
    browser_page.wait_for_function("([v, n]) => v.pictures >= n + 2", arg=[shown, count])
    assert views[-1][0].unavailable == WHY
    assert shown.evaluate("(v) => v.clock.t") > 0


def test_where_nothing_can_draw_it_says_what_to_install(serve, browser_page, spoken, monkeypatch):
    sentence = "Off-screen drawing does not work here; on Debian or Ubuntu install libegl1."
    monkeypatch.setattr(stills, "probe_offscreen", lambda: OffscreenStatus(False, sentence))
    browser_page.add_init_script(NO_WEBGL)
    browser_page.goto(serve(lambda: make_view(spoken)))
    alert = browser_page.get_by_role("alert")
    alert.wait_for()
    assert (
        alert.inner_text()
        == f"The 3-D view cannot be shown: {WHY}, and the server cannot draw it. {sentence}"
    )


def test_an_error_of_drawing_is_told(spoken):
    told, done = [], threading.Event()

    def reply(**answer):
        told.append(answer)
        done.set()

    view = make_view(spoken)
    scene = {"actors": [{**view.actors[0], "cells": b"123"}], "lights": [], "motion": {}, "camera": {}}
    moment = {"time": 0.0, "width": 100, "height": 100, "camera": None}
    stills.Stills().ask({**scene, "ground": GROUND, "revision": 1}, moment, reply)
    assert done.wait(60)
    assert told[0]["reason"].startswith("The server could not draw the picture (ValueError")
