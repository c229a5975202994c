"""Closure projection: lips that should be closed, are (beyond paper A; applied after any method)."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from corpus_tools.core import FloatArray, IntArray, Interval, Trajectory, step

__all__ = ["HOLD_S", "close_lips", "closure_direction"]

HOLD_S = 0.042
"""So long closed lips are held (our choice: nine of ten natural closures of GRID speaker s1 last so long, and
a film of 30 frames a second shows one of its frames)."""
MIN_FLANK_S = 0.07
EXTRA_FLANK_S = 0.04
LEAST_FLANK_S = 0.04
"""Flanks that end before the centre of a short vowel are no shorter: a frame of video (our choice)."""
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


def _bump(times_s: FloatArray, first_s: float, last_s: float, flanks_s: tuple[float, float]) -> FloatArray:
    """Return 1 from `first_s` to `last_s`, and cos^2 flanks that take `flanks_s` before and after."""
    beyond = np.maximum((first_s - times_s) / flanks_s[0], (times_s - last_s) / flanks_s[1])
    return np.asarray(np.cos(0.5 * np.pi * np.clip(beyond, 0.0, 1.0)) ** 2)


def _flanks(
    phone: Interval, first_s: float, last_s: float, vowels: Sequence[Interval]
) -> tuple[float, float]:
    """Return how long the flanks are: as those of a natural bilabial, but over at the centre of a vowel."""
    usual = max(MIN_FLANK_S, 0.5 * phone.duration_s + EXTRA_FLANK_S)
    before = [first_s - v.centre_s for v in vowels if v.centre_s < phone.start_s]
    after = [v.centre_s - last_s for v in vowels if v.centre_s > phone.end_s]
    left, right = (max(LEAST_FLANK_S, min([usual, *found])) for found in (before, after))
    return left, right


def _pressed(beyond_mm: FloatArray) -> FloatArray:
    """Bound what lies below 0 by -:data:`PRESSED_MM`, with slope 1 at 0: lips give, and do not pass."""
    below = np.minimum(beyond_mm, 0.0)
    return np.asarray(np.maximum(beyond_mm, 0.0) + PRESSED_MM * np.expm1(below / PRESSED_MM))


def _inside(times_s: FloatArray, phone: Interval) -> IntArray:
    """Return the frames of a phone, one at least."""
    inside = np.flatnonzero((times_s >= phone.start_s) & (times_s <= phone.end_s))
    return inside if len(inside) else np.array([int(np.argmin(np.abs(times_s - phone.centre_s)))])


def _window(aperture_mm: FloatArray, n: int) -> tuple[int, float]:
    """Return where the `n` frames begin whose widest opening is least, and that opening."""
    widest = sliding_window_view(aperture_mm, n).max(axis=1)
    at = int(np.argmin(widest))
    return at, float(widest[at])


def close_lips(
    trajectory: Trajectory,
    phones: Iterable[Interval],
    *,
    labels: Collection[str],
    vowels: Collection[str] = (),
    functional: FloatArray,
    direction: FloatArray,
    target_mm: float,
    hold_mm: float | None = None,
    hold_s: float = HOLD_S,
    tolerance_mm: float = 0.05,
    iterations: int = 3,
) -> Trajectory:
    """Close the lips in every bilabial that stayed open, or closed for too short a moment to be seen.

    The lips are held within `hold_mm` for `hold_s` (or the phone, if it is shorter), where in the phone that
    takes least, and touch, `target_mm`, at the moment that lies nearest to it: the face is moved along
    `direction` under a bump with cos^2 flanks as wide as those of a natural bilabial, max(70 ms, half the
    phone + 40 ms), but over at the centre of the next vowel, which is not to be closed too. Lips are only
    ever closed, never opened, and never pressed together by more than :data:`PRESSED_MM`; times without a
    bilabial near them do not change.

    Parameters
    ----------
    trajectory : Trajectory
    phones : iterable of Interval
    labels : collection of str
        The phones: bilabials; or labiodentals, with the way from the lower lip to the teeth as aperture.
    vowels : collection of str
        Phones whose centres the flanks stay away from, to 40 ms beside the closure.
    functional : (n_markers, 3)
        Weights of the signed aperture.
    direction : (n_markers, 3)
        From :func:`closure_direction`.
    target_mm : float
        Aperture of a closed mouth: the corpus's own median closure.
    hold_mm : float, optional
        Aperture up to which the lips count as closed; `target_mm` by default.
    hold_s : float, s
        0: the lips need only touch.
    tolerance_mm : float
    iterations : int
        Rounds; bumps of neighbouring bilabials reach into one another.

    Returns
    -------
    Trajectory
        With a step that says how many closures were made and the largest change of the aperture, mm.
    """
    times = np.asarray(trajectory.times_s)
    values = np.array(trajectory.values_mm)
    aperture = before = np.einsum("fmk,mk->f", values, functional)
    gain = float((direction * functional).sum())
    n_held = 1 + math.floor(hold_s / float(np.diff(times[:2]).sum() or 1.0) + 1e-9)
    goals = ((n_held, target_mm if hold_mm is None else max(hold_mm, target_mm)), (1, target_mm))
    spoken = list(phones)
    lips, open_ = ([p for p in spoken if p.text in kind] for kind in (labels, vowels))
    moved: set[Interval] = set()
    for _ in range(iterations if gain > 0 else 0):
        for phone, (n, goal_mm) in itertools.product(lips, goals):
            inside = _inside(times, phone)
            n = min(n, len(inside))
            at, opening = _window(aperture[inside], n)
            excess = opening - goal_mm
            if excess <= tolerance_mm:
                continue
            first, last = times[inside[[at, at + n - 1]]].tolist()
            flanks = _flanks(phone, first, last, open_)
            wanted = aperture - excess * _bump(times, first, last, flanks)
            reached = np.minimum(aperture, target_mm + _pressed(wanted - target_mm))
            values -= ((aperture - reached) / gain)[:, None, None] * direction
            aperture = reached
            moved.add(phone)
    largest_mm = round(float((before - aperture).max(initial=0.0)), 4)
    done = step(
        "close_lips", phones=sorted({p.text for p in lips}), closures=len(moved), largest_mm=largest_mm
    )
    return replace(trajectory, values_mm=values, history=(*trajectory.history, done))
