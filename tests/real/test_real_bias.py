"""Recordings of GRID keep a posture of more than 1 mm; without it held-out sentences come nearer."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from corpus_tools.config import Config, config_with
from corpus_tools.fragments import build_inventory
from corpus_tools.io import init_corpus
from corpus_tools.pipeline import align_units, blend_units, open_corpus, select_units
from corpus_tools.synthesis import prepare_selection
from corpus_tools.synthesis.lips import lip_model


@pytest.fixture(scope="module", params=["greedy", "viterbi"])
def method(request):
    return request.param


@pytest.fixture(scope="module")
def corpora_of_grid(corpora, tmp_path_factory):
    """Return the corpus with postures left in, and freed of them."""
    source, folder = corpora / "grid_s1", tmp_path_factory.mktemp("grid") / "work"
    init_corpus(
        folder,
        motion=str(source / "markers73" / "{id}.npz"),
        labels=str(source / "textgrid" / "{id}.TextGrid"),
        settings={
            "frame_time": "centre",
            "head_scale": "true",
            "phones": "arpabet",
            "reference_markers": "head*",
        },
    )
    freed = open_corpus(
        folder, config_with(Config(), cleaning__head_support=False)
    )  # as decision 009 measured
    before = tuple(replace(r, capture=freed.recorded(r.name)) for r in freed.recordings)
    model = prepare_selection(build_inventory(before), freed.phones)
    lips = lip_model(before, freed.phones, Config().closure.components)
    return {True: freed, False: replace(freed, recordings=before, model=model, lips=lips, offsets_mm={})}


def squared_error(corpus, name, config):
    """Return (sum of squares, frames) of a synthesis against the recording in its own posture, in speech."""
    target, truth = corpus.utterance(name), corpus.recorded(name)
    pieces = align_units(corpus, target, select_units(corpus, target, config, exclude=[name]), config)
    blend = blend_units(corpus, target, pieces, config)
    spoken = [p for p in target.phones if p.text != corpus.phones.silence]
    times = truth.times_s[(truth.times_s >= spoken[0].start_s) & (truth.times_s <= spoken[-1].end_s)]
    columns = list(corpus.natural.columns)
    nearest = np.abs(blend.times_s[:, None] - times).argmin(axis=0)
    frames = np.searchsorted(truth.times_s, times)
    error = np.asarray(blend.values_mm)[nearest][:, columns] - truth.positions_mm[frames][:, columns]
    return (error**2).sum(), len(times)


def test_the_postures_are_as_measured(corpora_of_grid):
    sizes = np.array(list(corpora_of_grid[True].bias_mm.values()))
    assert len(sizes) == 203
    assert 1.1 < np.sqrt((sizes**2).mean()) < 1.6
    assert max(sizes) < 4


def test_held_out_sentences_come_nearer(corpora_of_grid, method):
    """.89 of the error was measured with held-out recordings truly left out; .90 on every fourth sentence."""
    config = config_with(Config(), selection__method=method)
    names = corpora_of_grid[True].names[::8]
    rmse = {}
    for on, corpus in corpora_of_grid.items():
        squares, frames = np.sum([squared_error(corpus, n, config) for n in names], axis=0)
        rmse[on] = np.sqrt(squares / frames)
    assert rmse[True] < 0.93 * rmse[False]


def test_closures_are_what_they_were(corpora_of_grid):
    kept, freed = (corpora_of_grid[on].lips for on in (False, True))
    assert freed.threshold_mm == pytest.approx(kept.threshold_mm, abs=1e-6)
    assert freed.target_mm == pytest.approx(kept.target_mm, abs=1e-6)
