"""What the effect plot and the natural band show; computed after a result, so that nothing waits for it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from corpus_tools.core import FloatArray
from corpus_tools.fragments import natural_band
from corpus_tools.synthesis import (
    WEIGHTINGS,
    EffectCurve,
    blend_pieces,
    effect_curves,
    narrowed,
)
from workbench.state.signals import SIGNALS, Signal
from workbench.state.stages import Request, Result

__all__ = ["OVERLAPS_S", "Effects", "blend_settings", "compute_effects", "effect_data", "signal_band"]

OVERLAPS_S = (0.02, 0.04, 0.06, 0.08, 0.1, 0.12, 0.15, 0.18, 0.21, 0.24, 0.27, 0.3)
"""Overlaps at which every weighting function is measured, s; of inertial joins, the durations."""

_AXES = {"crossfade": "longest overlap, ms", "inertial": "inertial duration, ms"}


@dataclass(frozen=True, slots=True, eq=False)
class Effects:
    """The measure at every join for every curve.

    Attributes
    ----------
    result : Result
        What it belongs to: it holds for any g(u) and overlap of the same pieces.
    curves : tuple of EffectCurve
    band : (times s, low, high)
        Natural range of the lip aperture, as of :func:`signal_band`.
    """

    result: Result
    curves: tuple[EffectCurve, ...]
    band: tuple[FloatArray, FloatArray, FloatArray]

    def fits(self, result: Result) -> bool:
        """Tell whether the curves are those of another result too."""
        mine, other = blend_settings(self.result.request), blend_settings(result.request)
        return self.result.pieces is result.pieces and mine == other

    def best(self, join: int) -> tuple[str, float, float] | None:
        """Return (weighting, overlap s, ratio) of the lowest measure at a join; None without any."""
        found = [
            (float(row[join]), float(overlap), curve.weighting)
            for curve in self.curves
            for overlap, row in zip(curve.overlaps_s, curve.ratios, strict=True)
            if join < len(row) and np.isfinite(row[join])
        ]
        if not found:
            return None
        ratio, overlap, name = min(found)
        return name, overlap, ratio


def effect_data(
    effects: Effects | None, result: Result, other: Result | None, join: int, side: str = "B"
) -> dict[str, object]:
    """Return the effect plot of one join as plain data.

    Parameters
    ----------
    effects : Effects or None
        None while they are being measured: the present dots alone are shown then.
    result : Result
    other : Result or None
        Of the setting that is not shown.
    join : int
    side : "A" or "B"
        Which of the two settings `result` is.
    """
    if join >= len(result.ratios):
        return {"overlaps": [], "curves": [], "now": None, "other": None}
    fits = effects is not None and effects.fits(result)
    curves = effects.curves if effects is not None and fits else ()
    mode = result.request.config.blend.mode
    same = other is not None and join < len(other.ratios) and other.request.same_target(result.request)
    same = same and other is not None and other.request.config.blend.mode == mode  # else on another axis
    return {
        "axis": _AXES[mode],
        "side": side,
        "overlaps": list(OVERLAPS_S) if fits else [],
        "curves": [{"name": c.weighting, "ratios": [float(r) for r in c.ratios[:, join]]} for c in curves],
        "now": _dot(result, join),
        "other": None
        if other is None or not same
        else {**_dot(other, join), "alike": other.pieces is result.pieces},
    }


def _dot(result: Result, join: int) -> dict[str, object]:
    blend = result.request.config.blend
    ratio = result.ratios[join]
    inertial = blend.mode == "inertial"
    return {
        "name": "inertial" if inertial else blend.weighting,
        "overlap": blend.inertial_s if inertial else blend.overlap_s,
        "ratio": ratio if np.isfinite(ratio) else None,
        "moved": not inertial and blend.shape != 0.0,
    }


def blend_settings(request: Request) -> dict[str, Any]:
    """Return the blend settings that are the same for every curve of the effect plot."""
    own = {"weighting", "shape", "overlap_s", "curve_weights", "inertial_s", "weighting_at"}
    return dict(request.config.blend.model_dump(exclude=own))


def compute_effects(result: Result) -> Effects:
    """Measure every weighting function at every overlap on the pieces of a result.

    Inertial joins know neither: they are measured at every duration instead, as one curve "inertial".
    """
    settings = blend_settings(result.request)
    pieces, natural = narrowed(result.pieces, result.request.corpus.natural)
    if result.request.config.blend.mode == "inertial":
        settings["natural"] = natural
        ratios = np.array([blend_pieces(pieces, **settings, inertial_s=s).peak_ratios for s in OVERLAPS_S])
        curves: tuple[EffectCurve, ...] = (EffectCurve("inertial", np.asarray(OVERLAPS_S), ratios),)
    else:
        names: dict[str, dict[str, Any]] = {name: {} for name in WEIGHTINGS if name != "user"}
        curves = effect_curves(pieces, natural, names, OVERLAPS_S, **settings)
    return Effects(result, curves, signal_band(result, SIGNALS[0]))


def signal_band(result: Result, signal: Signal) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return (times s, low, high): what the speaker does in the same diphones of the other recordings."""
    corpus = result.request.corpus
    values = [
        signal.measure(np.asarray(r.capture.positions_mm), r.capture.names)
        for r in corpus.inventory.recordings
    ]
    return natural_band(corpus.inventory, result.utterance.phones, values, result.request.exclude)
