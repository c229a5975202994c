"""Simulated fragments with a target to speak: smooth motion whose truth is known at every time."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from hypothesis import strategies as st

from corpus_tools.core import (
    ChosenUnit,
    Costs,
    Fragment,
    FrameFlag,
    Interval,
    Selection,
    Tier,
    UnitRef,
    Utterance,
)

SILENCE = "SIL"
NAMES = ("brow0", "lip_in1", "lip_in7", "chin3")
Motion = Callable[[np.ndarray], np.ndarray]


def band_limited(rng: np.random.Generator, low_hz=0.5, high_hz=8.0, n_markers=4, size=1.0) -> Motion:
    """Return simulated motion of rms `size` per coordinate: a sum of sines, (n_times, n_markers, 3)."""
    hz = rng.uniform(low_hz, high_hz, (12, n_markers, 3))
    phase = rng.uniform(0, 2 * np.pi, hz.shape)
    return lambda t: (
        size * np.sqrt(2 / 12) * np.sin(2 * np.pi * hz * np.asarray(t)[:, None, None, None] + phase).sum(1)
    )


def own_clock(times: np.ndarray) -> np.ndarray:
    """Motion that tells the time: every coordinate is the source time in s."""
    return np.broadcast_to(np.asarray(times)[:, None, None], (len(times), len(NAMES), 3)).copy()


def make_fragment(
    phones: Sequence[str],
    durations_s: Sequence[float],
    motion: Motion,
    *,
    first: int = 1,
    start_s: float = 0.7,
    context_s: float = 0.4,
    rate_hz: float = 25.0,
    recording: str = "a",
) -> Fragment:
    """Return a fragment with captured motion `context_s` beyond its first and last centre."""
    edges = start_s + np.concatenate([[0.0], np.cumsum(durations_s)])
    low, high = edges[:2].mean() - context_s, edges[-2:].mean() + context_s
    times = np.arange(np.ceil(low * rate_hz), np.floor(high * rate_hz) + 1) / rate_hz
    values = motion(times)
    flags = np.full(values.shape[:2], FrameFlag.MEASURED, np.uint8)
    unit = UnitRef(recording, first, first + len(phones) - 1)
    return Fragment(unit, tuple(phones), edges, times, values, flags)


def make_target(phones: Sequence[str], durations_s: Sequence[float]) -> Utterance:
    """Return an utterance of the phones from 0 s on."""
    edges = np.concatenate([[0.0], np.cumsum(durations_s)])
    spans = zip(edges[:-1].tolist(), edges[1:].tolist(), phones, strict=True)
    return Utterance("target", "", Tier("phones", tuple(Interval(a, b, p) for a, b, p in spans)))


def make_selection(fragments: Sequence[Fragment]) -> Selection:
    """Return the selection in which the fragments speak one after the other, sharing phones."""
    chosen, at = [], 0
    for fragment in fragments:
        last = at + len(fragment.phones) - 1
        chosen.append(ChosenUnit(at, last, fragment.unit, Costs()))
        at = last
    return Selection("target", "test", tuple(chosen))


def spliced(
    rng: np.random.Generator,
    n_units: int = 3,
    motion: Callable[[int], Motion] | None = None,
    rate_hz: float = 25.0,
) -> tuple[Selection, Utterance, list[Fragment]]:
    """Return a target of `n_units` units of 2 to 5 phones, each from a recording with its own timing.

    The first and last phone are silence; `motion(k)` gives the motion of unit k.
    """
    counts = rng.integers(2, 6, n_units)
    n_phones = int(counts.sum()) - n_units + 1
    phones = [SILENCE, *(f"P{i}" for i in range(1, n_phones - 1)), SILENCE]
    target = make_target(phones, rng.uniform(0.04, 0.25, n_phones))
    fragments, at = [], 0
    for k, count in enumerate(counts):
        own = motion(k) if motion else band_limited(rng)
        labels = phones[at : at + count]
        fragments.append(
            make_fragment(labels, rng.uniform(0.04, 0.25, count), own, recording=f"r{k}", rate_hz=rate_hz)
        )
        at += int(count) - 1
    return make_selection(fragments), target, fragments


seeds = st.integers(0, 100_000)
