"""Closure projection: lips that should be closed, are (beyond paper A; applied after any method)."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import replace

import numpy as np

from corpus_tools.core import FloatArray, Interval, Trajectory, step

__all__ = ["close_lips", "closure_direction"]

MIN_HALF_WIDTH_S = 0.07
EXTRA_HALF_WIDTH_S = 0.04
PRESSED_MM = 0.5
"""How far beyond a closed mouth the projection may press the lips, mm (our choice: the skin's give)."""


def closure_direction(functional: FloatArray, components: FloatArray, variances: FloatArray) -> FloatArray:
    """Return the likeliest change of the face that opens the lips by 1 mm, (n_markers, 3).

    ``S a / (a' S a)`` with `S` the covariance of the corpus in its principal components and `a` the linear
    aperture: of all changes that move the aperture by 1 mm, the one nearest to how this face moves.

    Parameters
    ----------
    functional : (n_markers, 3)
        Weights of the aperture.
    components : (n_components, n_markers * 3)
        Orthonormal principal components.
    variances : (n_components,) mm2

    Returns
    -------
    (n_markers, 3) mm per mm
        All zero when the components do not move the lips.
    """
    a = components @ functional.ravel()
    strength = float((a * variances) @ a)
    if strength <= 0:
        return np.zeros_like(functional)
    return np.asarray(((a * variances) @ components / strength).reshape(functional.shape))


def _bump(times_s: FloatArray, centre_s: float, half_width_s: float) -> FloatArray:
    x = np.clip(np.abs(times_s - centre_s) / half_width_s, 0.0, 1.0)
    return np.asarray(np.cos(0.5 * np.pi * x) ** 2)


def _pressed(beyond_mm: FloatArray) -> FloatArray:
    """Bound what lies below 0 by -:data:`PRESSED_MM`, with slope 1 at 0: lips give, and do not pass."""
    below = np.minimum(beyond_mm, 0.0)
    return np.asarray(np.maximum(beyond_mm, 0.0) + PRESSED_MM * np.expm1(below / PRESSED_MM))


def close_lips(
    trajectory: Trajectory,
    phones: Iterable[Interval],
    *,
    bilabials: Collection[str],
    functional: FloatArray,
    direction: FloatArray,
    target_mm: float,
    tolerance_mm: float = 0.05,
    iterations: int = 3,
) -> Trajectory:
    """Close the lips in every bilabial that stayed open.

    Where the least aperture inside the phone lies above `target_mm`, the face is moved along `direction`
    under a cos^2 bump around that moment, as wide as the closure of a natural bilabial: half width
    max(70 ms, half the phone + 40 ms). Lips are only ever closed, never opened, and never pressed
    together by more than :data:`PRESSED_MM`; times without a bilabial near them do not change.

    Parameters
    ----------
    trajectory : Trajectory
    phones : iterable of Interval
    bilabials : collection of str
    functional : (n_markers, 3)
        Weights of the signed aperture.
    direction : (n_markers, 3)
        From :func:`closure_direction`.
    target_mm : float
        Aperture of a closed mouth: the corpus's own median closure.
    tolerance_mm : float
    iterations : int
        Rounds; bumps of neighbouring bilabials reach into one another.

    Returns
    -------
    Trajectory
        With a step that says how many closures were made and the largest change, mm.
    """
    times = np.asarray(trajectory.times_s)
    values = np.array(trajectory.values_mm)
    aperture = np.einsum("fmk,mk->f", values, functional)
    gain = float((direction * functional).sum())
    lips = [p for p in phones if p.text in bilabials]
    moved: dict[Interval, float] = {}
    for _ in range(iterations if gain > 0 else 0):
        for phone in lips:
            inside = np.flatnonzero((times >= phone.start_s) & (times <= phone.end_s))
            if not len(inside):
                inside = np.array([int(np.argmin(np.abs(times - phone.centre_s)))])
            at = int(inside[np.argmin(aperture[inside])])
            excess = float(aperture[at]) - target_mm
            if excess <= tolerance_mm:
                continue
            half = max(MIN_HALF_WIDTH_S, 0.5 * phone.duration_s + EXTRA_HALF_WIDTH_S)
            wanted = aperture - excess * _bump(times, float(times[at]), half)
            reached = np.minimum(aperture, target_mm + _pressed(wanted - target_mm))
            values -= ((aperture - reached) / gain)[:, None, None] * direction
            aperture = reached
            moved[phone] = moved.get(phone, 0.0) + excess
    done = step("close_lips", closures=len(moved), largest_mm=round(max(moved.values(), default=0.0), 4))
    return replace(trajectory, values_mm=values, history=(*trajectory.history, done))
