"""How fragments lie on the clock of a target: both warps and both ways of resampling, side by side."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, get_args

import numpy as np

from corpus_tools.core import FloatArray, Fragment, Selection, Utterance
from corpus_tools.synthesis.alignment import TimeWarp, WarpKind, fragment_warp
from corpus_tools.synthesis.blending import blend_pieces
from corpus_tools.synthesis.joins import NaturalDistribution
from corpus_tools.synthesis.pieces import AlignedPieces, Resampling, align_fragments

__all__ = ["AlignmentFacts", "PhoneStretch", "WayFacts", "alignment_facts"]

STEP_S = 1e-4
"""On either side of a label, where the pace of a clock is read (our choice: far below a frame)."""


@dataclass(frozen=True, slots=True)
class WayFacts:
    """One way to align: a warp and a way of resampling.

    Attributes
    ----------
    warp : {"linear", "pchip"}
    resampling : {"inverse", "paper"}
    cond : float
        Largest condition number.
    rms_mm, largest_mm : float, mm
        By how much the fragments differ from those of the first way: rms over samples and markers, and the
        largest distance of a marker.
    jump_mm_s : float, mm/s
        95th percentile of the jumps of velocity that the warp makes at labels: the change of its pace times
        the speed there, rms over markers.
    peak_ratio : float
        Largest peak acceleration at a join, blended by the default g(u), over the natural 95th percentile.
    """

    warp: WarpKind
    resampling: Resampling
    cond: float
    rms_mm: float
    largest_mm: float
    jump_mm_s: float
    peak_ratio: float


@dataclass(frozen=True, slots=True)
class PhoneStretch:
    """How much longer a phone is in the target than in the fragment that speaks it.

    Attributes
    ----------
    phone : str
    time_s : float, s
        Its centre in the target.
    source : str
        ``recording:first-last``.
    factor : float
        Target duration over source duration.
    """

    phone: str
    time_s: float
    source: str
    factor: float


@dataclass(frozen=True, slots=True)
class AlignmentFacts:
    """What alignment did to the fragments of an utterance.

    Attributes
    ----------
    ways : tuple of WayFacts
        The default first.
    stretches : tuple of PhoneStretch
        Of every phone that is not silence, the most changed first.
    merged : int
        Labels that coincide with a neighbour on either clock and bend the warp no more.
    outside : int
        Samples read outside what was captured: its end is held there, and they are flagged doubtful.
    samples : int
        Of all fragments together.
    """

    ways: tuple[WayFacts, ...]
    stretches: tuple[PhoneStretch, ...]
    merged: int
    outside: int
    samples: int

    def as_dict(self) -> dict[str, Any]:
        """Return plain numbers, lists and dicts for JSON."""
        keys = ("warp", "resampling", "cond", "rms_mm", "largest_mm", "jump_mm_s", "peak_ratio")
        return {
            "ways": [{k: _plain(getattr(way, k)) for k in keys} for way in self.ways],
            "stretches": [
                {"phone": s.phone, "time_s": s.time_s, "source": s.source, "factor": s.factor}
                for s in self.stretches
            ],
            "merged_labels": self.merged,
            "samples_outside": self.outside,
            "samples": self.samples,
        }


def _plain(value: float | str) -> float | str | None:
    return None if isinstance(value, float) and not np.isfinite(value) else value


def _stretches(
    selection: Selection, utterance: Utterance, fragments: Sequence[Fragment], silence: str
) -> Iterator[PhoneStretch]:
    for chosen, fragment in zip(selection.chosen, fragments, strict=True):
        target = utterance.phones.intervals[chosen.first : chosen.last + 1]
        for phone, source_s in zip(target, np.diff(fragment.edges_s), strict=True):
            if phone.text != silence:
                factor = phone.duration_s / max(float(source_s), 1e-9)
                yield PhoneStretch(phone.text, phone.centre_s, chosen.unit.key, factor)


def _speed(fragment: Fragment, times_s: FloatArray) -> FloatArray:
    """Return the speed of the captured motion, rms over markers, at source times, mm/s."""
    velocity = np.gradient(fragment.motion_mm, fragment.times_s, axis=0)
    speed = np.sqrt((velocity**2).sum(axis=2).mean(axis=1))
    return np.asarray(np.interp(times_s, fragment.times_s, speed))


def _jumps(fragment: Fragment, warp: TimeWarp) -> FloatArray:
    """Return the jump of velocity at every label inside a fragment, mm/s."""
    knots = warp.target_s[1:-1]
    here = warp.to_source(knots)
    after = (warp.to_source(knots + STEP_S) - here) / STEP_S
    before = (here - warp.to_source(knots - STEP_S)) / STEP_S
    return np.asarray(np.abs(after - before) * _speed(fragment, here))


def _differences(pieces: AlignedPieces, others: AlignedPieces) -> tuple[float, float]:
    """Return rms over samples and markers, and the largest distance, mm."""
    distances = [
        np.linalg.norm(a.motion_mm - b.motion_mm, axis=2).ravel()
        for a, b in zip(pieces.pieces, others.pieces, strict=True)
    ]
    every = np.concatenate(distances)
    return float(np.sqrt((every**2).mean())), float(every.max())


def alignment_facts(
    selection: Selection,
    utterance: Utterance,
    fragments: Sequence[Fragment],
    *,
    names: Sequence[str],
    natural: NaturalDistribution | None = None,
    silence: str = "SIL",
    **settings: Any,
) -> AlignmentFacts:
    """Align the chosen fragments in every way and compare (paper A section 5.1.2).

    Parameters
    ----------
    selection, utterance, fragments, names, silence
        As of :func:`~corpus_tools.synthesis.pieces.align_fragments`.
    natural : NaturalDistribution, optional
        For the peak accelerations at joins.
    **settings
        `rate_hz` and `c`.

    Raises
    ------
    SynthesisError
        A resampling is ill-conditioned.
    """
    spoken = [utterance.phones.intervals[c.first : c.last + 1] for c in selection.chosen]
    pairs = list(zip(fragments, spoken, strict=True))
    ways, first = [], None
    for resampling, warp in itertools.product(get_args(Resampling), get_args(WarpKind)):
        shared: dict[str, Any] = {"names": names, "silence": silence, **settings}
        pieces = align_fragments(selection, utterance, fragments, warp=warp, resampling=resampling, **shared)
        first = first or pieces
        jumps = np.concatenate([_jumps(f, fragment_warp(f, p, warp, silence)) for f, p in pairs])
        rms, largest = _differences(pieces, first)
        peaks = blend_pieces(pieces, natural=natural).peak_ratios
        ways.append(
            WayFacts(
                warp=warp,
                resampling=resampling,
                cond=max(piece.cond for piece in pieces.pieces),
                rms_mm=rms,
                largest_mm=largest,
                jump_mm_s=float(np.percentile(jumps, 95)) if len(jumps) else 0.0,
                peak_ratio=float(max(peaks)) if len(peaks) else float("nan"),
            )
        )
    assert first is not None
    stretches = sorted(
        _stretches(selection, utterance, fragments, silence), key=lambda s: -abs(float(np.log(s.factor)))
    )
    return AlignmentFacts(
        ways=tuple(ways),
        stretches=tuple(stretches),
        merged=sum(fragment_warp(f, p, "linear", silence).merged for f, p in pairs),
        outside=sum(piece.outside for piece in first.pieces),
        samples=sum(len(piece.motion_mm) for piece in first.pieces),
    )
