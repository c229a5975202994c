"""Weighting functions g(u) of the blend (paper A section 5.1.3, eq. (2) and figure 3).

``theta_blend = g(u) theta_0 + (1 - g(u)) theta_1`` with g(0) = 1 and g(1) = 0. The blend is C^k at
both ends of the overlap exactly when the first k derivatives of g vanish there. A new g(u) is a function
here and a line of the registry; the laws in the tests run over every entry.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from corpus_tools.core import FloatArray, InputError, Registry
from corpus_tools.synthesis.usercurve import DEFAULT_CURVE, user_weighting

__all__ = ["WEIGHTINGS", "crossover", "weighting"]

Weighting = Callable[[FloatArray], FloatArray]

WEIGHTINGS: Registry[Weighting] = Registry("weighting function")


@WEIGHTINGS.register("linear")
def linear(u: FloatArray) -> FloatArray:
    """Fall in a straight line; C0."""
    return 1.0 - u


@WEIGHTINGS.register("raised-cosine")
def raised_cosine(u: FloatArray) -> FloatArray:
    """Fall as half a cosine; C1."""
    return np.asarray(0.5 + 0.5 * np.cos(np.pi * u))


@WEIGHTINGS.register("smoothstep")
def smoothstep(u: FloatArray) -> FloatArray:
    """Fall as the cubic 1 - 3u^2 + 2u^3; C1."""
    return 1.0 - u * u * (3.0 - 2.0 * u)


@WEIGHTINGS.register("smootherstep")
def smootherstep(u: FloatArray) -> FloatArray:
    """Fall as the quintic 1 - 10u^3 + 15u^4 - 6u^5; C2."""
    return 1.0 - u**3 * (10.0 - u * (15.0 - 6.0 * u))


@WEIGHTINGS.register("septic")
def septic(u: FloatArray) -> FloatArray:
    """Fall as the polynomial of degree 7 with three derivatives zero at both ends; C3."""
    near = np.minimum(u, 1.0 - u)  # from the nearer end: no cancellation, monotone to rounding
    rise = near**4 * (35.0 - near * (84.0 - near * (70.0 - 20.0 * near)))
    return np.where(u < 0.5, 1.0 - rise, rise)


@WEIGHTINGS.register("exponential")
def exponential(u: FloatArray) -> FloatArray:
    """Fall as exp(-6u), renormalised to reach 0; C0, fast at first."""
    end = np.exp(-6.0)
    return np.asarray((np.exp(-6.0 * u) - end) / (1.0 - end))


@WEIGHTINGS.register("sigmoid")
def sigmoid(u: FloatArray) -> FloatArray:
    """Fall as a logistic curve of slope 10, renormalised to reach 1 and 0; C0."""
    edge = np.tanh(2.5)
    return np.asarray(0.5 - 0.5 * np.tanh(5.0 * (u - 0.5)) / edge)


@WEIGHTINGS.register("bump")
def bump(u: FloatArray) -> FloatArray:
    """Fall as exp(-1/(1-u)) / (exp(-1/u) + exp(-1/(1-u))); every derivative is zero at both ends."""
    with np.errstate(divide="ignore", over="ignore"):
        return np.asarray(1.0 / (1.0 + np.exp(1.0 / (1.0 - u) - 1.0 / u)))


WEIGHTINGS.add("user", user_weighting(DEFAULT_CURVE))


def crossover(u: FloatArray, shape: float) -> FloatArray:
    """Move the crossover of a weighting: u' = u / (u + (1 - u) e^(2 shape)).

    A smooth, increasing map of [0, 1] onto itself whose slope at both ends is positive and finite, so that
    the order of contact of g is kept (our choice; the paper's figure 3 shows curves of different decay and
    gives no formula). shape 0 is the identity; above 0 the first fragment holds longer, below 0 the second
    comes earlier.
    """
    return np.asarray(u / (u + (1.0 - u) * np.exp(2.0 * shape)))


def weighting(name: str, shape: float = 0.0, curve_weights: Sequence[float] = DEFAULT_CURVE) -> Weighting:
    """Return g(u) by name, with its crossover moved.

    Parameters
    ----------
    name : str
        A name of :data:`WEIGHTINGS`.
    shape : float
        -1 (early) to 1 (late).
    curve_weights : sequence of float
        Of the curve "user" (:func:`~corpus_tools.synthesis.usercurve.user_weighting`); the others do not
        look at them.

    Returns
    -------
    callable
        ``g(u)`` for u of any shape; u is clipped to [0, 1].

    Raises
    ------
    InputError
        There is no such g(u), `shape` lies outside [-1, 1], or the weights of the user's curve are none.
    """
    function = user_weighting(curve_weights) if name == "user" else WEIGHTINGS[name]
    if not -1.0 <= shape <= 1.0:
        raise InputError(
            f"The shape of g(u) is {shape:g}; a number from -1 (early) to 1 (late) was expected."
        )

    def g(u: FloatArray) -> FloatArray:
        inside = np.clip(np.asarray(u, dtype=np.float64), 0.0, 1.0)
        return np.clip(function(crossover(inside, shape) if shape else inside), 0.0, 1.0)

    return g
