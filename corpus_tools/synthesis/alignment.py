"""Time warps that bring the labels of a fragment onto those of the target (paper A section 5.1.2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.interpolate import PchipInterpolator

from corpus_tools.core import FloatArray, Fragment, Interval, frozen

__all__ = ["HOLD_EASE_S", "REST_S", "TimeWarp", "fragment_warp", "rest_clock"]

WarpKind = Literal["linear", "pchip"]

REST_S = 0.1
"""Time in which the motion comes to rest at either end of an utterance, s (our choice)."""

HOLD_EASE_S = 0.05
"""Time in which the clock slows down before a pose is held, s (our choice; less in a short silence)."""

_MIN_STEP_S = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class TimeWarp:
    """An increasing map between the clock of a fragment and that of the target, slope 1 outside its knots.

    Attributes
    ----------
    source_s, target_s : (n_knots,) float64, s
        Strictly increasing.
    kind : {"linear", "pchip"}
        Piecewise linear, or monotone cubic (C1: no jump of velocity at a label).
    hold_before_s, hold_after_s : float
        Source times beyond which the pose is held: silence of the target that the source does not have.
        The clock slows down to the hold over :data:`HOLD_EASE_S`, without a jump of velocity.
    merged : int
        Labels left out because they coincide with their neighbour on either clock.
    """

    source_s: FloatArray
    target_s: FloatArray
    kind: WarpKind = "linear"
    hold_before_s: float = -np.inf
    hold_after_s: float = np.inf
    merged: int = 0

    def __post_init__(self) -> None:
        object.__setattr__(self, "source_s", frozen(self.source_s))
        object.__setattr__(self, "target_s", frozen(self.target_s))

    def to_source(self, times_s: FloatArray) -> FloatArray:
        """Return source times of target times."""
        t = np.asarray(times_s, dtype=np.float64)
        inside = np.clip(t, self.target_s[0], self.target_s[-1])
        if self.kind == "pchip" and len(self.target_s) > 2:
            mapped = PchipInterpolator(self.target_s, self.source_s)(inside)
        else:
            mapped = np.interp(inside, self.target_s, self.source_s)
        asked = np.asarray(mapped + (t - inside))
        asked = _hold_after(asked, self.hold_after_s, float(self.source_s[-1]))
        return -_hold_after(-asked, -self.hold_before_s, -float(self.source_s[0]))

    def to_target(self, times_s: FloatArray) -> FloatArray:
        """Return target times of source times: the inverse of :meth:`to_source`, holds left out."""
        s = np.asarray(times_s, dtype=np.float64)
        inside = np.clip(s, self.source_s[0], self.source_s[-1])
        low = np.interp(inside, self.source_s, self.target_s)
        if self.kind == "pchip" and len(self.target_s) > 2:
            low = self._bisect(inside)
        return np.asarray(low + (s - inside))

    def _bisect(self, source: FloatArray) -> FloatArray:
        curve = PchipInterpolator(self.target_s, self.source_s)
        k = np.clip(np.searchsorted(self.source_s, source, side="right") - 1, 0, len(self.source_s) - 2)
        low, high = self.target_s[k], self.target_s[k + 1]
        for _ in range(60):
            middle = 0.5 * (low + high)
            above = curve(middle) > source
            low, high = np.where(above, low, middle), np.where(above, middle, high)
        return np.asarray(0.5 * (low + high))


def _hold_after(asked: FloatArray, hold_s: float, speech_s: float) -> FloatArray:
    """Slow source times down to `hold_s`: slope 1 until `ease` before it, 0 from `ease` after it, C1."""
    if not np.isfinite(hold_s):
        return asked
    ease = min(HOLD_EASE_S, hold_s - speech_s)
    if ease <= 0:
        return np.minimum(asked, hold_s)
    into = np.clip(asked - (hold_s - ease), 0.0, 2.0 * ease)
    return np.asarray(np.minimum(asked, hold_s - ease) + into - into * into / (4.0 * ease))


def _holds(fragment: Fragment, silence: str) -> tuple[float, float]:
    """Return where the pose is held: at the captured end of an outer silence, else at a silence's centre."""
    before, after = -np.inf, np.inf
    edges, times = fragment.edges_s, fragment.times_s
    if fragment.phones[0] == silence:
        start = max(edges[0], times[0]) if fragment.unit.first == 0 else 0.5 * (edges[0] + edges[1])
        before = min(float(start), float(edges[1]))
    if fragment.phones[-1] == silence:
        end = times[-1] if edges[-1] >= times[-1] else 0.5 * (edges[-2] + edges[-1])
        after = max(float(end), float(edges[-2]))
    return before, after


def _knots(fragment: Fragment, spoken: tuple[Interval, ...], silence: str) -> tuple[list[float], list[float]]:
    """Return source and target times of edges and centres, without the outer edges of outer silences."""
    source, target = [], []
    last = len(spoken) - 1
    for i, phone in enumerate(spoken):
        a, b = float(fragment.edges_s[i]), float(fragment.edges_s[i + 1])
        quiet = phone.text == silence and fragment.phones[i] == silence
        if quiet and i in (0, last):
            source.append(b if i == 0 else a)
            target.append(phone.end_s if i == 0 else phone.start_s)
            continue
        source += [a, 0.5 * (a + b), b]
        target += [phone.start_s, phone.centre_s, phone.end_s]
    return source, target


def _increasing(source: list[float], target: list[float]) -> tuple[FloatArray, FloatArray]:
    """Merge knots that coincide on either clock: zero-length phones have no slope."""
    keep_s, keep_t = [source[0]], [target[0]]
    for s, t in zip(source[1:], target[1:], strict=True):
        if s - keep_s[-1] >= _MIN_STEP_S and t - keep_t[-1] >= _MIN_STEP_S:
            keep_s.append(s)
            keep_t.append(t)
    return np.array(keep_s), np.array(keep_t)


def fragment_warp(
    fragment: Fragment, spoken: tuple[Interval, ...], kind: WarpKind = "linear", silence: str = "SIL"
) -> TimeWarp:
    """Return the warp that lays a fragment's phones onto the target phones it speaks.

    Every phone edge, and every centre, of the source lands on that of the target. Silence at either end of
    the fragment is not stretched: from the edge of speech it runs at its own pace, and where the target is
    silent for longer than the source, the pose is held (our choice: a stretched silence is slow motion, and
    beyond its centre the source belongs to other speech). Outside the unit the clocks run at the same pace.

    Parameters
    ----------
    fragment : Fragment
    spoken : tuple of Interval, as many as the fragment has phones
    kind : {"linear", "pchip"}
    silence : str
    """
    labels = _knots(fragment, spoken, silence)
    source, target = _increasing(*labels)
    different = {(round(s, 6), round(t, 6)) for s, t in zip(*labels, strict=True)}  # an edge ends and begins
    merged = len(different) - len(source)
    return TimeWarp(source, target, kind, *_holds(fragment, silence), merged)


def rest_clock(times_s: FloatArray, duration_s: float, lead_s: float, tail_s: float) -> FloatArray:
    """Return a clock that starts and stops gently, so that the motion starts and ends at rest.

    Over the first `lead_s` and the last `tail_s` seconds the clock runs as u^2 (2 - u): it leaves with speed
    0 and joins the true clock with speed 1 (our choice); in between nothing changes.
    """
    t = np.array(times_s, dtype=np.float64)
    if lead_s > 0:
        u = np.clip(t / lead_s, 0.0, 1.0)
        t = np.where(t < lead_s, lead_s * u * u * (2.0 - u), t)
    if tail_s > 0:
        u = np.clip((duration_s - t) / tail_s, 0.0, 1.0)
        t = np.where(t > duration_s - tail_s, duration_s - tail_s * u * u * (2.0 - u), t)
    return t
