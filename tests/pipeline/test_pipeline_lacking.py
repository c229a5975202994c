"""Corpora of every motion format are checked, and told what they lack and how to set them right."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from corpus_tools.io import (
    MOTION_WRITERS,
    CorpusDescription,
    find_recordings,
    init_corpus,
    load_capture,
    read_description,
    write_description,
)
from corpus_tools.pipeline import check_corpus, health_lines
from corpus_tools.pipeline.lacking import offset_advice

SUFFIX = {"npz": "npz", "c3d": "C3D", "trc": "trc", "csv": "csv", "csv-long": "csv"}
NAMES = ["head0", "head1", "head2", "lip", "chin"]
POSITIONS = np.random.default_rng(0).normal(0, 60, (40, 5, 3))


def corpus(folder, form, positions=POSITIONS, names=NAMES, **settings):
    place = folder / "mé my takes"
    place.mkdir()
    MOTION_WRITERS[form](place / f"a b.{SUFFIX[form]}", positions, names, 100.0)
    init_corpus(folder / "work", motion=f"{place}/{{id}}.{SUFFIX[form]}", settings=settings)
    return folder / "work"


@pytest.mark.parametrize("form", SUFFIX)
def test_a_corpus_of_motion_alone_is_checked_and_told_what_it_can_do(tmp_path, form):
    assert set(SUFFIX) == set(MOTION_WRITERS)
    report = check_corpus(corpus(tmp_path, form))
    (row,) = report["recordings"]
    assert (row["id"], row["n_frames"], row["problems"]) == ("a b", 40, [])
    assert row["rate_hz"] == pytest.approx(100.0)
    labels, sound = report["told"]
    assert "nothing can be synthesised" in labels
    assert "silent" in sound
    assert labels in health_lines(report)


@pytest.mark.parametrize(
    ("frame_time", "frames", "line"),
    [
        ("start", 0.5, 'frame_time = "centre"'),
        ("centre", 0.5, "audio_offset_s = 0.120"),
        ("start", -0.5, "audio_offset_s = 0.080"),
        ("start", 2.0, "audio_offset_s = 0.180"),
    ],
)
def test_an_offset_of_half_a_frame_asks_for_the_centre_and_another_for_itself(frame_time, frames, line):
    described = CorpusDescription(folder=Path("work"), motion="", frame_time=frame_time, audio_offset_s=0.1)
    assert offset_advice(described, frames / 25, 25.0) == [line]
    assert offset_advice(described, 0.0049, 250.0) == []
    assert offset_advice(described, None, 25.0) == []


def test_without_rigid_markers_a_corpus_that_is_only_read_is_told(tmp_path):
    report = check_corpus(corpus(tmp_path, "c3d", names=["a", "b", "c", "d", "e"]))
    assert "at least 3 rigid markers" in report["told"][2]


def test_what_is_doubtful_in_a_file_is_a_problem_of_its_recording(tmp_path):
    positions = POSITIONS.copy()
    positions[3, 2] = 0.0
    (row,) = check_corpus(corpus(tmp_path, "c3d", positions))["recordings"]
    assert row["problems"] == [
        "1 positions are exactly (0, 0, 0), first in frame 3: some programs write gaps so; "
        "export them as missing."
    ]


def test_a_file_that_says_z_is_up_gives_the_line_that_turns_it(tmp_path):
    folder = corpus(tmp_path, "c3d")
    assert check_corpus(folder).get("advice", []) == []
    (path,) = tmp_path.rglob("*.C3D")
    data = path.read_bytes()
    at = data.index(b"Y_SCREEN")
    plus = data.index(b"+Y", at)
    path.write_bytes(data[:plus] + b"+Z" + data[plus + 2 :])
    report = check_corpus(folder)
    assert report["advice"] == ['marker_axes = "x,z,-y"']
    assert "Advice: set 'marker_axes = \"x,z,-y\"' in corpus.toml." in health_lines(report)
    description = dataclasses.replace(read_description(folder), marker_axes="x,z,-y")
    write_description(description)
    assert check_corpus(folder).get("advice", []) == []
    turned = load_capture(description, find_recordings(description)[0]).positions_mm
    np.testing.assert_allclose(turned, POSITIONS[:, :, [0, 2, 1]] * [1, 1, -1], rtol=1e-6)


@pytest.mark.parametrize("second", [["chin", "lip", "head2", "head1", "head0"]])
def test_the_same_markers_in_another_order_are_the_same_markers(tmp_path, second):
    folder = corpus(tmp_path, "csv")
    order = [NAMES.index(n) for n in second]
    MOTION_WRITERS["csv"](tmp_path / "mé my takes" / "b.csv", POSITIONS[:, order], second, 100.0)
    assert [row["problems"] for row in check_corpus(folder)["recordings"]] == [[], []]


def test_what_exclude_leaves_out_is_told_and_a_name_that_is_none(tmp_path):
    folder = corpus(tmp_path, "csv")
    description = read_description(folder)
    write_description(dataclasses.replace(description, exclude=("a b", "a c")))
    told = check_corpus(folder)["told"]
    assert any("leaves out 1 of 1 recording." in line for line in told)
    assert any("'a c', which is no recording; did you mean 'a b'?" in line for line in told)
