"""Pictures of the head: something is drawn, parts have their colours, lips open where they should."""

import io
from dataclasses import replace

import numpy as np
import pytest
import pyvista as pv
from PIL import Image

from corpus_tools.core import Mesh
from corpus_tools.mesh import bundled_head, bundled_morph_mm, level_neck, neck_rim
from corpus_tools.render import (
    VIEWS,
    MovingHead,
    drawn_part,
    part_surface,
    scene,
    snapshot,
)


@pytest.fixture(scope="module")
def head():
    return bundled_head()


@pytest.fixture(autouse=True, scope="module")
def _can_draw(offscreen):
    """Everything here draws."""


def picture(png):
    return np.asarray(Image.open(io.BytesIO(png))).astype(int)


@pytest.mark.parametrize("view", list(VIEWS))
def test_every_view_shows_a_face_on_a_plain_ground(head, view):
    image = picture(snapshot(head, view=view, size=(160, 200)))
    assert image.shape == (200, 160, 3)
    ground = image[0, 0]
    covered = (np.abs(image - ground).sum(axis=2) > 30).mean()
    assert 0.3 < covered < 0.98


def test_front_view_is_symmetric_in_outline(head):
    image = picture(snapshot(head, size=(200, 220)))
    covered = np.abs(image - image[0, 0]).sum(axis=2) > 30
    assert (covered != covered[:, ::-1]).mean() < 0.02


def test_open_mouth_shows_teeth_and_dark_that_the_closed_one_hides(head):
    opened = head.vertices_mm + 0.25 * bundled_morph_mm("jawOpen")
    closed = picture(snapshot(head, zoom_mm=60.0, size=(200, 200)))
    wide = picture(snapshot(head, opened, zoom_mm=60.0, size=(200, 200)))

    def bright_and_dark(image):
        middle = image[60:160, 40:160]
        white = (np.ptp(middle, axis=2) < 25) & (middle.max(axis=2) > 120)
        return white.sum(), (middle.max(axis=2) < 60).sum()

    assert bright_and_dark(closed)[0] < 10
    assert bright_and_dark(wide)[0] > 100
    assert bright_and_dark(wide)[1] > bright_and_dark(closed)[1] + 50


def test_scene_has_one_actor_a_part_and_dots_on_request(head):
    plotter = scene(head, markers=True, size=(60, 60))
    try:
        assert isinstance(plotter, pv.Plotter)
        assert set(plotter.actors) == {*head.part_names, "markers"}
    finally:
        plotter.close()


@pytest.mark.parametrize("view", list(VIEWS))
@pytest.mark.parametrize("name", ["base", "baby", "cartoon"])
def test_crown_and_open_jaw_are_inside_and_the_end_of_the_neck_is_not(name, view):
    mesh, (width, height) = bundled_head(name), (160, 90)
    skin = mesh.vertices_mm[mesh.part_mask("skin")]
    chin = min((mesh.vertices_mm[v] for v in mesh.markers.values()), key=lambda p: p[1])
    with MovingHead(mesh, mesh.vertices_mm, size=(width, height), view=view) as moving:
        above = moving.on_screen(skin[skin[:, 1] >= chin[1]])
        jaw = moving.on_screen(chin - [0.0, 12.0, 0.0])[0]
        end = moving.on_screen(level_neck(mesh).vertices_mm[neck_rim(mesh)])
    assert above[:, 1].min() == pytest.approx(0.04 * height, abs=0.5)
    assert (above[:, 0] > 0).all()
    assert (above[:, 0] < width).all()
    assert 0.8 * height < jaw[1] < 0.97 * height
    assert (end[:, 1] > height).all()


def test_camera_does_not_follow_the_motion(head):
    cameras = []
    for shift in (0.0, 20.0):
        plotter = scene(head, head.vertices_mm + shift, size=(60, 60))
        cameras.append((tuple(plotter.camera.position), tuple(plotter.camera.focal_point)))
        plotter.close()
    assert cameras[0] == cameras[1]


def test_surfaces_keep_the_vertex_numbers_of_the_mesh(head):
    seen = []
    for part in head.part_names:
        surface = part_surface(head, part)
        vertex = surface.point_data["vertex"]
        away = np.linalg.norm(surface.points - head.vertices_mm[vertex], axis=1)
        own = away < 1e-3
        assert set(vertex[own]) == set(np.flatnonzero(head.part_mask(part)))
        assert own.all() == (part in ("skin", "tongue"))
        assert away.max() < 12.0  # what lies between belongs to an end of its edge
        seen.append(np.unique(vertex))
    assert sorted(np.concatenate(seen).tolist()) == list(range(head.n_vertices))


@pytest.mark.parametrize("part", ["skin", "eyes", "upper_teeth", "tongue"])
def test_drawn_parts_follow_the_mesh(head, part):
    drawn = drawn_part(head, part)
    turn = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    shift = np.array([3.0, -2.0, 1.0])
    moved = drawn.points_mm(head.vertices_mm + shift)
    np.testing.assert_allclose(moved, drawn.points_mm(head.vertices_mm) + shift, atol=1e-9)
    points = drawn.points_mm(head.vertices_mm)
    normals = drawn.normals(points)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-9)
    np.testing.assert_allclose(drawn.normals(points @ turn.T), normals @ turn.T, atol=1e-9)


def test_eyeballs_are_round_with_one_iris_each(head):
    drawn = drawn_part(head, "eyes")
    points = drawn.points_mm(head.vertices_mm)
    assert drawn.colours is not None
    for side in (points[:, 0] > 0, points[:, 0] < 0):
        ball = points[side]
        centre = 0.5 * (ball.min(axis=0) + ball.max(axis=0))
        radius = np.linalg.norm(ball - centre, axis=1)
        assert np.ptp(radius) < 0.05
        dark = ball[drawn.colours[side].max(axis=1) < 0.1] - centre
        assert len(dark) > 3
        assert (np.hypot(dark[:, 0], dark[:, 1]) < 3).all()
        assert (dark[:, 2] > 10).all()


def test_teeth_are_told_apart(head):
    """Along the arch the brightness falls at every gap: two incisors and more on either side."""
    drawn = drawn_part(head, "upper_teeth")
    points, shade = drawn.points_mm(head.vertices_mm), drawn.colours[:, 0]
    front = points[:, 2] > points[:, 2].max() - 12
    arc = np.round(points[front, 0])
    mean = np.array([shade[front][arc == x].mean() for x in np.unique(arc)])
    dips = (mean[1:-1] < mean[:-2] - 0.02) & (mean[1:-1] < mean[2:] - 0.02)
    assert dips.sum() >= 3


def test_a_plain_mesh_without_markers_is_drawn_too():
    ball = pv.Sphere(radius=50.0)
    faces = ball.regular_faces
    mesh = Mesh("ball", np.asarray(ball.points, float), faces, np.zeros(ball.n_points, np.int8))
    image = picture(snapshot(mesh, size=(100, 100)))
    assert 0.2 < (np.abs(image - image[0, 0]).sum(axis=2) > 30).mean() < 0.9


def test_a_mesh_of_skin_alone_moves_in_the_colour_of_skin(head):
    """The last part was drawn in the colours of its normals while it moved."""
    skin = head.faces[head.part_mask("skin")[head.faces].all(axis=1)]
    alone = replace(head, faces=skin, part=np.zeros_like(head.part), part_names=("skin",))
    with MovingHead(alone, alone.vertices_mm, size=(120, 90)) as moving:
        red, green, blue = moving.draw(alone.vertices_mm)[30, 60].astype(int)
    assert red > green > blue
