"""Interpolation between mean postures of viseme classes: animation by visemes without coarticulation."""

from __future__ import annotations

from typing import Literal

import numpy as np
from scipy.interpolate import PchipInterpolator

from corpus_tools.core import FloatArray, Trajectory, Utterance, step
from corpus_tools.methods.registry import METHODS, Method, Predictor
from corpus_tools.methods.targets import anchor_times_s, class_targets_mm, nearest_class
from corpus_tools.methods.training import TrainingSet

__all__ = ["fit_viseme_linear"]

Interpolation = Literal["linear", "pchip"]

_TINY_S = 1e-6


def fit_viseme_linear(training: TrainingSet, interpolation: Interpolation = "linear") -> Predictor:
    """Return the predictor that passes through the mean posture of each phone's viseme class.

    The posture stands at the centre of the phone; a silence rests between its two ends.

    Parameters
    ----------
    training : TrainingSet
    interpolation : {"linear", "pchip"}
        Straight, or monotone cubic (C1, at rest at each viseme that is an extreme).
    """
    targets = class_targets_mm(training)
    silence = training.phones.silence

    def predict(utterance: Utterance) -> Trajectory:
        times = training.times_s(utterance)
        anchors = anchor_times_s(utterance, silence, 0.0, max(float(times[-1]), _TINY_S))
        names = [nearest_class(training.phones, label, targets) for label in utterance.labels]
        postures = np.stack([targets[name] for name in names])
        knots, values = _knots(anchors, postures)
        motion = _curve(knots, values, times, interpolation)
        done = step("viseme-linear", interpolation=interpolation)
        return Trajectory(times, motion, training.markers, history=(done,))

    return predict


def _knots(anchors_s: FloatArray, postures: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return strictly increasing times and the postures there: both ends of a rest, one time of a phone."""
    knots, values = [float(anchors_s[0, 0])], [postures[0]]
    for (start, end), posture in zip(anchors_s, postures, strict=True):
        for at in (start, end):
            if at > knots[-1] + _TINY_S:
                knots.append(float(at))
                values.append(posture)
    return np.array(knots), np.stack(values)


def _curve(
    knots: FloatArray, values: FloatArray, times: FloatArray, interpolation: Interpolation
) -> FloatArray:
    at = np.clip(times, knots[0], knots[-1])
    if len(knots) == 1:
        return np.repeat(values, len(times), axis=0)
    if interpolation == "pchip":
        return np.asarray(PchipInterpolator(knots, values)(at))
    k = np.clip(np.searchsorted(knots, at, side="right") - 1, 0, len(knots) - 2)
    share = (at - knots[k]) / (knots[k + 1] - knots[k])
    return np.asarray(values[k] + share[:, None, None] * (values[k + 1] - values[k]))


METHODS.add(
    "viseme-linear",
    Method("viseme-linear", "Lines between the mean postures of viseme classes.", fit_viseme_linear),
)
