"""Paper A section 5.1.2, "Alignment and Resampling of Speech Fragments"."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.synthesis import (
    TimeWarp,
    align_fragments,
    blend_pieces,
    fit_time_rbf,
    fit_uniform_rbf,
    fragment_warp,
)
from tests.strategies.fragments import (
    NAMES,
    SILENCE,
    band_limited,
    make_fragment,
    make_selection,
    make_target,
    own_clock,
    seeds,
    spliced,
)

RATE_HZ = 120.0  # that of the paper's capture


@pytest.mark.parametrize("kind", ["linear", "pchip"])
@given(seeds)
def test_the_labels_are_correctly_aligned_with_the_target(kind, seed):
    """A fragment whose markers tell the source time shows that time of its labels at the target's labels."""
    rng = np.random.default_rng(seed)
    phones = [SILENCE, *(f"P{i}" for i in range(6)), SILENCE]
    fragment = make_fragment(phones, rng.uniform(0.03, 0.3, 8), own_clock, context_s=1.0)
    target = make_target(phones, rng.uniform(0.03, 0.3, 8))
    selection = make_selection([fragment])
    trajectory = blend_pieces(
        align_fragments(selection, target, [fragment], names=NAMES, rate_hz=2000.0, warp=kind)
    )
    told = trajectory.values_mm[:, 0, 0]
    edges = np.array([p.end_s for p in target.phones][:-1])
    speech = (edges > 0.1) & (edges < target.duration_s - 0.1)  # the very ends come to rest
    shown = np.interp(edges, trajectory.times_s, told)
    np.testing.assert_allclose(shown[speech], fragment.edges_s[1:-1][speech], atol=2e-3)
    assert speech.any()


@given(seeds)
def test_evenly_distributed_samples_between_repositioned_labels(seed):
    """ "evenly distributing motion samples between repositioned phonetic labels": the linear warp."""
    rng = np.random.default_rng(seed)
    fragment = make_fragment(["A", "B", "C"], rng.uniform(0.1, 0.3, 3), own_clock)
    target = make_target(["A", "B", "C"], rng.uniform(0.03, 0.3, 3))
    moved = fragment_warp(fragment, target.phones.intervals).to_target(fragment.times_s)
    for k, phone in enumerate(target.phones):
        low, high = fragment.edges_s[k : k + 2]
        inside = (fragment.times_s > low) & (fragment.times_s < high)
        expected = phone.start_s + (fragment.times_s[inside] - low) / (high - low) * phone.duration_s
        np.testing.assert_allclose(moved[inside], expected, atol=1e-12)


@pytest.mark.parametrize("mode", ["inverse", "paper"])
@given(seeds, st.sampled_from([25.0, 60.0, 120.0]))
def test_the_frame_rate_is_consistent(mode, seed, rate_hz):
    """ "resampled to achieve a consistent frame-rate", from the start of the target to its end."""
    selection, target, fragments = spliced(np.random.default_rng(seed))
    trajectory = blend_pieces(
        align_fragments(selection, target, fragments, names=NAMES, rate_hz=rate_hz, resampling=mode)
    )
    assert trajectory.times_s[0] == 0
    assert 0 <= target.duration_s - trajectory.times_s[-1] < 1 / rate_hz + 1e-9
    np.testing.assert_allclose(np.diff(trajectory.times_s), 1 / rate_hz, atol=1e-12)
    assert np.isfinite(trajectory.values_mm).all()


def stretched(rng, n, low, high, n_pieces=8):
    """Return a warp of n samples in pieces of slope `low` to `high`, as labels give it."""
    source = np.linspace(0, (n - 1) / RATE_HZ, n_pieces + 1)
    slopes = np.exp(rng.uniform(np.log(low), np.log(high), n_pieces))
    return TimeWarp(source, np.concatenate([[0.0], np.cumsum(slopes * np.diff(source))]))


@pytest.mark.parametrize(("n", "low", "high"), [(40, 0.5, 2), (200, 0.5, 2), (100, 0.2, 5)])
def test_reading_the_source_clock_is_far_more_accurate_than_moving_the_samples(n, low, high):
    """Both meet every sample; between them the truth is f(warp^-1(t)). Our measurement, beyond the paper."""
    inverse, paper, size = [], [], []
    for seed in range(8):
        rng = np.random.default_rng([seed, n])
        warp = stretched(rng, n, low, high)
        motion = band_limited(rng, low_hz=0.5, high_hz=8.0 if seed else 2.0)
        captured = np.arange(n) / RATE_HZ
        values = motion(captured)
        times = np.arange(0.0, warp.target_s[-1], 1 / 480)
        asked = warp.to_source(times)
        inner = (asked >= 0) & (asked <= captured[-1])
        truth = motion(asked)[inner]
        inverse.append((fit_uniform_rbf(0.0, RATE_HZ, values)(asked)[inner] - truth).ravel())
        paper.append((fit_time_rbf(warp.to_target(captured), values)(times)[inner] - truth).ravel())
        size.append(truth.ravel())
    error, printed, signal = (np.sqrt(np.mean(np.concatenate(e) ** 2)) for e in (inverse, paper, size))
    print(n, low, high, error / signal, printed / error)
    assert error <= 2e-4 * signal
    assert printed >= 20 * error
