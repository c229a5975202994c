import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings

from corpus_tools.core import FrameFlag
from corpus_tools.synthesis import align_fragments, alignment_facts, fragment_warp
from tests.strategies.fragments import NAMES, seeds, spliced


@settings(max_examples=10)
@given(seeds)
def test_every_way_is_compared_with_the_default_on_the_same_fragments(seed):
    selection, utterance, fragments = spliced(np.random.default_rng(seed), n_units=3)
    facts = alignment_facts(selection, utterance, fragments, names=NAMES)
    assert [(w.warp, w.resampling) for w in facts.ways] == [
        ("linear", "inverse"),
        ("pchip", "inverse"),
        ("linear", "paper"),
        ("pchip", "paper"),
    ]
    first, smooth, paper, _ = facts.ways
    assert (first.rms_mm, first.largest_mm) == (0.0, 0.0)
    assert 0 < paper.rms_mm <= paper.largest_mm
    assert smooth.jump_mm_s < 0.1 * first.jump_mm_s  # C1: no jump of velocity at a label
    other = align_fragments(selection, utterance, fragments, names=NAMES, warp="pchip")
    usual = align_fragments(selection, utterance, fragments, names=NAMES)
    pairs = zip(usual.pieces, other.pieces, strict=True)
    distance = np.concatenate([np.linalg.norm(a.motion_mm - b.motion_mm, axis=2).ravel() for a, b in pairs])
    assert smooth.rms_mm == pytest.approx(np.sqrt((distance**2).mean()))
    assert facts.samples == sum(len(p.motion_mm) for p in usual.pieces)


@settings(max_examples=10)
@given(seeds)
def test_stretches_name_the_most_changed_phone_first(seed):
    selection, utterance, fragments = spliced(np.random.default_rng(seed), n_units=3)
    stretches = alignment_facts(selection, utterance, fragments, names=NAMES).stretches
    changes = [abs(np.log(s.factor)) for s in stretches]
    assert changes == sorted(changes, reverse=True)
    for stretch in stretches:
        place = next(k for k, c in enumerate(selection.chosen) if c.unit.key == stretch.source)
        first = selection.chosen[place].first
        at = next(
            k
            for k, p in enumerate(utterance.phones.intervals)
            if k >= first and p.centre_s == stretch.time_s and p.text == stretch.phone
        )
        source_s = np.diff(fragments[place].edges_s)[at - first]
        assert stretch.factor == pytest.approx(utterance.phones.intervals[at].duration_s / source_s)


@settings(max_examples=10)
@given(seeds)
def test_samples_outside_the_capture_are_counted_and_flagged(seed):
    selection, utterance, fragments = spliced(np.random.default_rng(seed), n_units=2)
    cut = [_shortened(f) for f in fragments]
    pieces = align_fragments(selection, utterance, cut, names=NAMES)
    counted = sum(p.outside for p in pieces.pieces)
    assert counted == alignment_facts(selection, utterance, cut, names=NAMES).outside
    for piece in pieces.pieces:
        doubtful = ((piece.flags & FrameFlag.DOUBTFUL) > 0).all(axis=1)
        assert doubtful.sum() >= piece.outside
    assert counted > 0


def _shortened(fragment):
    """Return the fragment without the context on both sides: less than alignment asks for."""
    inside = (fragment.times_s >= fragment.edges_s[0]) & (fragment.times_s <= fragment.edges_s[-1])
    return dataclasses.replace(
        fragment,
        times_s=fragment.times_s[inside],
        motion_mm=fragment.motion_mm[inside],
        flags=fragment.flags[inside],
    )


def test_labels_that_fall_together_are_counted():
    selection, utterance, fragments = spliced(np.random.default_rng(3), n_units=2)
    edges = np.array(fragments[0].edges_s)
    edges[1] = edges[2] - 2e-4
    flat = dataclasses.replace(fragments[0], edges_s=edges)
    chosen = selection.chosen[0]
    spoken = utterance.phones.intervals[chosen.first : chosen.last + 1]
    assert fragment_warp(fragments[0], spoken).merged == 0
    assert fragment_warp(flat, spoken).merged >= 1
