"""Speed of every stage that a slider waits for, on the simulated corpus; run by ``make bench``.

Nothing here fails.

Bars of 2 cores, otherwise idle, stand beside each stage; the figures are kept in results/.
"""

from __future__ import annotations

import numpy as np
import pytest

from corpus_tools.cleaning import clean_captures
from corpus_tools.config import Config, config_with
from corpus_tools.fragments import build_inventory
from corpus_tools.io import find_recordings, load_capture, read_description
from corpus_tools.pipeline import align_units, animate, blend_units, prepare_head, select_units, vertex_frames
from corpus_tools.pipeline.reading import reference_columns


@pytest.fixture(scope="module")
def head(opened_corpus):
    return prepare_head(opened_corpus, "base", Config())


@pytest.fixture(scope="module")
def target(opened_corpus):
    return opened_corpus.recordings[0].utterance


@pytest.fixture(scope="module")
def pieces(opened_corpus, target):
    selection = select_units(opened_corpus, target, Config(), (target.name,))
    return align_units(opened_corpus, target, selection, Config())


@pytest.fixture(scope="module")
def trajectory(opened_corpus, target, pieces):
    return blend_units(opened_corpus, target, pieces, Config())


@pytest.mark.parametrize("method", ["greedy", "viterbi"])
def test_select(benchmark, opened_corpus, target, method):
    """Bar: greedy 3 ms, Viterbi 15 ms for 3 s."""
    config = config_with(Config(), selection__method=method)
    chosen = benchmark(select_units, opened_corpus, target, config, (target.name,)).chosen
    assert chosen[-1].last == len(target.phones) - 1


def test_align(benchmark, opened_corpus, target):
    selection = select_units(opened_corpus, target, Config(), (target.name,))
    assert benchmark(align_units, opened_corpus, target, selection, Config()).pieces


def test_blend_and_close(benchmark, opened_corpus, target, pieces):
    """What a drag of g(u) repeats; bar: 15 ms."""
    assert np.isfinite(benchmark(blend_units, opened_corpus, target, pieces, Config()).values_mm).all()


def test_retarget(benchmark, head, trajectory):
    """Bar: 30 ms for 300 frames."""
    assert len(benchmark(animate, head, trajectory).targets_mm) == len(trajectory.times_s)


def test_deform(benchmark, head, trajectory):
    """Bar: 60 ms for 300 frames of the bundled head."""
    animation = animate(head, trajectory)
    assert benchmark(vertex_frames, head, animation).dtype == np.float32


def test_index(benchmark, opened_corpus):
    """Bar: 100 ms at 1e5 phones."""
    assert benchmark(build_inventory, opened_corpus.recordings).n_phones > 100


def test_clean(benchmark, simulated_corpus):
    description = read_description(simulated_corpus)
    captures = [load_capture(description, f) for f in find_recordings(description)]
    columns = reference_columns(description, captures[0])
    cleaned = benchmark.pedantic(clean_captures, (captures, columns), {"allow_scale": False}, rounds=3)
    assert len(cleaned.captures) == len(captures)
