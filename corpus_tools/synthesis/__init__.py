"""Synthesis of marker motion from captured fragments (paper A section 5)."""

from corpus_tools.synthesis.alignment import TimeWarp, fragment_warp
from corpus_tools.synthesis.alignment_facts import AlignmentFacts, PhoneStretch, WayFacts, alignment_facts
from corpus_tools.synthesis.backoff import Pin
from corpus_tools.synthesis.basis import JoinFeatures, PostureBasis, join_features, posture_basis
from corpus_tools.synthesis.blending import blend_pieces, blend_weights, render_selection
from corpus_tools.synthesis.closure import close_lips, closure_direction
from corpus_tools.synthesis.contacts import Contact, lip_contacts
from corpus_tools.synthesis.effect import EffectCurve, effect_curves, narrowed
from corpus_tools.synthesis.greedy import greedy_as_printed, select_greedy
from corpus_tools.synthesis.inertial import InertialMotion, join_inertially
from corpus_tools.synthesis.joins import WINDOW_S as JOIN_WINDOW_S
from corpus_tools.synthesis.joins import (
    NaturalDistribution,
    join_gaps,
    natural_distribution,
    peaks_at,
    ranked_joins,
    rms_acceleration,
)
from corpus_tools.synthesis.model import PhoneClasses, SelectionModel, prepare_selection
from corpus_tools.synthesis.overlap import overlap_lengths
from corpus_tools.synthesis.pieces import AlignedPieces, Piece, align_fragments
from corpus_tools.synthesis.resampling import TimeRbf, fit_time_rbf, fit_uniform_rbf, resample_uniform
from corpus_tools.synthesis.rest import rest_at_ends
from corpus_tools.synthesis.sound import linked_utterance
from corpus_tools.synthesis.stand_ins import StandIn, stand_ins, stand_ins_told
from corpus_tools.synthesis.usercurve import DEFAULT_CURVE, curve_order, curve_through, user_weighting
from corpus_tools.synthesis.visible import how_it_differs
from corpus_tools.synthesis.viterbi import select_viterbi
from corpus_tools.synthesis.weighting import WEIGHTINGS, weighting
from corpus_tools.synthesis.weighting_at import WeightingAt, parse_weighting_at, weightings_of_joins

__all__ = [
    "DEFAULT_CURVE",
    "JOIN_WINDOW_S",
    "WEIGHTINGS",
    "AlignedPieces",
    "AlignmentFacts",
    "Contact",
    "EffectCurve",
    "InertialMotion",
    "JoinFeatures",
    "NaturalDistribution",
    "PhoneClasses",
    "PhoneStretch",
    "Piece",
    "Pin",
    "PostureBasis",
    "SelectionModel",
    "StandIn",
    "TimeRbf",
    "TimeWarp",
    "WayFacts",
    "WeightingAt",
    "align_fragments",
    "alignment_facts",
    "blend_pieces",
    "blend_weights",
    "close_lips",
    "closure_direction",
    "curve_order",
    "curve_through",
    "effect_curves",
    "fit_time_rbf",
    "fit_uniform_rbf",
    "fragment_warp",
    "greedy_as_printed",
    "how_it_differs",
    "join_features",
    "join_gaps",
    "join_inertially",
    "linked_utterance",
    "lip_contacts",
    "narrowed",
    "natural_distribution",
    "overlap_lengths",
    "parse_weighting_at",
    "peaks_at",
    "posture_basis",
    "prepare_selection",
    "ranked_joins",
    "render_selection",
    "resample_uniform",
    "rest_at_ends",
    "rms_acceleration",
    "select_greedy",
    "select_viterbi",
    "stand_ins",
    "stand_ins_told",
    "user_weighting",
    "weighting",
    "weightings_of_joins",
]
