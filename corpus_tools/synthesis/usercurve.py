"""A person's own g(u): monotone and as smooth as asked by construction, because its slope is what is chosen.

The slope of g is a sum of cubic B-splines with weights that are never negative, so that no choice of them can
make a curve that rises again (our choice: the paper's figure 3 shows curves and gives no way to draw one).
With four weights the B-splines are the Bernstein polynomials.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import nnls

from corpus_tools.core import FloatArray, InputError

__all__ = ["DEFAULT_CURVE", "HANDLE_WEIGHTS", "curve_order", "curve_through", "user_weighting"]

_DEGREE = 3
"""Of the slope; g is one higher and has three derivatives everywhere inside."""

HANDLE_WEIGHTS = 16
"""Weights of a curve that is laid through handles; the first and last two are 0."""

DEFAULT_CURVE = (0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0)
"""Symmetric and C2, less steep in the middle than any other C2 curve in the registry."""


def _checked(weights: Sequence[float]) -> FloatArray:
    """Return the weights as shares of their sum."""
    given = np.asarray(weights, dtype=np.float64)
    good = given.ndim == 1 and len(given) > _DEGREE and bool(np.isfinite(given).all())
    if not (good and (given >= 0).all() and given.max() > 0):
        shown = ", ".join(f"{w:g}" for w in given.ravel()[:8]) + (", ..." if given.size > 8 else "")
        raise InputError(
            f"The weights of the slope of g(u) are ({shown}): four or more numbers were expected, none below "
            "0 and not all of them 0."
        )
    scaled = given / given.max()
    return np.asarray(scaled / scaled.sum())


def _knots(n_weights: int) -> FloatArray:
    """Return the knots of g for `n_weights` weights of its slope: even, and held at both ends."""
    inner = np.linspace(0.0, 1.0, n_weights - _DEGREE + 1)
    return np.concatenate([np.zeros(_DEGREE + 1), inner, np.ones(_DEGREE + 1)])


def user_weighting(weights: Sequence[float]) -> Callable[[FloatArray], FloatArray]:
    """Return g(u) whose fall over the overlap is shared out by `weights`.

    Parameters
    ----------
    weights : sequence of float
        Share of the fall that each B-spline of the slope takes, from u = 0 to u = 1; four or more, none
        negative, not all 0. With a first and last weight of 0 the curve is C1, with two on either side C2,
        with three C3 (:func:`curve_order`).

    Returns
    -------
    callable
        g for u in [0, 1], of any shape.

    Raises
    ------
    InputError
        The weights are none.
    """
    share = _checked(weights)
    rest = np.concatenate([[1.0], np.cumsum(share[::-1])[::-1][1:], [0.0]])
    rest[rest > 1.0] = 1.0
    curve = BSpline(_knots(len(share)), rest, _DEGREE + 1, extrapolate=False)

    def g(u: FloatArray) -> FloatArray:
        return np.asarray(curve(u), dtype=np.float64)

    return g


def curve_order(weights: Sequence[float]) -> int:
    """Return how many derivatives of a user's g(u) vanish at both ends, 0 to 3: it blends C0 to C3."""
    used = np.flatnonzero(_checked(weights))
    return int(min(used[0], len(weights) - 1 - used[-1], _DEGREE))


def _check_points(points: Sequence[tuple[float, float]]) -> FloatArray:
    given = np.asarray(points, dtype=np.float64)
    if given.ndim != 2 or given.shape[1:] != (2,) or not ((given >= 0) & (given <= 1)).all():
        raise InputError(
            "The handles of g(u) must be pairs (u, g), one or more, with both numbers from 0 to 1."
        )
    return given


def curve_through(
    points: Sequence[tuple[float, float]], n_weights: int = HANDLE_WEIGHTS
) -> tuple[float, ...]:
    """Return the weights of the C2 curve that passes as near to the handles as a falling one can.

    Non-negative least squares on the weights, with a slight preference for a slope that bends little, which
    decides between the curves that pass equally near.

    Parameters
    ----------
    points : sequence of (u, g)
        Handles that a person drags; those that ask for a rise are met half way.
    n_weights : int
        Five or more; the first and last two are 0.

    Returns
    -------
    tuple of float
        For :func:`user_weighting`; they sum to 1.

    Raises
    ------
    InputError
        No handles, one outside the unit square, or too few weights.
    """
    handles = _check_points(points)
    if n_weights < _DEGREE + 2:
        raise InputError(f"A C2 curve has {_DEGREE + 2} weights or more; {n_weights} were asked for.")
    inside = slice(2, n_weights - 2)
    units = np.eye(n_weights)[inside]
    falls = np.stack([1.0 - user_weighting(w)(handles[:, 0]) for w in units], axis=1)
    padded = np.eye(n_weights)[:, inside]
    bend = 1e-3 * np.diff(padded, n=2, axis=0)
    whole = np.full((1, padded.shape[1]), 1e3)
    matrix = np.concatenate([falls, bend, whole])
    aim = np.concatenate([1.0 - handles[:, 1], np.zeros(len(bend)), [1e3]])
    found, _ = nnls(matrix, aim)
    shares = np.zeros(n_weights)
    shares[inside] = np.round(found / found.sum(), 6)
    return tuple(float(s) for s in shares)
