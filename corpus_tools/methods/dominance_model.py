"""Dominance functions (Cohen & Massaro 1993) for one principal component, and how they are fitted.

A frame at time t has the weight of phone i

    w_i = D_i / sum D,   D_i = alpha_i exp(-theta_i |t - t_i|),   F(t) = sum_i w_i T_i

with the target T, the strength alpha and two rates theta (before and after the phone) of its kind. The
exponent of the time is 1, as in most uses of the model. log alpha, log theta and T are found by least squares
with an analytic gradient (L-BFGS), as a most probable value: each is drawn to a prior, the more the fewer
frames speak for another one (our choice: a rare phone keeps the value of its viseme class).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize

from corpus_tools.core import BoolArray, FloatArray, IntArray

__all__ = ["DominanceProblem", "dominance_curve", "fit_dominance", "stack_problems"]

FRAME_WEIGHT = 0.2
"""Information in a frame: neighbours at video rate say nearly the same (our choice)."""

NOISE = 0.4
"""Share of the variance that no label explains, as assumed in the balance of data and prior (our choice)."""

ROUNDS = 150
TOLERANCE = 1e-5
"""Most iterations of L-BFGS, and the relative gain at which it ends: a finer one changes held-out errors by
less than 0.1 % (measured) and takes twice as long."""

_NEVER = -1e9


@dataclass(frozen=True, slots=True, eq=False)
class DominanceProblem:
    """Frames and the phones around them.

    Attributes
    ----------
    distance_s : (n_frames, n_places)
        Absolute time from each frame to where each phone of its utterance is at its target.
    before : (n_frames, n_places) bool
        The frame lies before the phone.
    kind : (n_frames, n_places) int64
        Row of the parameters of each phone; -1 for a place that holds none.
    """

    distance_s: FloatArray
    before: BoolArray
    kind: IntArray


def stack_problems(problems: list[DominanceProblem]) -> DominanceProblem:
    """Return the frames of several utterances as one problem; short ones get empty places."""
    most = max(p.kind.shape[1] for p in problems)

    def padded(values: npt.NDArray[Any], fill: float) -> npt.NDArray[Any]:
        return np.pad(values, ((0, 0), (0, most - values.shape[1])), constant_values=fill)

    return DominanceProblem(
        np.concatenate([padded(p.distance_s, 0.0) for p in problems]),
        np.concatenate([padded(p.before, False) for p in problems]),
        np.concatenate([padded(p.kind, -1) for p in problems]),
    )


def _weights(problem: DominanceProblem, parameters: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the weights w of every phone in every frame, and the rate theta at which each falls."""
    log_alpha, log_back, log_ahead, _ = parameters
    theta = np.where(problem.before, np.exp(log_back)[problem.kind], np.exp(log_ahead)[problem.kind])
    level = np.where(problem.kind < 0, _NEVER, log_alpha[problem.kind] - theta * problem.distance_s)
    level -= level.max(axis=1, keepdims=True)
    weights = np.exp(level, out=level)
    weights /= weights.sum(axis=1, keepdims=True)
    return weights, theta


def dominance_curve(problem: DominanceProblem, parameters: FloatArray) -> FloatArray:
    """Return F at every frame, (n_frames,).

    Parameters
    ----------
    problem : DominanceProblem
    parameters : (4, n_kinds)
        log alpha, log theta before and after the phone, and the target T.
    """
    weights, _ = _weights(problem, parameters)
    return np.asarray((weights * parameters[3][problem.kind]).sum(axis=1))


def _misfit(
    flat: FloatArray, problem: DominanceProblem, values: FloatArray, prior: FloatArray, tightness: FloatArray
) -> tuple[float, FloatArray]:
    """Return the negative log posterior and its gradient; values have unit variance."""
    parameters = flat.reshape(4, -1)
    n_kinds = parameters.shape[1]
    weights, theta = _weights(problem, parameters)
    target = parameters[3][problem.kind]
    curve = (weights * target).sum(axis=1)
    error = curve - values
    scale = FRAME_WEIGHT / NOISE
    away = parameters - prior
    cost = 0.5 * scale * float(error @ error) + 0.5 * float((tightness * away**2).sum())
    on_target = scale * error[:, None] * weights
    on_level = on_target * (target - curve[:, None])
    on_theta = -on_level * problem.distance_s * theta
    gradient = tightness * away
    kind = np.where(problem.kind < 0, n_kinds, problem.kind).ravel()
    parts = (
        on_level,
        np.where(problem.before, on_theta, 0),
        np.where(problem.before, 0, on_theta),
        on_target,
    )
    for row, part in enumerate(parts):
        gradient[row] += np.bincount(kind, part.ravel(), n_kinds + 1)[:n_kinds]
    return cost, gradient.ravel()


def fit_dominance(
    problem: DominanceProblem, values: FloatArray, prior: FloatArray, spread: FloatArray
) -> FloatArray:
    """Return the most probable parameters, (4, n_kinds).

    Parameters
    ----------
    problem : DominanceProblem
    values : (n_frames,)
        The component to be met, of about unit variance.
    prior : (4, n_kinds)
        Where the parameters are drawn to, and where the search starts.
    spread : (4,)
        How far each of them usually lies from there (one standard deviation).
    """
    tightness = np.repeat(1.0 / np.asarray(spread)[:, None] ** 2, prior.shape[1], axis=1)
    found = minimize(
        _misfit,
        prior.ravel(),
        args=(problem, values, prior, tightness),
        jac=True,
        method="L-BFGS-B",
        options={"maxiter": ROUNDS, "ftol": TOLERANCE},
    )
    return np.asarray(found.x).reshape(4, -1)
