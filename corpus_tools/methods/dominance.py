"""Cohen-Massaro dominance fitted to the corpus, per viseme class and per phone: the fair rule-based baseline.

An unfitted dominance model is a straw man. Here every parameter is fitted on the training recordings, by
principal component of the face.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from corpus_tools.core import FloatArray, IntArray, Trajectory, Utterance, step
from corpus_tools.methods.dominance_model import (
    DominanceProblem,
    dominance_curve,
    fit_dominance,
    stack_problems,
)
from corpus_tools.methods.registry import METHODS, Method, Predictor
from corpus_tools.methods.settings import Components
from corpus_tools.methods.training import TrainingSet, phone_anchors_s
from corpus_tools.synthesis import PostureBasis

__all__ = ["fit_dominance_class", "fit_dominance_phone"]

USUAL_RATE = np.log(20.0)
"""Prior of log theta, theta in 1/s: dominance halves in 35 ms (our choice)."""

CLASS_SPREAD = np.array([1.0, 1.0, 1.0, 1.5])
PHONE_SPREAD = np.array([0.7, 0.7, 0.7, 0.7])
"""How far classes lie from the prior, and phones from their class: logs, and targets in sd (our choice)."""


@dataclass(frozen=True, slots=True, eq=False)
class _Fitted:
    """Parameters (n_components, 4, n_kinds) of the kinds in `rows`; targets are in sd of each component."""

    basis: PostureBasis
    sd_mm: FloatArray
    rows: Mapping[str, int]
    kind_of: Callable[[str], str]
    parameters: FloatArray


def _problem(times_s: FloatArray, anchors_s: FloatArray, kind: IntArray) -> DominanceProblem:
    """Return distances of frames to where each phone is at its target; no distance inside a rest."""
    early = anchors_s[:, 0] - times_s[:, None]
    late = times_s[:, None] - anchors_s[:, 1]
    return DominanceProblem(
        np.maximum(np.maximum(early, late), 0.0),
        np.asarray(early > 0),
        np.broadcast_to(kind, (len(times_s), len(kind))),
    )


def _frames(
    training: TrainingSet,
    basis: PostureBasis,
    rows: Mapping[str, int],
    kind_of: Callable[[str], str],
    remove_bias: bool,
) -> tuple[DominanceProblem, FloatArray]:
    """Return all frames of speech as one problem, and their weights (n_frames, n_components) mm."""
    problems, weights = [], []
    for recording in training.of(remove_bias):
        here = training.speaking(recording)
        anchors = phone_anchors_s(recording.utterance, training.phones.silence)
        kind = np.array([rows[kind_of(p)] for p in recording.utterance.labels])
        problems.append(_problem(recording.capture.times_s[here], anchors, kind))
        weights.append(basis.project(recording.capture.positions_mm[here]))
    return stack_problems(problems), np.concatenate(weights)


def _first_targets(problem: DominanceProblem, values: FloatArray, n_kinds: int) -> FloatArray:
    """Return the mean value around each kind, half-way to the overall mean 0; 0 where no frame is near."""
    near = (problem.distance_s < 0.03) & (problem.kind >= 0)
    frame, place = np.nonzero(near)
    kind = problem.kind[frame, place]
    count = np.bincount(kind, minlength=n_kinds)
    return np.asarray(np.bincount(kind, values[frame], n_kinds) / (count + 1.0))


def _classes(training: TrainingSet, components: int, remove_bias: bool) -> _Fitted:
    """Return the fit per class; the fit per phone, which starts from it, shares it."""
    key = ("dominance-class", components, remove_bias)
    return training.shared(key, lambda: _fit_classes(training, components, remove_bias))


def _fit_classes(training: TrainingSet, components: int, remove_bias: bool) -> _Fitted:
    phones = training.phones
    basis = training.basis(remove_bias, components)
    names = sorted({phones.viseme_class(p) for p in phones.phones})
    rows = {name: row for row, name in enumerate(names)}
    problem, weights = _frames(training, basis, rows, phones.viseme_class, remove_bias)
    sd = weights.std(axis=0).clip(min=1e-9)
    found = []
    for values in (weights / sd).T:
        prior = np.zeros((4, len(rows)))
        prior[1:3] = USUAL_RATE
        prior[3] = _first_targets(problem, values, len(rows))
        found.append(fit_dominance(problem, values, prior, CLASS_SPREAD))
    return _Fitted(basis, sd, rows, phones.viseme_class, np.stack(found))


def _fit_phones(training: TrainingSet, components: int, remove_bias: bool) -> _Fitted:
    """Fit each phone around its class; a phone that the recordings lack keeps the values of the class."""
    classes = _classes(training, components, remove_bias)
    phones = training.phones
    rows = {phone: row for row, phone in enumerate(phones.phones)}
    problem, weights = _frames(training, classes.basis, rows, phones.normalise, remove_bias)
    of_class = [classes.rows[phones.viseme_class(p)] for p in phones.phones]
    found = [
        fit_dominance(problem, values, prior[:, of_class], PHONE_SPREAD)
        for values, prior in zip((weights / classes.sd_mm).T, classes.parameters, strict=True)
    ]
    return _Fitted(classes.basis, classes.sd_mm, rows, phones.normalise, np.stack(found))


def _predictor(training: TrainingSet, fitted: _Fitted, name: str) -> Predictor:
    def predict(utterance: Utterance) -> Trajectory:
        times = training.times_s(utterance)
        anchors = phone_anchors_s(utterance, training.phones.silence)
        kind = np.array([fitted.rows[fitted.kind_of(p)] for p in utterance.labels])
        problem = _problem(times, anchors, kind)
        curves = [dominance_curve(problem, p) for p in fitted.parameters]
        values = fitted.basis.reconstruct(np.stack(curves, axis=1) * fitted.sd_mm)
        return Trajectory(times, values, training.markers, history=(step(name, components=len(curves)),))

    return predict


def fit_dominance_class(
    training: TrainingSet, components: Components = 8, remove_bias: bool = True
) -> Predictor:
    """Fit one dominance function per viseme class and principal component.

    Parameters
    ----------
    training : TrainingSet
    components : int
        Principal components of the face; 8, as in paper B.
    remove_bias : bool
        Fit to recordings freed of the posture that each keeps constantly.
    """
    return _predictor(training, _classes(training, components, remove_bias), "dominance-class")


def fit_dominance_phone(
    training: TrainingSet, components: Components = 8, remove_bias: bool = True
) -> Predictor:
    """Fit one dominance function per phone and principal component, around that of its viseme class.

    Parameters are those of :func:`fit_dominance_class`.
    """
    return _predictor(training, _fit_phones(training, components, remove_bias), "dominance-phone")


_SUMMARY = "Cohen-Massaro dominance, fitted per {} and principal component."
METHODS.add(
    "dominance-class", Method("dominance-class", _SUMMARY.format("viseme class"), fit_dominance_class)
)
METHODS.add("dominance-phone", Method("dominance-phone", _SUMMARY.format("phone"), fit_dominance_phone))
