import dataclasses

import numpy as np
import pytest
from hypothesis import given

from corpus_tools.core import Capture, FrameFlag
from corpus_tools.synthesis import (
    NaturalDistribution,
    align_fragments,
    blend_pieces,
    narrowed,
    natural_distribution,
    ranked_joins,
    rms_acceleration,
)
from tests.strategies.fragments import NAMES, make_fragment, make_selection, make_target, seeds, spliced

RATE_HZ = 120.0


def test_the_acceleration_of_a_parabola_is_its_own():
    times = np.arange(30) / RATE_HZ
    values = np.zeros((30, 4, 3))
    values[:, 0, 1] = 0.5 * 600 * times**2
    np.testing.assert_allclose(rms_acceleration(values, RATE_HZ), 600 / np.sqrt(4), rtol=1e-6)
    np.testing.assert_array_equal(rms_acceleration(values[:2], RATE_HZ), [0, 0])


def parabola(position, velocity, acceleration, centre_s):
    """Return motion of one parabola in x for all markers, given at `centre_s`."""

    def motion(times):
        t = np.asarray(times) - centre_s
        x = position + velocity * t + 0.5 * acceleration * t**2
        return np.broadcast_to(x[:, None, None], (len(t), len(NAMES), 3)) * np.array([1.0, 0, 0])

    return motion


def joined(left, right):
    """Return a target of one join at 0.3 s between two fragments whose shared phone is at 1 s of theirs."""
    first = make_fragment(["A", "B"], [0.2, 0.2], left, start_s=0.7, rate_hz=RATE_HZ)
    second = make_fragment(["B", "C"], [0.2, 0.2], right, start_s=0.9, rate_hz=RATE_HZ)
    target = make_target(["A", "B", "C"], [0.2, 0.2, 0.2])
    return make_selection([first, second]), target, [first, second]


def test_the_gaps_are_those_of_the_two_fragments_at_the_join():
    parts = joined(parabola(3.0, 40.0, 900.0, 1.0), parabola(1.0, -20.0, 400.0, 1.0))
    trajectory = blend_pieces(align_fragments(*parts, names=NAMES))
    (join,) = trajectory.joins
    assert (join.index, join.phone, join.left_source, join.right_source) == (0, "B", "a:1-2", "a:1-2")
    assert join.time_s == pytest.approx(0.3)
    assert join.overlap_s == pytest.approx(0.12)
    assert join.gap_mm == pytest.approx(2, rel=1e-3)
    assert join.gap_mm_s == pytest.approx(60, rel=1e-2)
    assert join.gap_mm_s2 == pytest.approx(500, rel=3e-2)
    assert np.isnan(join.natural_percentile)


@pytest.mark.parametrize("flag", [FrameFlag.OUTLIER | FrameFlag.FILLED, FrameFlag.DOUBTFUL, FrameFlag.FILLED])
def test_a_join_says_how_much_of_it_was_flagged(flag):
    selection, target, fragments = joined(parabola(0, 0, 0, 1.0), parabola(0, 0, 0, 1.0))
    flags = np.array(fragments[1].flags)
    flags[:, 0] = flag  # one marker of the right fragment, throughout
    worse = [fragments[0], dataclasses.replace(fragments[1], flags=flags)]
    shares = [
        blend_pieces(align_fragments(selection, target, f, names=NAMES)).joins[0].flagged
        for f in (fragments, worse)
    ]
    assert shares == [0.0, pytest.approx(0.5 / len(NAMES))]


@given(seeds)
def test_the_gaps_do_not_depend_on_the_blend(seed):
    aligned = align_fragments(*spliced(np.random.default_rng(seed)), names=NAMES)
    one = blend_pieces(aligned)
    two = blend_pieces(aligned, weighting="linear", rule="paper", shape=0.5)
    gaps = [
        [(j.gap_mm, j.gap_mm_s, j.gap_mm_s2, j.time_s, j.phone) for j in trajectory.joins]
        for trajectory in (one, two)
    ]
    assert gaps[0] == gaps[1]
    assert len(gaps[0]) == 2
    assert min(g[0] for g in gaps[0]) > 0


def sine(size_mm, hz, seconds=4.0, rate_hz=100.0):
    times = np.arange(round(seconds * rate_hz)) / rate_hz
    values = np.zeros((len(times), 2, 3))
    values[:, 0, 1] = size_mm * np.sin(2 * np.pi * hz * times)
    return Capture(values, rate_hz, ("chin0", "brow0"))


def test_the_natural_distribution_of_a_sine_is_its_peak():
    natural = natural_distribution([sine(2.0, 5.0)], RATE_HZ, columns=[0], spans_s=[(0.5, 3.5)])
    peak = 2.0 * (2 * np.pi * 5) ** 2
    # a window of 0.12 s is longer than half a period: each holds a peak
    np.testing.assert_allclose(natural.peaks_mm_s2, peak, rtol=0.02)
    assert len(natural.peaks_mm_s2) == 25
    assert natural.frames_p95_mm_s2 == pytest.approx(peak * np.sin(0.95 * np.pi / 2), rel=0.02)
    assert natural.percentile(0.9 * peak) == 0
    assert natural.percentile(1.1 * peak) == 100
    every = natural_distribution([sine(2.0, 5.0)], RATE_HZ)
    assert np.median(every.peaks_mm_s2) == pytest.approx(peak / np.sqrt(2), rel=0.02)


def test_loud_and_quiet_recordings_are_ranked():
    natural = natural_distribution([sine(1.0, 5.0), sine(3.0, 5.0)], RATE_HZ, [0], [(0.5, 3.5), (0.5, 3.5)])
    between = 2.0 * (2 * np.pi * 5) ** 2
    assert natural.percentile(between) == 50
    assert (np.diff(natural.peaks_mm_s2) >= 0).all()


def test_short_recordings_count_for_nothing_and_without_any_the_place_is_unknown():
    natural = natural_distribution([sine(1.0, 5.0, seconds=0.1)], RATE_HZ)
    assert len(natural.peaks_mm_s2) == 0
    assert np.isnan(natural.percentile(10.0))
    assert np.isnan(natural.frames_p95_mm_s2)


def test_a_join_is_placed_by_its_peak_among_natural_ones():
    still = parabola(0.0, 0.0, 0.0, 1.0)
    smooth = blend_pieces(align_fragments(*joined(still, still), names=NAMES))
    rough = blend_pieces(align_fragments(*joined(still, parabola(6.0, 0, 0, 1.0)), names=NAMES))
    peak = rms_acceleration(np.asarray(rough.values_mm), RATE_HZ).max()
    ladder = np.linspace(0.01, 2.0, 200) * peak
    natural = NaturalDistribution(ladder, float(ladder[189]), np.arange(len(NAMES)), RATE_HZ)
    assert [j.natural_percentile for j in ranked_joins(smooth, natural)] == [0.0]
    assert [j.natural_percentile for j in ranked_joins(rough, natural)] == [pytest.approx(50, abs=1)]
    placed = blend_pieces(
        align_fragments(*joined(still, parabola(6.0, 0, 0, 1.0)), names=NAMES), natural=natural
    )
    assert placed.joins[0].natural_percentile == pytest.approx(50, abs=1)
    assert placed.joins[0].peak_ratio == pytest.approx(peak / np.percentile(ladder, 95))
    for nothing in (np.zeros(5), np.zeros(0)):
        unknown = ranked_joins(rough, dataclasses.replace(natural, peaks_mm_s2=nothing))
        assert np.isnan(unknown[0].peak_ratio)
    few, of_few = narrowed(align_fragments(*joined(still, parabola(6.0, 0, 0, 1.0)), names=NAMES), natural)
    assert blend_pieces(few, natural=of_few).peak_ratios == placed.peak_ratios
    unmoved = dataclasses.replace(natural, columns=np.array([1]))
    assert [j.natural_percentile for j in ranked_joins(rough, unmoved)] == [pytest.approx(50, abs=1)]


def test_the_peak_of_a_blended_step_is_the_curvature_of_g():
    """Offset d over an overlap of length L: d * max g'' / L^2 (5.77 for the quintic)."""
    step = parabola(6.0, 0, 0, 1.0)
    still = parabola(0.0, 0, 0, 1.0)
    aligned = align_fragments(*joined(still, step), names=NAMES, rate_hz=2000.0)
    rough = blend_pieces(aligned)
    peak = rms_acceleration(np.asarray(rough.values_mm), 2000.0).max()
    assert peak == pytest.approx(6 * 5.77 / 0.12**2, rel=0.01)
