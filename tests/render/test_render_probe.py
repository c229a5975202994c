"""The probe survives a child that dies, and says what to install."""

import os

import pytest

from corpus_tools.core import MissingExtraError
from corpus_tools.mesh import bundled_head
from corpus_tools.render import apply_window, probe, probe_offscreen, scene
from corpus_tools.render.probe import OffscreenStatus


@pytest.fixture
def fresh():
    probe_offscreen.cache_clear()
    yield
    probe_offscreen.cache_clear()


@pytest.mark.parametrize(
    ("script", "words"),
    [
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "SIGSEGV"),
        ("raise SystemExit('no picture here')", "no picture here"),
        ("raise SystemExit(3)", "exit code 3"),
        ("import time; time.sleep(60)", "within 2 s"),
    ],
)
def test_a_child_that_fails_is_reported_with_the_package(fresh, monkeypatch, script, words):
    monkeypatch.setattr(probe, "DRAW", script)
    status = probe_offscreen(timeout_s=2.0)
    assert not status.ok
    assert words in status.reason
    assert "libegl1" in status.reason
    assert "libosmesa6" in status.reason
    assert status.package == "libegl1 libgl1-mesa-dri"


def test_scene_refuses_with_that_sentence_instead_of_dying(fresh, monkeypatch):
    monkeypatch.setattr(probe, "DRAW", "import os; os.abort()")
    with pytest.raises(MissingExtraError, match="ended by SIGABRT"):
        scene(bundled_head())


def test_the_second_window_class_is_tried(fresh, monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.setattr(
        probe,
        "DRAW",
        "import os; assert 'OSOpenGL' in os.environ['VTK_DEFAULT_OPENGL_WINDOW']; print('drawn')",
    )
    assert probe_offscreen() == OffscreenStatus(True, window="vtkOSOpenGLRenderWindow")


def test_what_the_user_set_is_kept(monkeypatch):
    monkeypatch.setenv("VTK_DEFAULT_OPENGL_WINDOW", "vtkXOpenGLRenderWindow")
    apply_window(OffscreenStatus(True, window="vtkEGLRenderWindow"))
    assert os.environ["VTK_DEFAULT_OPENGL_WINDOW"] == "vtkXOpenGLRenderWindow"


def test_the_answer_is_remembered(fresh, monkeypatch):
    monkeypatch.setattr(probe, "DRAW", "print('drawn')")
    assert probe_offscreen().ok
    monkeypatch.setattr(probe, "DRAW", "raise SystemExit(1)")
    assert probe_offscreen().ok
