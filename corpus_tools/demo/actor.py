"""The simulated actor: articulators move the bundled head, markers are read off its skin and disturbed."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from corpus_tools.core import FloatArray
from corpus_tools.demo.gestures import DIMENSIONS
from corpus_tools.mesh import bundled_head, bundled_morph_mm

__all__ = ["HEAD_MARKERS", "Disturbances", "disturb", "marker_names", "true_markers"]

HEAD_MARKERS = tuple(f"head{i}" for i in range(7))

_UNITS = {
    "jaw": (("jawOpen", 0.42),),
    "round": (("mouthPucker", 0.75), ("mouthFunnel", 0.35)),
    "spread": (
        ("mouthStretchLeft", 0.45),
        ("mouthStretchRight", 0.45),
        ("mouthSmileLeft", 0.15),
        ("mouthSmileRight", 0.15),
    ),
    "bite": (("mouthRollLower", 0.75), ("mouthUpperUpLeft", 0.25), ("mouthUpperUpRight", 0.25)),
}
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


@functools.cache
def _rig() -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return markers at rest, their motion per articulator, the motion that closes the mouth, and the jig."""
    head = bundled_head()
    vertices = np.array(list(head.markers.values()))
    rest = head.vertices_mm[vertices]
    moves = np.zeros((len(DIMENSIONS), len(vertices), 3))
    for name, units in _UNITS.items():
        row = DIMENSIONS.index(name)
        for unit, weight in units:
            moves[row] += weight * bundled_morph_mm(unit)[vertices]
    close = 0.42 * bundled_morph_mm("mouthClose")[vertices]
    brow = rest[[i for i, n in enumerate(head.markers) if n.startswith("brow")]].mean(0)
    return rest, moves, close, np.array(_JIG_MM, float) + brow


def _pairs() -> list[tuple[int, int]]:
    names = list(bundled_head().markers)
    return [(names.index(f"lip_in{a}"), names.index(f"lip_in{b}")) for a, b in ((1, 7), (2, 6), (3, 5))]


def true_markers(articulators: FloatArray) -> FloatArray:
    """Return the face markers without any disturbance, (n_frames, 66, 3) mm, head at rest.

    `close` brings the lips together whatever the jaw does, and lips never pass through each other: a pair
    that would is set to touch half way.

    Parameters
    ----------
    articulators : (n_frames, 5)
    """
    rest, moves, close, _ = _rig()
    face = rest + np.einsum("fd,dmi->fmi", articulators, moves)
    jaw = articulators[:, DIMENSIONS.index("jaw")]
    together = np.clip(1.1 * articulators[:, DIMENSIONS.index("close")], 0.0, 1.0)
    face += (jaw * together)[:, None, None] * close
    for upper, lower in _pairs():
        gap = face[:, upper, 1] - face[:, lower, 1]
        gap_closed = np.where(gap < 0, 0.0, gap * (1.0 - together))
        face[:, upper, 1] -= 0.5 * (gap - gap_closed)
        face[:, lower, 1] += 0.5 * (gap - gap_closed)
    return np.asarray(face)


@dataclass(frozen=True, slots=True)
class Disturbances:
    """What a capture adds to the truth.

    Attributes
    ----------
    skin_mm : float
        Private motion of the skin under each marker, sd per axis, 1-8 Hz, mm.
    sensor_mm : float
        White noise of the cameras, sd per axis, mm.
    n_gaps : int
        Occlusions of one marker each.
    rotation_deg, translation_mm : float
        Extent of the slow head motion.
    """

    skin_mm: float = 0.12
    sensor_mm: float = 0.05
    n_gaps: int = 3
    rotation_deg: float = 4.0
    translation_mm: float = 15.0


def _slow(
    n: int, rate_hz: float, low_hz: float, high_hz: float, shape: tuple[int, ...], rng: np.random.Generator
) -> FloatArray:
    """Return band-limited noise of unit sd, (n, *shape)."""
    spectrum = np.fft.rfft(rng.normal(size=(n, *shape)), axis=0)
    frequency = np.fft.rfftfreq(n, 1.0 / rate_hz)
    keep = (frequency >= low_hz) & (frequency <= high_hz)
    spectrum[~keep] = 0
    noise = np.fft.irfft(spectrum, n, axis=0)
    return np.asarray(noise / max(float(noise.std()), 1e-9))


def _rotations(angles: FloatArray) -> FloatArray:
    """Return rotation matrices (n, 3, 3) of angles about x, y, z in radians."""
    (cx, cy, cz), (sx, sy, sz) = np.cos(angles).T, np.sin(angles).T
    one, zero = np.ones_like(cx), np.zeros_like(cx)
    rx = np.stack([one, zero, zero, zero, cx, -sx, zero, sx, cx], -1).reshape(-1, 3, 3)
    ry = np.stack([cy, zero, sy, zero, one, zero, -sy, zero, cy], -1).reshape(-1, 3, 3)
    rz = np.stack([cz, -sz, zero, sz, cz, zero, zero, zero, one], -1).reshape(-1, 3, 3)
    return np.asarray(rz @ ry @ rx)


def disturb(
    face: FloatArray, rate_hz: float, rng: np.random.Generator, how: Disturbances | None = None
) -> FloatArray:
    """Return what cameras would see of a talking actor, (n_frames, 73, 3) mm, NaN where occluded.

    Parameters
    ----------
    face : (n_frames, 66, 3) mm
        From :func:`true_markers`.
    rate_hz : float
    rng : numpy Generator
    how : Disturbances, optional
    """
    how = how or Disturbances()
    n = len(face)
    _, _, _, jig = _rig()
    skin = face + how.skin_mm * _slow(n, rate_hz, 1.0, 8.0, face.shape[1:], rng)
    every = np.concatenate([skin, np.broadcast_to(jig, (n, *jig.shape))], axis=1)
    angles = np.deg2rad(how.rotation_deg) * 0.4 * _slow(n, rate_hz, 0.0, 1.0, (3,), rng)
    shift = 0.4 * how.translation_mm * _slow(n, rate_hz, 0.0, 1.0, (3,), rng)
    centre = jig.mean(0) - [0.0, 60.0, 60.0]
    seen = np.einsum("fij,fmj->fmi", _rotations(angles), every - centre) + centre + shift[:, None]
    seen = seen + how.sensor_mm * rng.normal(size=seen.shape)
    for _ in range(how.n_gaps):
        marker = int(rng.integers(face.shape[1]))
        start, length = int(rng.integers(n - 12)), int(rng.integers(3, 13))
        seen[start : start + length, marker] = np.nan
    return np.asarray(seen)
