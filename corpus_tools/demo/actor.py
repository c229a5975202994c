"""The simulated actor: articulators move the bundled head, and markers are read off its skin."""

from __future__ import annotations

import functools

import numpy as np

from corpus_tools.core import FloatArray, Registry
from corpus_tools.demo.gestures import DIMENSIONS
from corpus_tools.mesh import bundled_head, bundled_morph_mm

__all__ = ["HEAD_MARKERS", "LAYOUTS", "jig_mm", "layout_columns", "marker_names", "true_markers"]

HEAD_MARKERS = tuple(f"head{i}" for i in range(7))

LAYOUTS: Registry[tuple[str, ...]] = Registry("marker layout")
"""Marker layouts by name; each holds the beginnings of the marker names that it leaves out."""
LAYOUTS.add("full", ())
LAYOUTS.add("outer-lips", ("lip_in",))

_UNITS = {
    "jaw": (("jawOpen", 0.42),),
    "round": (("mouthPucker", 0.85), ("mouthFunnel", 0.12)),
    "spread": (
        ("mouthStretchLeft", 0.45),
        ("mouthStretchRight", 0.45),
        ("mouthSmileLeft", 0.15),
        ("mouthSmileRight", 0.15),
    ),
    "bite": (("mouthRollLower", 0.95), ("mouthUpperUpLeft", 0.4), ("mouthUpperUpRight", 0.4)),
}
_CLOSE_UNIT = ("mouthClose", 0.42)
_BITE_AGAINST_JAW = 0.6
"""Share of the opening of the jaw that the lower lip makes up for on its way to the upper teeth."""
_JIG_MM = (
    (-45, 60, -20),
    (0, 85, -10),
    (45, 60, -20),
    (-60, 95, -45),
    (60, 95, -45),
    (-30, 115, -50),
    (30, 115, -50),
)


def marker_names() -> tuple[str, ...]:
    """Return the names of the 66 face markers and 7 head markers."""
    return (*bundled_head().markers, *HEAD_MARKERS)


def layout_columns(layout: str) -> list[int]:
    """Return which of the 73 markers a layout has.

    Raises
    ------
    InputError
        There is no such layout; the sentence lists those that there are.
    """
    without = LAYOUTS[layout]
    return [i for i, name in enumerate(marker_names()) if not name.startswith(without or ("\0",))]


@functools.cache
def _rig() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the markers at rest, their motion per articulator, and the motion that closes the mouth."""
    head = bundled_head()
    vertices = np.array(list(head.markers.values()))
    moves = np.zeros((len(DIMENSIONS), len(vertices), 3))
    for name, units in _UNITS.items():
        for unit, weight in units:
            moves[DIMENSIONS.index(name)] += weight * bundled_morph_mm(unit)[vertices]
    unit, weight = _CLOSE_UNIT
    return head.vertices_mm[vertices], moves, weight * bundled_morph_mm(unit)[vertices]


@functools.cache
def jig_mm() -> FloatArray:
    """Return the head markers on the skull, (7, 3) mm: a band above the brows."""
    rest, _, _ = _rig()
    brow = rest[[i for i, name in enumerate(marker_names()) if name.startswith("brow")]].mean(0)
    return np.asarray(np.array(_JIG_MM, float) + brow)


def _pairs() -> list[tuple[int, int]]:
    names = list(bundled_head().markers)
    return [(names.index(f"lip_in{a}"), names.index(f"lip_in{b}")) for a, b in ((1, 7), (2, 6), (3, 5))]


def true_markers(articulators: FloatArray) -> FloatArray:
    """Return the face markers without any disturbance, (n_frames, 66, 3) mm, head at rest.

    Constrictions are tasks of lips and jaw together: `close` brings the lips together and `bite` the lower
    lip to the upper teeth whatever the jaw does. Lips never pass through each other: a pair that would is set
    to touch half way.

    Parameters
    ----------
    articulators : (n_frames, 5)
    """
    rest, moves, close = _rig()
    face = rest + np.einsum("fd,dmi->fmi", articulators, moves)
    jaw = articulators[:, DIMENSIONS.index("jaw")]
    together = np.clip(1.1 * articulators[:, DIMENSIONS.index("close")], 0.0, 1.0)
    bite = _BITE_AGAINST_JAW * articulators[:, DIMENSIONS.index("bite")]
    face += (jaw * np.maximum(together, bite))[:, None, None] * close
    for upper, lower in _pairs():
        gap = face[:, upper, 1] - face[:, lower, 1]
        gap_closed = np.where(gap < 0, 0.0, gap * (1.0 - together))
        face[:, upper, 1] -= 0.5 * (gap - gap_closed)
        face[:, lower, 1] += 0.5 * (gap - gap_closed)
    return np.asarray(face)
