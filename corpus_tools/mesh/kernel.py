"""Frames of vertices on Bezier triangles (paper A equation 3): de Casteljau, compiled."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from corpus_tools.core import FloatArray
from corpus_tools.mesh.attachment import Attachment, frames_at

__all__ = ["patch_frames"]


def patch_frames(
    net: csr_array,
    attachment: Attachment,
    rest_mm: FloatArray,
    targets_mm: FloatArray,
    dtype: npt.DTypeLike = np.float32,
) -> npt.NDArray[np.floating]:
    """Return the attached vertices in every frame, (n_frames, n, 3), mm."""
    out = np.empty((len(targets_mm), len(rest_mm), 3), dtype)
    a = attachment
    for frame, markers in enumerate(targets_mm):
        control = np.asarray(net @ markers).reshape(-1, 10, 3)[a.patch]
        point, t1, t2, normal = frames_at(control, a.bary)
        place = point + a.offset[:, :1] * t1 + a.offset[:, 1:2] * t2 + a.offset[:, 2:] * normal
        out[frame] = rest_mm + a.weight[:, None] * (place - rest_mm)
    return out
