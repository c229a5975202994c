"""Retarget: the volume warp from the actor's neutral to a mesh, and lip contact (paper A section 6)."""

from corpus_tools.retarget.contact import (
    contact_aperture,
    contact_solver,
    keep_lips_apart,
    lip_marker_pairs,
    pair_response,
)
from corpus_tools.retarget.markers import Retargeter, prepare_retarget, retarget
from corpus_tools.retarget.report import RetargetReport, retarget_report
from corpus_tools.retarget.warp import (
    WARP_KERNELS,
    FoldReport,
    VolumeWarp,
    WarpKernel,
    choose_smoothing,
    fit_volume_warp,
    fold_check,
    leave_one_out_mm,
)

__all__ = [
    "WARP_KERNELS",
    "FoldReport",
    "RetargetReport",
    "Retargeter",
    "VolumeWarp",
    "WarpKernel",
    "choose_smoothing",
    "contact_aperture",
    "contact_solver",
    "fit_volume_warp",
    "fold_check",
    "keep_lips_apart",
    "leave_one_out_mm",
    "lip_marker_pairs",
    "pair_response",
    "prepare_retarget",
    "retarget",
    "retarget_report",
]
