"""Actors as plain data: cells of every kind, scalars as pyvista maps them, motion sent once."""

import numpy as np
import pytest
import pyvista as pv
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import MeshError
from workbench.views.cells import cells_of
from workbench.views.motion_data import motion_data
from workbench.views.plotter_scene import plotter_actors
from workbench.views.scalars import scalar_colours
from workbench.views.scene_actors import surface_actor


def floats(data):
    return np.frombuffer(data, np.float32)


def corners(actor):
    return np.frombuffer(actor["cells"], np.uint32)


@given(st.lists(st.integers(2, 6), min_size=1, max_size=5))
def test_lines_are_all_steps_of_every_polyline(lengths):
    n = sum(lengths)
    starts = np.cumsum([0, *lengths])
    cells = np.concatenate([[k, *range(a, a + k)] for k, a in zip(lengths, starts, strict=False)])
    found = cells_of("lines", pv.PolyData(np.random.default_rng(n).random((n, 3)), lines=cells))
    steps = [(i, i + 1) for k, a in zip(lengths, starts, strict=False) for i in range(a, a + k - 1)]
    assert found.kind == "lines"
    assert [tuple(s) for s in found.corners] == steps
    assert list(found.owner) == [k for k, length in enumerate(lengths) for _ in range(length - 1)]


def test_a_wireframe_goes_round_every_face_and_not_through_it():
    quad = pv.PolyData(np.eye(4, 3), faces=[4, 0, 1, 2, 3])
    found = cells_of("quad", quad, "wireframe")
    assert {frozenset(s) for s in found.corners.tolist()} == {
        frozenset(s) for s in ((0, 1), (1, 2), (2, 3), (3, 0))
    }
    assert len(cells_of("quad", quad).corners) == 2
    assert cells_of("quad", quad, "points").kind == "points"


def test_strips_are_surfaces_and_a_mixture_is_refused_by_name():
    strip = pv.Sphere().strip()
    assert strip.n_strips
    assert len(corners(surface_actor("ball", strip))) == 3 * pv.Sphere().n_cells
    both = pv.PolyData(np.eye(3), faces=[3, 0, 1, 2], lines=[2, 0, 1])
    with pytest.raises(MeshError, match="'both' has faces and lines"):
        surface_actor("both", both)


@pytest.mark.parametrize("options", [{}, {"clim": (0.1, 0.6)}, {"log_scale": True}, {"n_colors": 7}])
@pytest.mark.parametrize("by", ["point", "cell"])
def test_scalars_map_to_the_colours_of_pyvista(by, options):
    surface = pv.Sphere(theta_resolution=9, phi_resolution=9)
    n = surface.n_points if by == "point" else surface.n_cells
    surface[by] = np.random.default_rng(7).uniform(0.01, 1, n)
    plotter = pv.Plotter(off_screen=True)
    bar = {"title": "Speed, mm/s"}
    added = plotter.add_mesh(surface, scalars=by, name="ball", cmap="plasma", scalar_bar_args=bar, **options)
    (actor,) = plotter_actors(plotter)
    scalars = actor["scalars"]
    assert (scalars["title"], scalars["legend"]) == ("Speed, mm/s", True)
    table = np.frombuffer(scalars["table"], np.uint8).reshape(-1, 4)
    values, (low, high) = floats(scalars["values"]), scalars["range"]
    colours = len(table) - 3
    place = np.clip(((values - low) / (high - low) * colours).astype(int), 0, colours - 1) + 1
    if by == "cell":
        place = place.reshape(-1, 3)[:, 0]
    added.mapper.SetInterpolateScalarsBeforeMapping(0)
    wanted = np.array(pv.convert_array(added.mapper.MapScalars(added.mapper.dataset, 1.0)), int)
    away = np.abs(table[place].astype(int) - wanted).max(axis=1)
    assert (away == 0).mean() > 0.98  # the rest lies on the edge of two colours
    assert away.max() <= 256 / colours * 2.5
    plotter.close()


def test_flat_actors_tell_the_points_they_were_made_of():
    surface = pv.Plane(i_resolution=2, j_resolution=2).triangulate()
    actor = surface_actor("plate", surface, flat=True, basis=np.arange(9.0)[:, None])
    ids = np.frombuffer(actor["ids"], np.uint32)
    assert list(ids) == list(surface.regular_faces.ravel())
    np.testing.assert_array_equal(floats(actor["basis"]), ids.astype(np.float32))
    assert list(corners(actor)) == list(range(24))


def test_refusals_name_the_actor():
    plate = pv.Plane()
    with pytest.raises(MeshError, match=r"scalars of 'plate' are 3; 121"):
        surface_actor("plate", plate, scalars=scalar_colours([1.0, 2.0, 3.0]))
    with pytest.raises(MeshError, match="one row of numbers"):
        scalar_colours(np.eye(3))
    with pytest.raises(MeshError, match="above 0"):
        scalar_colours([0.0, 1.0], log=True)
    patches = {"of": "skin", "attached": b""}
    with pytest.raises(MeshError, match="'plate' hangs on patches"):
        surface_actor("plate", plate, flat=True, patches=patches)


def test_actors_with_the_same_motion_share_one_track():
    plate = surface_actor("a", pv.Plane(i_resolution=1, j_resolution=1), basis=np.ones((4, 2)))
    actors = {name: {**plate, "name": name} for name in "abc"}
    same, other = np.zeros((5, 2, 3), np.float32), np.ones((5, 2, 3), np.float32)
    sent = motion_data(
        actors, 60, {"a": same, "b": same, "c": other}, {"a": np.tile(np.eye(4), (5, 1, 1))}, None, 0
    )
    assert [(t["kind"], t["actors"]) for t in sent["tracks"]] == [
        ("deform", ["a", "b"]),
        ("deform", ["c"]),
        ("rigid", ["a"]),
    ]
    assert sent["frames"] == 5
    with pytest.raises(MeshError, match=r"\(frames, 2, 3\) was expected"):
        motion_data(actors, 60, {"a": np.zeros((5, 3, 3))}, None, None, 0)
    with pytest.raises(MeshError, match=r"one number of frames, at least 1; it has \[4, 5\]"):
        motion_data(actors, 60, {"a": same, "b": np.zeros((4, 2, 3))}, None, None, 0)
