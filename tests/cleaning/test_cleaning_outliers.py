"""Spikes, exchanged markers and slips: found where they were put, and nowhere else; flagged to the end."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from corpus_tools.cleaning import (
    clean_captures,
    face_model,
    fill_gaps,
    find_outliers,
    find_slips,
    usual_spread_mm,
    with_slips_marked,
    without_outliers,
)
from corpus_tools.core import Capture, FrameFlag

RATE_HZ, N_MARKERS = 120.0, 30
OUTLIER, FILLED, DOUBTFUL = int(FrameFlag.OUTLIER), int(FrameFlag.FILLED), int(FrameFlag.DOUBTFUL)
NAMES = (*(f"head{i}" for i in range(6)), *(f"face{i}" for i in range(N_MARKERS - 6)))
seeds = st.integers(0, 2**31)


def face(seed=0, n_frames=900):
    """Return a simulated face: 5 gestures below 6 Hz that the lower face shows most, skin, noise."""
    rng = np.random.default_rng(seed)
    times = np.arange(n_frames)[:, None, None] / RATE_HZ
    hz, phase = rng.uniform(0.5, 6.0, (8, 5)), rng.uniform(0, 6.3, (8, 5))
    gestures = np.sin(2 * np.pi * hz * times + phase).sum(axis=1)
    mixed = gestures @ np.random.default_rng(1).normal(0, 1.0, (5, 3 * N_MARKERS))
    moving = mixed.reshape(n_frames, N_MARKERS, 3)
    moving[:, :6] = 0.0
    moving[:, 6:18] *= 0.1  # brows and cheeks are quiet
    grid = np.stack([*np.divmod(np.arange(N_MARKERS), 6), np.sin(np.arange(N_MARKERS))], axis=1) * 12.0
    skin = 0.1 * np.sin(2 * np.pi * 2.0 * times + rng.uniform(0, 6.3, (1, N_MARKERS, 3)))
    return grid + moving + skin + rng.normal(0, 0.05, moving.shape)


def capture(positions):
    return Capture(positions, RATE_HZ, NAMES)


@pytest.fixture(scope="module")
def known():
    whole = [capture(face(seed)) for seed in range(3)]
    model = face_model(whole)
    return model, usual_spread_mm(whole, model)


def spiked(positions, rng, n=20, least_mm=1.5):
    where = np.zeros(positions.shape[:2], bool)
    for _ in range(n):
        first, marker = int(rng.integers(2, len(positions) - 4)), int(rng.integers(N_MARKERS))
        where[first : first + int(rng.integers(1, 3)), marker] = True
    jump = rng.normal(size=positions.shape)
    jump *= rng.uniform(least_mm, 6.0, where.shape)[..., None] / np.linalg.norm(jump, axis=2, keepdims=True)
    return positions + jump * where[..., None], where


@settings(max_examples=8)
@given(seeds)
def test_spikes_are_found_where_they_are_and_nowhere_else(known, seed):
    seen, where = spiked(face(seed % 1000), np.random.default_rng(seed))
    found = find_outliers(capture(seen), *known)
    assert (found.spiked & where).sum() >= 0.9 * where.sum()
    assert (found.spiked & ~where).sum() == 0
    assert not found.swaps


@settings(max_examples=8)
@given(seeds)
def test_a_face_that_only_moves_has_none(known, seed):
    """However fast: the same motion at three times its pace is told by the others too."""
    quick = face(seed % 1000)[::3]
    assert not find_outliers(capture(quick), *known).doubted.any()
    assert find_slips(capture(face(seed % 1000)), known[0], range(6)) == ()


@settings(max_examples=8)
@given(seeds, st.integers(4, 60), st.integers(100, 800))
def test_exchanged_markers_are_found_to_the_frame(known, seed, length, first):
    positions = face(seed % 1000)
    one = int(np.random.default_rng(seed).choice([m for m in range(6, N_MARKERS) if m % 6 < 5]))
    span = slice(first, first + length)
    positions[span, [one, one + 1]] = positions[span, [one + 1, one]]
    found = find_outliers(capture(positions), *known)
    assert found.swaps == ((first, first + length - 1, one, one + 1),)
    assert found.swapped.sum() == 2 * length
    assert not (found.spiked & found.swapped).any()


@settings(max_examples=8)
@given(seeds, st.floats(1.5, 5.0))
def test_a_marker_that_slid_is_doubtful_from_then_on(known, seed, size_mm):
    positions, marker = face(seed % 1000), 6 + seed % (N_MARKERS - 6)
    direction = np.random.default_rng(seed).normal(size=3)
    positions[500:, marker] += size_mm * direction / np.linalg.norm(direction)
    (slip,) = [s for s in find_slips(capture(positions), known[0], range(6)) if s.marker == marker]
    assert abs(slip.frame - 500) <= 3
    assert slip.size_mm == pytest.approx(size_mm, rel=0.25)
    marked = with_slips_marked(capture(positions), [slip])
    doubtful = (marked.flags & DOUBTFUL) > 0
    assert doubtful[slip.frame :, marker].all()
    assert doubtful.sum() == 900 - slip.frame


def test_a_jig_that_slipped_is_told_apart_from_a_marker(known):
    positions = face(5)
    positions[400:, 6:] += [0.9, -1.0, 0.6]  # head-stabilised: the face goes, the jig stays
    first, *rest = find_slips(capture(positions), known[0], range(6))
    assert (first.marker, rest) == (-1, [])
    assert abs(first.frame - 400) <= 3
    assert not (with_slips_marked(capture(positions), [first]).flags & DOUBTFUL).any()


def test_what_is_taken_out_is_filled_and_stays_an_outlier(known):
    truth = face(7)
    seen, where = spiked(truth, np.random.default_rng(7), n=12)
    out = without_outliers(capture(seen), find_outliers(capture(seen), *known))
    taken = np.isnan(out.positions_mm).all(axis=2)
    assert ((out.flags == OUTLIER) == taken).all()
    filled, _ = fill_gaps(out, model=known[0])
    assert (filled.flags[taken] & (OUTLIER | FILLED) == OUTLIER | FILLED).all()
    assert np.linalg.norm((filled.positions_mm - truth)[where & taken], axis=1).max() < 0.6
    again = find_outliers(capture(truth), *known)
    assert not again.doubted.any()
    np.testing.assert_array_equal(without_outliers(capture(truth), again).positions_mm, truth)


def test_cleaning_takes_them_out_keeps_the_flag_and_can_be_told_not_to():
    whole = [capture(face(seed)) for seed in range(3)]
    seen, where = spiked(face(3), np.random.default_rng(3), n=10)
    captures = [*whole, capture(seen)]
    cleaned, left = (
        clean_captures(captures, range(6), allow_scale=False, outliers=looked) for looked in (True, False)
    )
    flags = cleaned.captures[3].flags
    assert ((flags & OUTLIER) > 0)[where].mean() >= 0.9
    assert not (cleaned.captures[0].flags & OUTLIER).any()
    assert cleaned.outliers[3].spiked.sum() >= 0.9 * where.sum()
    assert left.outliers == (None,) * 4
    assert not any((c.flags & OUTLIER).any() for c in left.captures)
    truth = clean_captures([*whole, capture(face(3))], range(6), allow_scale=False, outliers=False)
    errors = [
        np.linalg.norm(c.captures[3].positions_mm - truth.captures[3].positions_mm, axis=2)[where].max()
        for c in (cleaned, left)
    ]
    assert errors[0] < 0.5 * errors[1]


def test_too_little_of_a_face_is_left_alone():
    short = capture(face(0)[:100])
    few = Capture(face(0)[:, :8], RATE_HZ, NAMES[:8])
    for one in (short, few):
        assert clean_captures([one], range(4), allow_scale=False).outliers == (None,)


def test_gaps_are_not_outliers(known):
    positions = face(9)
    positions[100:140, 12] = np.nan
    positions[:20] = np.nan
    positions[300, 20] += 4.0
    found = find_outliers(capture(positions), *known)
    assert np.argwhere(found.doubted).tolist() == [[300, 20]]
