"""Motion fragments (paper A) as methods: greedy and Viterbi, each step beyond the paper with a switch."""

from __future__ import annotations

from typing import Any, Literal

from corpus_tools.core import Trajectory, Utterance
from corpus_tools.fragments import cut_fragment
from corpus_tools.methods.registry import METHODS, SEARCHES, Method, Predictor, TunedPredictor
from corpus_tools.methods.settings import Fading, Seconds, Weight, Weighting
from corpus_tools.methods.training import CONTEXT_S, TrainingSet
from corpus_tools.methods.tuning import tune_weights
from corpus_tools.synthesis import render_selection
from corpus_tools.synthesis.alignment import WarpKind
from corpus_tools.synthesis.blending import BlendMode
from corpus_tools.synthesis.lips import make_contacts
from corpus_tools.synthesis.pieces import Resampling

__all__ = ["fit_greedy", "fit_viterbi"]

JOIN_COMPONENTS = 12
LIP_COMPONENTS = 16
ROUNDS = 3
"""Of the join distance and of closure projection: the defaults of a config, as those of all settings here."""


def _fit(
    training: TrainingSet,
    search: str,
    weights: dict[str, float],
    blend: dict[str, Any],
    remove_bias: bool,
    closure: bool,
) -> Predictor:
    model = training.selection(remove_bias, JOIN_COMPONENTS)
    lips = training.lips(remove_bias, LIP_COMPONENTS) if closure else None

    def predict(utterance: Utterance) -> Trajectory:
        selection = SEARCHES[search](model, utterance, n_rejected=0, **weights)
        fragments = [cut_fragment(model.inventory, c.unit, CONTEXT_S) for c in selection.chosen]
        motion = render_selection(
            selection,
            utterance,
            fragments,
            names=training.markers,
            rate_hz=training.rate_hz,
            silence=training.phones.silence,
            **blend,
        )
        return make_contacts(lips, motion, utterance, training.phones, ROUNDS) if lips else motion

    return predict


def fit_greedy(
    training: TrainingSet,
    remove_bias: bool = True,
    closure: bool = True,
    mode: BlendMode = "crossfade",
    weighting: Weighting = "smootherstep",
    overlap_s: Seconds = 0.12,
    inertial_s: Fading = 0.12,
    warp: WarpKind = "linear",
    resampling: Resampling = "inverse",
    duration: Weight = 1.0,
    context: Weight = 0.3,
    position: Weight = 0.0,
    stress: Weight = 0.0,
) -> Predictor:
    """Index the recordings for the longest-first search of paper A.

    Parameters
    ----------
    training : TrainingSet
    remove_bias : bool
        Cut units from recordings freed of the posture that each keeps constantly.
    closure : bool
        Close the lips where a bilabial stayed open.
    mode : {"crossfade", "inertial"}
    weighting, overlap_s, inertial_s
        As of :func:`~corpus_tools.synthesis.blend_pieces`.
    warp, resampling
        As of :func:`~corpus_tools.synthesis.align_fragments`.
    duration, context, position, stress : float
        Weights of timing, context, place and stress among fragments of the same length.
    """
    blend: dict[str, Any] = {"mode": mode, "weighting": weighting, "overlap_s": overlap_s}
    blend |= {"inertial_s": inertial_s, "warp": warp, "resampling": resampling}
    weights = {"duration": duration, "context": context, "position": position, "stress": stress}
    return _fit(training, "greedy", weights, blend, remove_bias, closure)


def _tuned(
    training: TrainingSet, start: dict[str, float], blend: dict[str, Any], remove_bias: bool
) -> dict[str, float]:
    """Return the weights found on the training set, once for all methods that ask for the same."""
    key = ("tuned", remove_bias, *start.items(), *blend.items())
    tuning = training.shared(
        key,
        lambda: tune_weights(
            training,
            SEARCHES["viterbi"],
            start,
            remove_bias=remove_bias,
            components=JOIN_COMPONENTS,
            blend=blend,
        ),
    )
    return tuning.weights


def fit_viterbi(
    training: TrainingSet,
    remove_bias: bool = True,
    closure: bool = True,
    mode: BlendMode = "crossfade",
    weighting: Weighting = "smootherstep",
    overlap_s: Seconds = 0.12,
    inertial_s: Fading = 0.12,
    warp: WarpKind = "linear",
    resampling: Resampling = "inverse",
    duration: Weight = 1.0,
    context: Weight = 0.3,
    position: Weight = 0.0,
    stress: Weight = 0.0,
    backoff: Weight = 2.0,
    join: Weight = 1.0,
    velocity: Weight = 0.3,
    acceleration: Weight = 0.0,
    aperture: Weight = 0.0,
    sound: Weight = 0.0,
    per_join: Weight = 0.0,
    weights: Literal["given", "tuned"] = "given",
) -> Predictor:
    """Index the recordings for the search of the cheapest path.

    Parameters as of :func:`fit_greedy`, and the weights of :func:`~corpus_tools.synthesis.select_viterbi`.
    With `weights` "tuned" they are only where :func:`~corpus_tools.methods.tuning.tune_weights` begins.
    """
    blend: dict[str, Any] = {"mode": mode, "weighting": weighting, "overlap_s": overlap_s}
    blend |= {"inertial_s": inertial_s, "warp": warp, "resampling": resampling}
    given = {"duration": duration, "context": context, "position": position, "stress": stress}
    given |= {"backoff": backoff, "join": join, "velocity": velocity, "acceleration": acceleration}
    given |= {"aperture": aperture, "sound": sound, "per_join": per_join}
    if weights == "given":
        return _fit(training, "viterbi", given, blend, remove_bias, closure)
    found = _tuned(training, given, blend, remove_bias)
    return TunedPredictor(_fit(training, "viterbi", found, blend, remove_bias, closure), found)


_LONGEST = "Longest fragment first, as paper A prints it (its endless loop mended)."
_CHEAPEST = "The cheapest path over timing, context and join costs."
METHODS.add("greedy", Method("greedy", _LONGEST, fit_greedy))
METHODS.add("viterbi", Method("viterbi", _CHEAPEST, fit_viterbi))
