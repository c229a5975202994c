"""The control surface: patches that follow the markers, and vertices that follow them without a patch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array, vstack

from corpus_tools.core import FloatArray, IntArray, frozen
from corpus_tools.mesh.attachment import Attachment
from corpus_tools.mesh.chart import CONTROL_POINTS, Chart

__all__ = ["ControlSurface", "with_followers"]


@dataclass(frozen=True, slots=True, eq=False)
class ControlSurface:
    """Bezier triangles whose control points are linear in the markers.

    Attributes
    ----------
    chart : Chart
        Triangles of markers; patches 3 k to 3 k + 2 belong to triangle k. Patches beyond these carry one
        vertex each and only shift (:func:`with_followers`).
    net : csr (10 n_patches, n_markers) float64
        Shift of control points = net @ shift of markers; ten rows a patch, in the order of
        :data:`corpus_tools.mesh.chart.CONTROL_POINTS`: b300 b030 b003 b210 b201 b120 b021 b102 b012 b111.
        A row sums to one where no point that stands still has a share in it.
    markers_rest_mm : (n_markers, 3) float64, mm
    control_rest_mm : (n_patches, 10, 3) float64, mm
    """

    chart: Chart
    net: csr_array
    markers_rest_mm: FloatArray
    control_rest_mm: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "markers_rest_mm", frozen(self.markers_rest_mm))
        object.__setattr__(self, "control_rest_mm", frozen(self.control_rest_mm))

    @property
    def n_patches(self) -> int:
        """Number of patches."""
        return int(self.net.shape[0]) // 10

    def control_mm(self, markers_mm: npt.ArrayLike) -> FloatArray:
        """Return the control points (n_patches, 10, 3), mm, for markers (n_markers, 3), mm."""
        shift = np.asarray(self.net @ (np.asarray(markers_mm, float) - self.markers_rest_mm))
        return np.asarray(self.control_rest_mm + shift.reshape(-1, 10, 3))


def with_followers(
    surface: ControlSurface,
    attachment: Attachment,
    vertices: IntArray,
    places_mm: FloatArray,
    basis: FloatArray,
) -> tuple[ControlSurface, Attachment]:
    """Add vertices that move by a fixed blend of marker shifts, each on a small patch that only shifts.

    So the inside of the mouth, which has no markers, is deformed by the same kernel as the skin.

    Parameters
    ----------
    surface : ControlSurface
    attachment : Attachment
    vertices : (n,) int
    places_mm : (n, 3), mm
        At rest.
    basis : (n, n_markers)
    """
    if not len(vertices):
        return surface, attachment
    small = np.concatenate([CONTROL_POINTS[:, :2] / 3.0, np.zeros((10, 1))], axis=1)
    patches = places_mm[:, None, :] + small - small.mean(axis=0)
    net = vstack([surface.net, csr_array(np.repeat(basis, 10, axis=0))], format="csr")
    control = np.concatenate([surface.control_rest_mm, patches])
    n, third = len(vertices), np.full((len(vertices), 3), 1.0 / 3.0)
    both = np.concatenate([attachment.vertices, vertices])
    order = np.argsort(both)
    grown = Attachment(
        both[order],
        np.concatenate([attachment.patch, surface.n_patches + np.arange(n)])[order],
        np.concatenate([attachment.bary, third])[order],
        np.concatenate([attachment.offset, np.zeros((n, 3))])[order],
        np.concatenate([attachment.weight, np.ones(n)])[order],
    )
    return ControlSurface(surface.chart, csr_array(net), surface.markers_rest_mm, control), grown
