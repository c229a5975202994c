"""What cameras make of an actor: head motion, a slipping jig, skin, noise, spikes, swaps, occlusions."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from corpus_tools.core import BoolArray, FloatArray
from corpus_tools.demo.actor import jig_mm, marker_names, true_markers
from corpus_tools.demo.gestures import DIMENSIONS

__all__ = ["UNDISTURBED", "Disturbances", "Seen", "disturb"]

SLIP_S = 0.08
"""How long the jig takes to slip, s."""

SWAPS_FROM = 0.55
"""Share of a recording after which markers may be exchanged (our choice: after the words that all sentences
of the domain share; in those one swap would be seen in every fifth sentence that is put together)."""


@dataclass(frozen=True, slots=True)
class Disturbances:
    """What a capture adds to the truth; the figures are those of optical capture, ours where none is known.

    Attributes
    ----------
    skin_mm : (float, float)
        Private motion of the skin under each marker, 1-8 Hz: least and greatest rms distance from where the
        marker would be, mm. Every marker has its own, the same in all recordings.
    sensor_mm : float
        White noise of the cameras, sd per axis, mm.
    spike_share : float
        Share of marker samples that jump away, for one frame or two.
    spike_mm : (float, float)
        How far, mm.
    swap_chance : float
        Chance of a recording that two neighbouring markers exchange their names for 4-16 frames.
    n_gaps : float
        Short occlusions (3-12 frames) of one marker: their mean number in a recording.
    long_chance, cluster_chance, jig_chance : float
        Chance of a recording that one marker is hidden for 24-72 frames, that 2-5 neighbours are hidden
        together for 6-30, that one of the jig's is hidden for 12-60.
    rotation_deg, translation_mm : float
        Extent of the slow head motion.
    slip_chance, slip_mm : float
        Chance of a recording that the jig slips on the skull, and how far, mm.
    """

    skin_mm: tuple[float, float] = (0.15, 0.3)
    sensor_mm: float = 0.05
    spike_share: float = 2e-4
    spike_mm: tuple[float, float] = (1.5, 6.0)
    swap_chance: float = 0.05
    n_gaps: float = 2.0
    long_chance: float = 0.15
    cluster_chance: float = 0.2
    jig_chance: float = 0.1
    rotation_deg: float = 4.0
    translation_mm: float = 15.0
    slip_chance: float = 0.15
    slip_mm: float = 1.5


UNDISTURBED = Disturbances((0.0, 0.0), 0.0, 0.0, (0.0, 0.0), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""A capture that shows the truth."""


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """What cameras saw, and everything that was done to the truth.

    ``positions = rotation @ (truth + skin, jig) + translation``, then noise, swaps, spikes and occlusions.

    Attributes
    ----------
    positions_mm : (n_frames, 73, 3) mm
        NaN where occluded.
    skin_mm : (n_frames, 66, 3) mm
        Private motion of the skin.
    jig_mm : (n_frames, 7, 3) mm
        Where the head markers were on the skull.
    rotation : (n_frames, 3, 3)
    translation_mm : (n_frames, 3) mm
    spiked, swapped, occluded : (n_frames, 73) bool
        What is occluded is neither of the others.
    slip_s : float
        When the jig slipped, s; NaN when it did not.
    """

    positions_mm: FloatArray
    skin_mm: FloatArray
    jig_mm: FloatArray
    rotation: FloatArray
    translation_mm: FloatArray
    spiked: BoolArray
    swapped: BoolArray
    occluded: BoolArray
    slip_s: float


@functools.cache
def _neighbours() -> tuple[tuple[int, ...], ...]:
    """Return the other face markers of each, nearest first."""
    rest = true_markers(np.zeros((1, len(DIMENSIONS))))[0]
    distance = np.linalg.norm(rest[:, None] - rest[None], axis=2)
    return tuple(tuple(int(j) for j in row if j != i) for i, row in enumerate(np.argsort(distance, axis=1)))


def _band(
    n: int, rate_hz: float, low_hz: float, high_hz: float, rng: np.random.Generator, m: int
) -> FloatArray:
    """Return band-limited noise, (n, m, 3); the rms length of each of the `m` vectors is 1."""
    spectrum = np.fft.rfft(rng.normal(size=(n, m, 3)), axis=0)
    frequency = np.fft.rfftfreq(n, 1.0 / rate_hz)
    spectrum[(frequency < low_hz) | (frequency > high_hz)] = 0
    noise = np.fft.irfft(spectrum, n, axis=0)
    length = np.sqrt((noise**2).sum(axis=2).mean(axis=0))
    return np.asarray(noise / np.maximum(length, 1e-9)[:, None])


def _skin(n: int, m: int, rate_hz: float, how: Disturbances, rng: np.random.Generator) -> FloatArray:
    """Return the private motion of every marker; how large it is belongs to the actor, not the recording."""
    low, high = how.skin_mm
    size = np.random.default_rng(m).uniform(low, high, m)
    return np.asarray(size[:, None] * _band(n, rate_hz, 1.0, 8.0, rng, m))


def _head_pose(
    n: int, rate_hz: float, how: Disturbances, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Return rotations (n, 3, 3) and translations (n, 3) mm of slow head motion about the neck."""
    turn, shift = (_band(n, rate_hz, 0.0, 1.0, rng, 1)[:, 0] for _ in range(2))
    rotation = Rotation.from_rotvec(np.deg2rad(0.7 * how.rotation_deg) * turn).as_matrix()
    neck = jig_mm().mean(0) - [0.0, 160.0, 60.0]
    return rotation, neck + 0.7 * how.translation_mm * shift - rotation @ neck


def _slipping_jig(
    n: int, rate_hz: float, how: Disturbances, rng: np.random.Generator
) -> tuple[FloatArray, float]:
    """Return where the head markers are on the skull (n, 7, 3) mm, and when they slipped (NaN: never)."""
    jig, centre = jig_mm(), jig_mm().mean(0)
    slips, where = rng.random() < how.slip_chance, rng.uniform(0.3, 0.7)
    direction, axis = rng.normal(size=3), rng.normal(size=3)
    if not slips:
        return np.repeat(jig[None], n, axis=0), float("nan")
    slip_s = where * n / rate_hz
    turned = Rotation.from_rotvec(np.deg2rad(0.2) * axis / np.linalg.norm(axis)).apply(jig - centre) + centre
    moved = turned + how.slip_mm * direction / np.linalg.norm(direction)
    u = np.clip((np.arange(n) / rate_hz - slip_s) / SLIP_S, 0.0, 1.0)
    share = (u * u * (3.0 - 2.0 * u))[:, None, None]
    return np.asarray((1.0 - share) * jig + share * moved), float(slip_s)


def _spiked(
    shape: tuple[int, int], how: Disturbances, rng: np.random.Generator
) -> tuple[BoolArray, FloatArray]:
    """Return which samples jump and how far they do, (n_frames, n_markers, 3) mm."""
    begins = rng.random(shape) < how.spike_share / 1.25
    spiked = begins.copy()
    spiked[1:] |= begins[:-1] & (rng.random((shape[0] - 1, shape[1])) < 0.25)
    direction = rng.normal(size=(*shape, 3))
    direction /= np.linalg.norm(direction, axis=2, keepdims=True)
    return spiked, direction * (spiked * rng.uniform(*how.spike_mm, shape))[..., None]


def _swap(positions: FloatArray, how: Disturbances, rng: np.random.Generator) -> BoolArray:
    """Exchange two neighbours of one region for a while, in place; return where."""
    n, m = positions.shape[:2]
    swapped = np.zeros((n, m), bool)
    one, length = int(rng.integers(len(_neighbours()))), min(int(rng.integers(4, 17)), n)
    happens = rng.random() < how.swap_chance
    start = int(rng.uniform(SWAPS_FROM, 1.0) * (n - length + 1))
    if happens:
        region = marker_names()[one].rstrip("0123456789")
        other = next(j for j in _neighbours()[one] if marker_names()[j].startswith(region))
        span = slice(start, start + length)
        positions[span, [one, other]] = positions[span, [other, one]]
        swapped[span, [one, other]] = True
    return swapped


def _occluded(shape: tuple[int, int], how: Disturbances, rng: np.random.Generator) -> BoolArray:
    """Return what is hidden: short and long, one marker and several together, now and then of the jig."""
    n, m = shape
    face = len(_neighbours())
    hidden = np.zeros(shape, bool)

    def hide(markers: list[int], least: int, most: int) -> None:
        length = min(int(rng.integers(least, most + 1)), n - 2)
        start = int(rng.integers(n - length + 1))
        hidden[start : start + length, markers] = True

    for _ in range(int(rng.poisson(how.n_gaps))):
        hide([int(rng.integers(face))], 3, 12)
    if rng.random() < how.long_chance:
        hide([int(rng.integers(face))], 24, 72)
    if rng.random() < how.cluster_chance:
        first = int(rng.integers(face))
        hide([first, *_neighbours()[first][: int(rng.integers(1, 5))]], 6, 30)
    if rng.random() < how.jig_chance:
        hide([face + int(rng.integers(m - face))], 12, 60)
    return hidden


def disturb(
    face: FloatArray, rate_hz: float, rng: np.random.Generator, how: Disturbances | None = None
) -> Seen:
    """Return what cameras would see of a talking actor.

    Every kind of disturbance has a generator of its own: to leave one out does not change the others.

    Parameters
    ----------
    face : (n_frames, 66, 3) mm
        From :func:`true_markers`.
    rate_hz : float
    rng : numpy Generator
    how : Disturbances, optional
    """
    how = how or Disturbances()
    n, m = face.shape[:2]
    for_skin, for_jig, for_head, for_noise, for_spikes, for_swaps, for_gaps = rng.spawn(7)
    skin = _skin(n, m, rate_hz, how, for_skin)
    jig, slip_s = _slipping_jig(n, rate_hz, how, for_jig)
    rotation, translation = _head_pose(n, rate_hz, how, for_head)
    every = np.concatenate([face + skin, jig], axis=1)
    seen = every @ rotation.swapaxes(1, 2) + translation[:, None]
    seen += how.sensor_mm * for_noise.normal(size=seen.shape)
    swapped = _swap(seen, how, for_swaps)
    spiked, jump = _spiked(swapped.shape, how, for_spikes)
    seen += jump
    occluded = _occluded(swapped.shape, how, for_gaps)
    seen[occluded] = np.nan
    shown = ~occluded
    return Seen(seen, skin, jig, rotation, translation, spiked & shown, swapped & shown, occluded, slip_s)
