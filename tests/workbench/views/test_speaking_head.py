"""A head in a notebook cell moves as its animation says, from the first frame at its own rate."""

import numpy as np
import pytest

from corpus_tools.mesh import DEFORMERS, bundled_head
from corpus_tools.pipeline import Animation, Head
from workbench.views.speaking_head import move_head, show_head


@pytest.fixture(scope="module", params=["bid", "rbf"])
def head(request):
    mesh = bundled_head()
    names = tuple(mesh.markers)
    return Head(mesh, names, None, DEFORMERS[request.param](mesh, names))


def animation(head, n_frames, rate_hz, start_s=0.0):
    shift = np.zeros((n_frames, len(head.names), 3))
    shift[:, :, 1] = -np.linspace(0, 5, n_frames)[:, None]
    targets = head.binding.rest_mm + shift
    return Animation(start_s + np.arange(n_frames) / rate_hz, targets, head.binding.rigid(targets)), shift


def test_a_head_is_shown_in_one_line_and_moves_as_it_is_told(head):
    spoken, shift = animation(head, 13, 120.0)
    view = show_head(head, spoken, session="cell")
    assert view.session == "cell"
    assert view.wheel_needs_ctrl  # else the wheel would fly through the face where it should scroll the page
    assert not show_head(head, wheel_needs_ctrl=False).wheel_needs_ctrl
    assert {a["name"] for a in view.actors} == set(head.mesh.part_names)
    for frames, rate, start in ((13, 120.0, 0.0), (31, 60.0, 0.25), (1, 1.0, 0.0)):
        spoken, shift = animation(head, frames, rate, start)
        move_head(view, head, spoken)
        motion = view.motion
        assert (motion["rate"], motion["start"], motion["frames"]) == (rate, start, frames)
        tracks = {name: t for t in motion["tracks"] for name in t["actors"]}
        assert np.frombuffer(tracks["skin"]["values"], np.float32) == pytest.approx(shift.ravel(), abs=1e-4)
        assert {"lower_teeth", "tongue"} <= set(tracks)


def test_without_an_animation_it_rests(head):
    assert not show_head(head).motion.get("tracks")
