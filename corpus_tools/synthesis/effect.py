"""What a weighting function and an overlap do to the joins: every curve at every overlap, measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from corpus_tools.core import FloatArray, Trajectory, frozen
from corpus_tools.synthesis.blending import blend_pieces
from corpus_tools.synthesis.joins import WINDOW_S, NaturalDistribution, rms_acceleration
from corpus_tools.synthesis.pieces import AlignedPieces

__all__ = ["EffectCurve", "effect_curves", "narrowed", "peak_ratios"]


@dataclass(frozen=True, slots=True, eq=False)
class EffectCurve:
    """One weighting function at every overlap.

    Attributes
    ----------
    weighting : str
    overlaps_s : (n_overlaps,) s
        Longest overlap that was asked for.
    ratios : (n_overlaps, n_joins)
        Peak acceleration of each join over the natural 95th percentile.
    """

    weighting: str
    overlaps_s: FloatArray
    ratios: FloatArray

    def __post_init__(self) -> None:
        for key in ("overlaps_s", "ratios"):
            object.__setattr__(self, key, frozen(getattr(self, key)))


def narrowed(aligned: AlignedPieces, natural: NaturalDistribution) -> AlignedPieces:
    """Return the pieces with only the markers that joins are judged by: blending them costs half as much."""
    columns = natural.columns
    pieces = tuple(
        replace(p, motion_mm=p.motion_mm[:, columns], flags=p.flags[:, columns]) for p in aligned.pieces
    )
    return replace(aligned, pieces=pieces, names=tuple(aligned.names[c] for c in columns))


def peak_ratios(trajectory: Trajectory, natural: NaturalDistribution) -> FloatArray:
    """Return the peak acceleration around each join over the natural 95th percentile, (n_joins,).

    Parameters
    ----------
    trajectory : Trajectory
        Of the markers of `natural` only (see :func:`narrowed`); before any closing of the lips.
    natural : NaturalDistribution

    Returns
    -------
    (n_joins,) float64
        Above 1: higher than 95 % of the peaks of recorded speech. NaN without a natural distribution.
    """
    if not len(natural.peaks_mm_s2):
        return np.full(len(trajectory.joins), np.nan)
    p95 = natural.p95_mm_s2
    acceleration = rms_acceleration(np.asarray(trajectory.values_mm), trajectory.rate_hz)
    near = (np.abs(trajectory.times_s - join.time_s) <= 0.5 * WINDOW_S for join in trajectory.joins)
    return np.array([acceleration[window].max() / p95 for window in near])


def effect_curves(
    pieces: AlignedPieces,
    natural: NaturalDistribution,
    weightings: Mapping[str, Mapping[str, Any]],
    overlaps_s: Sequence[float],
    **settings: Any,
) -> tuple[EffectCurve, ...]:
    """Blend with every weighting function at every overlap, and measure the joins.

    Parameters
    ----------
    pieces : AlignedPieces
        Of the markers of `natural` only (see :func:`narrowed`).
    natural : NaturalDistribution
    weightings : mapping of name -> settings of its own (shape, weights)
    overlaps_s : sequence of float, s
    **settings
        Further settings of :func:`~corpus_tools.synthesis.blending.blend_pieces`.
    """
    found = []
    for name, own in weightings.items():
        rows = [
            peak_ratios(blend_pieces(pieces, weighting=name, overlap_s=o, **{**settings, **own}), natural)
            for o in overlaps_s
        ]
        found.append(EffectCurve(name, np.asarray(overlaps_s), np.array(rows)))
    return tuple(found)
