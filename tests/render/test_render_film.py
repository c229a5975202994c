"""Films: sound and picture together, every picture there, equal bytes, nothing left after a failure."""

import dataclasses
import io
import math
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

from corpus_tools.config import Config, config_with
from corpus_tools.core import Audio, MissingExtraError, OutputError, Trajectory
from corpus_tools.io import write_wav
from corpus_tools.mesh import bundled_morph_mm
from corpus_tools.pipeline import prepare_head, synthesise
from corpus_tools.render import (
    MovingHead,
    encoding,
    ffmpeg_path,
    film_times_s,
    poses_at,
    snapshot,
    write_film,
    write_frames,
)

RATE_HZ, SOUND_HZ = 30.0, 25000
SMALL = config_with(Config(), film__width=96, film__height=80, film__rate_hz=RATE_HZ)


@pytest.fixture(autouse=True, scope="module")
def _can_draw(offscreen):
    """Everything here draws."""


@pytest.fixture(scope="module")
def head(opened_corpus):
    return prepare_head(opened_corpus, "base", Config())


@pytest.fixture(scope="module")
def spoken(opened_corpus, head):
    target = min((r.utterance for r in opened_corpus.recordings), key=lambda u: u.duration_s)
    return synthesise(opened_corpus, target, Config(), head, (target.name,))


def clap(spoken, head, at_s, motion_s, sound_s):
    """Return a synthesis whose mouth opens at once where a click sounds, and nothing else happens."""
    times = np.arange(int(120 * motion_s) + 1) / 120
    rest = head.mesh.vertices_mm
    still, wide = rest.astype(np.float32), (rest + 0.5 * bundled_morph_mm("jawOpen")).astype(np.float32)
    vertices = np.where((times >= at_s)[:, None, None], wide, still)
    sound = np.zeros(round(SOUND_HZ * sound_s), np.float32)
    sound[round(SOUND_HZ * at_s)] = 1.0
    values = np.zeros((len(times), 1, 3))
    return dataclasses.replace(
        spoken,
        utterance=dataclasses.replace(spoken.utterance, audio=Audio(sound, SOUND_HZ)),
        trajectory=Trajectory(times, values, ("one",), 120.0),
        vertices_mm=vertices,
    )


def decode(path, *options):
    command = [ffmpeg_path(), "-loglevel", "error", "-i", str(path), *options, "pipe:1"]
    return subprocess.run(command, check=True, capture_output=True).stdout


def pictures_of(path):
    raw = np.frombuffer(decode(path, "-map", "0:v", "-f", "rawvideo", "-pix_fmt", "gray"), np.uint8)
    return raw.reshape(-1, 80, 96).astype(int)


def sound_of(path):
    return np.frombuffer(decode(path, "-map", "0:a", "-f", "f32le", "-ac", "1"), np.float32)


def film(folder, synthesis, head, config=SMALL):
    folder.mkdir(exist_ok=True)
    write_wav(folder / "speech.wav", synthesis.utterance.audio)
    facts = write_film(folder, synthesis, head, config, lambda fraction, what: None)
    return folder / "film.mp4", facts


@pytest.mark.parametrize("at_s", [0.5, 1.013])
def test_sound_and_picture_are_within_a_frame_of_each_other(tmp_path, spoken, head, at_s):
    path, _ = film(tmp_path / "f", clap(spoken, head, at_s, 1.2, 1.2), head)
    pictures, sound = pictures_of(path), sound_of(path)
    change = np.abs(pictures - pictures[0]).sum(axis=(1, 2))
    seen_s = np.argmax(change > 0.5 * change.max()) / RATE_HZ
    heard_s = np.abs(sound).argmax() / 48000
    assert abs(heard_s - at_s) < 0.002
    assert abs(seen_s - heard_s) <= 0.5 / RATE_HZ + 0.002


@pytest.mark.parametrize(("motion_s", "sound_s"), [(0.5, 0.634), (0.634, 0.5)])
def test_nothing_is_cut_off_and_both_streams_last_equally_long(tmp_path, spoken, head, motion_s, sound_s):
    made = clap(spoken, head, 0.4, motion_s, sound_s)
    lasts = max(made.utterance.duration_s, sound_s)
    path, facts = film(tmp_path / "f", made, head)
    n = math.ceil(lasts * RATE_HZ)
    assert facts == {"file": "film.mp4", "pictures": n, "rate_hz": RATE_HZ}
    assert len(pictures_of(path)) == n
    assert abs(len(sound_of(path)) / 48000 - n / RATE_HZ) < 1024 / 48000


def test_frames_are_the_pictures_of_the_film(tmp_path, spoken, head):
    made = clap(spoken, head, 0.2, 0.4, 0.4)
    facts = write_frames(tmp_path, made, head, SMALL, lambda fraction, what: None)
    files = sorted((tmp_path / "frames").iterdir())
    assert [f.name for f in files] == [f"frame-{k:05d}.png" for k in range(facts["pictures"])]
    path, _ = film(tmp_path / "f", made, head)
    ours = np.array([np.asarray(Image.open(f).convert("L")) for f in files]).astype(int)
    assert np.abs(ours - pictures_of(path)).mean() < 4  # of 255: what H.264 and the narrower range take


def test_times_stand_in_the_middle_of_their_pictures():
    np.testing.assert_allclose(film_times_s(0.1, 30.0), [0.5 / 30, 1.5 / 30, 2.5 / 30])
    assert len(film_times_s(1.0, 30.0)) == 30
    assert len(film_times_s(1.001, 30.0)) == 31
    on_frames = film_times_s(2.0, 30.0) * 120
    np.testing.assert_allclose(on_frames, np.round(on_frames), atol=1e-9)


def test_poses_between_frames_are_linear_and_held_outside():
    vertices = np.array([[[0.0, 0, 0]], [[4.0, 0, 0]]], np.float32)
    poses = poses_at([1.0, 2.0], vertices, [0.0, 1.0, 1.25, 2.0, 9.0])
    np.testing.assert_allclose(np.ravel(poses)[::3], [0, 0, 1, 4, 4], atol=1e-6)


def test_a_picture_depends_on_its_pose_only(head):
    rest = head.mesh.vertices_mm
    wide = rest + 0.5 * bundled_morph_mm("jawOpen")
    with MovingHead(head.mesh, [rest, wide], size=(200, 120)) as moving:
        first, other, again = (moving.draw(pose) for pose in (rest, wide, rest))
        assert moving.margin > 20
    assert first.shape == (120, 200, 3)
    assert (first == again).all()
    assert (first != other).mean() > 0.02
    plain = np.asarray(Image.open(io.BytesIO(snapshot(head.mesh, wide, size=(200, 120))))).astype(int)
    assert np.abs(plain - other).mean() < 1.5  # one pose, drawn by the plain way


def test_points_are_found_in_the_picture(head):
    mesh = head.mesh
    with MovingHead(mesh, [mesh.vertices_mm], size=(200, 120)) as moving:
        places = moving.on_screen(mesh.vertices_mm[list(mesh.markers.values())])
    centre = places.mean(axis=0)
    assert abs(centre[0] - 100) < 2
    assert (places > 0).all()
    assert (places < [200, 120]).all()
    low = int(mesh.vertices_mm[list(mesh.markers.values())][:, 1].argmin())
    assert places[:, 1].argmax() == low


def test_without_the_extra_the_sentence_names_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(MissingExtraError, match=r"extra 'video'.*\[video\]"):
        ffmpeg_path()


def test_a_program_that_is_not_there_is_not_called_a_missing_extra(tmp_path, monkeypatch):
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(tmp_path / "none"))
    with pytest.raises(MissingExtraError, match=r"IMAGEIO_FFMPEG_EXE names '.*none'.*unset it"):
        ffmpeg_path()
    monkeypatch.delenv("IMAGEIO_FFMPEG_EXE")
    monkeypatch.setattr("imageio_ffmpeg.get_ffmpeg_exe", lambda: str(tmp_path / "gone"))
    with pytest.raises(MissingExtraError, match="without the program ffmpeg: pip install --force-reinstall"):
        ffmpeg_path()


def test_the_child_ends_when_we_are_stopped(tmp_path, spoken):
    write_wav(tmp_path / "s.wav", spoken.utterance.audio)
    with (
        pytest.raises(KeyboardInterrupt),
        encoding(tmp_path / "f.mp4", (16, 16), 30.0, tmp_path / "s.wav", 1) as e,
    ):
        e.add(np.zeros((16, 16, 3), np.uint8))
        raise KeyboardInterrupt
    assert e.child.returncode is not None


def test_a_killed_ffmpeg_is_not_called_a_full_disk(tmp_path, spoken):
    write_wav(tmp_path / "s.wav", spoken.utterance.audio)
    with (
        pytest.raises(OutputError, match=r"ended by SIGKILL before the film was whole; try again") as caught,
        encoding(tmp_path / "f.mp4", (16, 16), 30.0, tmp_path / "s.wav", 1.0) as e,
    ):
        e.child.kill()
        for _ in range(2000):
            e.add(np.zeros((16, 16, 3), np.uint8))
    assert "disk" not in str(caught.value)


def test_what_ffmpeg_says_becomes_one_sentence(tmp_path):
    with (
        pytest.raises(OutputError, match=r"ffmpeg could not write the film: .*No such file[^.]*; try again"),
        encoding(tmp_path / "f.mp4", (16, 16), 30.0, tmp_path / "none.wav", 1.0) as e,
    ):
        for _ in range(2000):
            e.add(np.zeros((16, 16, 3), np.uint8))
