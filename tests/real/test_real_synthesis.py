"""The main job on real recordings: held-out sentences of GRID speaker s1 speak, and their lips close."""

from __future__ import annotations

import numpy as np
import pytest

from corpus_tools.config import Config, config_with
from corpus_tools.io import init_corpus
from corpus_tools.mesh import signed_lip_aperture_mm
from corpus_tools.pipeline import open_corpus, prepare_head, synthesise

# the first is the example of the documentation; the others begin with p, hold b, or hold several of p b m
SENTENCES = ("bbaf2n", "pgix6n", "lbid2n", "swbo8n")


@pytest.fixture(scope="module")
def grid(corpora, tmp_path_factory):
    source = corpora / "grid_s1"
    folder = tmp_path_factory.mktemp("grid")
    init_corpus(
        folder / "work",
        motion=str(source / "markers73" / "{id}.npz"),
        audio=str(source / "wav" / "{id}.wav"),
        labels=str(source / "textgrid" / "{id}.TextGrid"),
        settings={
            "frame_time": "centre",
            "head_scale": "true",
            "phones": "arpabet",
            "reference_markers": "head*",
        },
    )
    return open_corpus(folder / "work")


@pytest.fixture(scope="module")
def head(grid):
    return prepare_head(grid, "base", Config())


def _aperture(grid, head, name):
    target = grid.utterance(name)
    result = synthesise(grid, target, Config(), head, exclude=(name,))
    return target, result, signed_lip_aperture_mm(result.vertices_mm, head.mesh)


@pytest.mark.parametrize("name", SENTENCES)
def test_lips_close_in_bilabials_and_open_in_vowels(grid, head, name):
    target, result, aperture = _aperture(grid, head, name)
    times = result.trajectory.times_s
    low, high = np.percentile(aperture, [5, 95])
    tenth = 0.1 * (high - low)
    assert high - low > 3
    bilabials = [p for p in target.phones if p.text in grid.phones.bilabials]
    vowels = [p for p in target.phones if p.text in grid.phones.vowels]
    assert bilabials
    assert vowels
    for phone in bilabials:
        inside = aperture[(times >= phone.start_s) & (times <= phone.end_s)]
        assert inside.min() <= tenth, f"{phone.text} at {phone.start_s:.2f} s stays open"
    assert aperture.min() >= -0.5
    opened = [aperture[(times >= p.start_s) & (times <= p.end_s)].max() for p in vowels]
    assert min(opened) > 2 * tenth


def test_the_held_out_recording_is_not_used(grid, head):
    _, result, _ = _aperture(grid, head, "bbaf2n")
    assert all(c.unit.recording != "bbaf2n" for c in result.selection.chosen)
    with_self = synthesise(grid, grid.utterance("bbaf2n"), Config(), head)
    assert {c.unit.recording for c in with_self.selection.chosen} == {"bbaf2n"}


def test_brows_keep_still_and_the_mouth_moves(grid, head):
    _, result, _ = _aperture(grid, head, "bbaf2n")
    spread = np.asarray(result.trajectory.values_mm).std(0).mean(1)
    names = np.array(result.trajectory.names)
    brow = spread[[n.startswith("brow") for n in names]].mean()
    lips = spread[[n.startswith("lip") for n in names]].mean()
    assert brow < 0.5 * lips


def test_viterbi_is_never_dearer_than_greedy(grid, head):
    for name in SENTENCES:
        target = grid.utterance(name)
        costs = {
            method: synthesise(
                grid, target, config_with(Config(), selection__method=method), head, exclude=(name,)
            ).selection.total_cost
            for method in ("viterbi", "greedy")
        }
        assert costs["viterbi"] <= costs["greedy"] + 1e-9
