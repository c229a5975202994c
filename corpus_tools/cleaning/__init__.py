"""From raw captures to clean ones: head motion, noise, gaps, posture, neutral pose (paper A section 4)."""

from corpus_tools.cleaning.bias import PhoneHalves, RecordingBias, holding, phone_halves, recording_bias
from corpus_tools.cleaning.corpus import CleanedCorpus, clean_captures
from corpus_tools.cleaning.face_model import FaceModel, face_model
from corpus_tools.cleaning.fillers import GAP_FILLERS
from corpus_tools.cleaning.filling import check_gap_method, fill_gaps
from corpus_tools.cleaning.gaps import gaps, marker_gaps
from corpus_tools.cleaning.head_motion import (
    HeadMotion,
    estimate_head_motion,
    reference_shape,
    remove_head_motion,
)
from corpus_tools.cleaning.innovations import (
    estimated_smooth,
    likeliest_cutoffs,
    smooth_by_components,
    smooth_estimated,
)
from corpus_tools.cleaning.kalman import kalman_smooth, measurement_sd_mm, smooth_channels
from corpus_tools.cleaning.neutral import neutral_pose
from corpus_tools.cleaning.outliers import Outliers, find_outliers, usual_spread_mm, without_outliers
from corpus_tools.cleaning.rehearsal import Rehearsals, Trial, rehearse
from corpus_tools.cleaning.slips import Slip, find_slips, with_slips_marked

__all__ = [
    "GAP_FILLERS",
    "CleanedCorpus",
    "FaceModel",
    "HeadMotion",
    "Outliers",
    "PhoneHalves",
    "RecordingBias",
    "Rehearsals",
    "Slip",
    "Trial",
    "check_gap_method",
    "clean_captures",
    "estimate_head_motion",
    "estimated_smooth",
    "face_model",
    "fill_gaps",
    "find_outliers",
    "find_slips",
    "gaps",
    "holding",
    "kalman_smooth",
    "likeliest_cutoffs",
    "marker_gaps",
    "measurement_sd_mm",
    "neutral_pose",
    "phone_halves",
    "recording_bias",
    "reference_shape",
    "rehearse",
    "remove_head_motion",
    "smooth_by_components",
    "smooth_channels",
    "smooth_estimated",
    "usual_spread_mm",
    "with_slips_marked",
    "without_outliers",
]
