"""What a weighting function and an overlap do to the joins: every curve at every overlap, measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from corpus_tools.core import FloatArray, frozen
from corpus_tools.synthesis.blending import blend_pieces
from corpus_tools.synthesis.joins import NaturalDistribution
from corpus_tools.synthesis.pieces import AlignedPieces

__all__ = ["EffectCurve", "effect_curves", "narrowed"]


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


def narrowed(
    aligned: AlignedPieces, natural: NaturalDistribution
) -> tuple[AlignedPieces, NaturalDistribution]:
    """Return both with only the markers that joins are judged by: blending them costs half as much."""
    columns = natural.columns
    pieces = tuple(
        replace(p, motion_mm=p.motion_mm[:, columns], flags=p.flags[:, columns]) for p in aligned.pieces
    )
    names = tuple(aligned.names[c] for c in columns)
    return replace(aligned, pieces=pieces, names=names), replace(natural, columns=np.arange(len(columns)))


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
        Of the same markers.
    weightings : mapping of name -> settings of its own (shape, weights)
    overlaps_s : sequence of float, s
    **settings
        Further settings of :func:`~corpus_tools.synthesis.blending.blend_pieces`.
    """
    found = []
    for name, own in weightings.items():
        given = {**settings, **own, "natural": natural}
        rows = [blend_pieces(pieces, weighting=name, overlap_s=o, **given).peak_ratios for o in overlaps_s]
        found.append(EffectCurve(name, np.asarray(overlaps_s), np.array(rows)))
    return tuple(found)
