"""The mean pose: the face held still. What every other method has to beat."""

from __future__ import annotations

import numpy as np

from corpus_tools.core import Trajectory, Utterance, step
from corpus_tools.methods.registry import METHODS, Method, Predictor
from corpus_tools.methods.training import TrainingSet

__all__ = ["fit_mean"]


def fit_mean(training: TrainingSet) -> Predictor:
    """Return the predictor that holds the mean face of all frames of speech."""
    mean = training.speech_frames_mm(remove_bias=False).mean(axis=0)

    def predict(utterance: Utterance) -> Trajectory:
        times = training.times_s(utterance)
        values = np.broadcast_to(mean, (len(times), *mean.shape))
        return Trajectory(times, values, training.markers, history=(step("mean"),))

    return predict


METHODS.add("mean", Method("mean", "The mean face of speech, held still.", fit_mean))
