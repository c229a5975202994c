"""Blending of aligned fragments into one trajectory (paper A section 5.1.3, eq. (2))."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from corpus_tools.core import FloatArray, Fragment, InputError, Selection, Trajectory, Utterance, step
from corpus_tools.synthesis.alignment import WarpKind
from corpus_tools.synthesis.inertial import join_inertially
from corpus_tools.synthesis.joins import NaturalDistribution, join_gaps, ranked_joins
from corpus_tools.synthesis.overlap import OverlapRule, overlap_lengths
from corpus_tools.synthesis.pieces import MARGIN_S, AlignedPieces, Resampling, align_fragments
from corpus_tools.synthesis.usercurve import DEFAULT_CURVE
from corpus_tools.synthesis.weighting import Weighting
from corpus_tools.synthesis.weighting_at import weightings_of_joins

__all__ = ["BlendMode", "blend_pieces", "blend_weights", "render_selection"]

BlendMode = Literal["crossfade", "inertial"]


def blend_weights(
    times_s: FloatArray, joins_s: FloatArray, overlaps_s: FloatArray, g: Weighting | Sequence[Weighting]
) -> FloatArray:
    """Return the weight of every piece in every frame, (n_pieces, n_frames); columns sum to 1.

    Eq. (2) of paper A with u = (t - t0) / (t1 - t0) over each overlap; an overlap of length 0 is a cut at the
    join.

    Parameters
    ----------
    times_s : (n_frames,) s
    joins_s, overlaps_s : (n_joins,) s
        Centres and lengths of the overlaps; increasing, not meeting.
    g : callable, or n_joins of them
        Weighting function, of all joins or of each.
    """
    each = [g] * len(joins_s) if callable(g) else g
    fading = np.ones((len(joins_s) + 2, len(times_s)))
    fading[-1] = 0.0
    for k, (centre, length) in enumerate(zip(joins_s, overlaps_s, strict=True)):
        if length > 0:
            fading[k + 1] = 1.0 - each[k]((times_s - (centre - 0.5 * length)) / length)
        else:
            fading[k + 1] = (times_s >= centre).astype(np.float64)
    return fading[:-1] - fading[1:]


def _cross_fade(
    aligned: AlignedPieces, overlaps_s: FloatArray, g: Sequence[Weighting]
) -> tuple[FloatArray, npt.NDArray[np.uint8]]:
    """Return the blended motion (n_frames, n_markers, 3) and the flags of all that has a say in it."""
    weights = blend_weights(aligned.times_s, aligned.join_times_s, overlaps_s, g)
    n_frames, n_markers = len(aligned.times_s), len(aligned.names)
    values = np.zeros((n_frames, n_markers, 3))
    flags = np.zeros((n_frames, n_markers), np.uint8)
    for piece, weight in zip(aligned.pieces, weights, strict=True):
        span = slice(piece.start, piece.stop)
        share = weight[span]
        values[span] += share[:, None, None] * piece.motion_mm
        flags[span] |= np.where(share[:, None] > 0, piece.flags, 0).astype(np.uint8)
    return values, flags


def blend_pieces(
    aligned: AlignedPieces,
    *,
    mode: BlendMode = "crossfade",
    weighting: str = "smootherstep",
    shape: float = 0.0,
    curve_weights: Sequence[float] = DEFAULT_CURVE,
    weighting_at: Sequence[str] = (),
    classes: Mapping[str, str] | None = None,
    rule: OverlapRule = "shared-phone",
    overlap_s: float = 0.12,
    fraction: float = 0.5,
    inertial_s: float = 0.12,
    natural: NaturalDistribution | None = None,
) -> Trajectory:
    """Blend aligned pieces at their joins.

    Parameters
    ----------
    aligned : AlignedPieces
    mode : {"crossfade", "inertial"}
        "crossfade": eq. (2) of paper A, for which everything below but `inertial_s` is. "inertial": as of
        :func:`~corpus_tools.synthesis.inertial.join_inertially`, beyond the paper.
    weighting : str
        g(u) by name.
    shape : float
        Its crossover, -1 to 1.
    curve_weights : sequence of float
        Of the slope of g(u) when it is the user's own ("user").
    weighting_at : sequence of str
        Joins, phones or classes of phones with a g(u) of their own
        (:func:`~corpus_tools.synthesis.weighting_at.weightings_of_joins`).
    classes : mapping of phone -> class, optional
        For `weighting_at`.
    rule, overlap_s, fraction
        As of :func:`~corpus_tools.synthesis.overlap.overlap_lengths`; an overlap is never longer than the
        motion that aligned pieces keep around their joins (2 :data:`MARGIN_S`).
    inertial_s : float
        How long the offset of an inertial join takes to die away on either side, s.
    natural : NaturalDistribution, optional
        Places the peak acceleration of each join among natural ones.

    Returns
    -------
    Trajectory
        With one :class:`~corpus_tools.core.Join` per join. An inertial one says in its history how far it
        lies from the captured motion at most (deviation_mm, rms over markers).

    Raises
    ------
    InputError
        There is no such mode or g(u), a setting is out of range, or an exception names no join.
    """
    settings: dict[str, Any] = {"mode": mode}
    if mode == "crossfade":
        settings |= {"weighting": weighting, "shape": shape, "rule": rule, "overlap_s": overlap_s}
        settings |= {"fraction": fraction}
        if weighting == "user":
            settings["curve_weights"] = ",".join(f"{w:g}" for w in curve_weights)
        longest = min(overlap_s, 2.0 * MARGIN_S)
        phones = aligned.utterance.phones.intervals
        shared = [phones[j].text for j in aligned.join_phones]
        own = weightings_of_joins(shared, (weighting, shape), weighting_at, classes, curve_weights)
        if weighting_at:
            settings["weighting_at"] = ",".join(weighting_at)
        overlaps = overlap_lengths(phones, aligned.join_phones, rule, longest, fraction)
        values, flags = _cross_fade(aligned, overlaps, [g for _, g in own])
    elif mode == "inertial":
        moved = join_inertially(aligned, inertial_s)
        values, flags, overlaps = moved.values_mm, moved.flags, moved.reach_s
        settings |= {"inertial_s": inertial_s, "deviation_mm": round(float(moved.deviation_mm.max()), 4)}
    else:
        raise InputError(f"There is no blend mode '{mode}'. Known: crossfade, inertial.")
    history = (step("align", **dict(aligned.settings)), step("blend", **settings))
    joins = join_gaps(aligned, overlaps)
    result = Trajectory(aligned.times_s, values, aligned.names, joins, flags, history)
    if natural is None or not joins:
        return result
    return replace(result, joins=ranked_joins(result, natural))


def render_selection(
    selection: Selection,
    utterance: Utterance,
    fragments: Sequence[Fragment],
    *,
    names: Sequence[str],
    rate_hz: float = 120.0,
    warp: WarpKind = "linear",
    resampling: Resampling = "inverse",
    c: float = 0.2,
    silence: str = "SIL",
    **blend: Any,
) -> Trajectory:
    """Align, resample and blend in one call (paper A sections 5.1.2 and 5.1.3).

    For a change of g(u) or of the overlap alone, keep the result of
    :func:`~corpus_tools.synthesis.pieces.align_fragments` and call :func:`blend_pieces` again: the
    parameters are theirs.
    """
    aligned = align_fragments(
        selection,
        utterance,
        fragments,
        names=names,
        rate_hz=rate_hz,
        warp=warp,
        resampling=resampling,
        c=c,
        silence=silence,
    )
    return blend_pieces(aligned, **blend)
