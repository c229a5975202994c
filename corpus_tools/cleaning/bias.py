"""The posture that a whole recording keeps: one constant offset per recording and marker, found from phones.

Between recordings a speaker sits, holds the jaw and (in video) is landmarked a little differently. What a
recording shows beyond what the others show in the same halves of the same diphones is taken for that offset:

    y_i = mean of cell c(i) + offset of recording r(i) + rest,    sum of the offsets = 0

solved by weighted least squares (a two-way model; paper A has no such step, it is ours).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from corpus_tools.core import BoolArray, FloatArray, IntArray, frozen

__all__ = ["PhoneHalves", "RecordingBias", "holding", "phone_halves", "recording_bias"]

RIDGE = 1e-8
"""Of the normal equations, per frame of a recording: those that share no cell with others get no offset."""

DOUBT = 3.0
"""A half phone this many times as far off as the median one counts a quarter (our choice)."""


TINY = 1e-12
"""Keeps empty sums from dividing by 0."""


@dataclass(frozen=True, slots=True, eq=False)
class PhoneHalves:
    """The mean pose of each half phone of a recording.

    Attributes
    ----------
    cells : tuple of (phone, neighbour, half), n_halves of them
        "first" goes with the neighbour before, "second" with the one after.
    means_mm : (n_halves, n_markers, 3) mm
    n_frames : (n_halves, n_markers)
        Measured frames in the mean; 0 where there is none (the mean is then 0).
    """

    cells: tuple[tuple[str, str, str], ...]
    means_mm: FloatArray
    n_frames: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class RecordingBias:
    """What recordings keep constantly.

    Attributes
    ----------
    offsets_mm : (n_recordings, n_markers, 3) mm
        To subtract from every frame; they sum to 0 over the recordings.
    trust : (n_recordings, n_markers)
        By how much the least-squares offset was shrunk: 1 not at all, 0 to nothing.
    """

    offsets_mm: FloatArray
    trust: FloatArray


def phone_halves(
    positions_mm: FloatArray,
    times_s: FloatArray,
    measured: BoolArray,
    phones: Sequence[tuple[float, float, str]],
    silence: str,
) -> PhoneHalves:
    """Return the mean pose of both halves of every phone that is not silence.

    Parameters
    ----------
    positions_mm : (n_frames, n_markers, 3) mm
    times_s : (n_frames,) s
    measured : (n_frames, n_markers) bool
        Samples to use: neither filled nor doubtful.
    phones : sequence of (start s, end s, label)
    silence : str
    """
    labels = [silence, *(label for _, _, label in phones), silence]
    spans, cells = [], []
    for index, (start, end, label) in enumerate(phones):
        if label != silence:
            middle = 0.5 * (start + end)
            spans += [(start, middle), (middle, end)]
            cells += [(label, labels[index], "first"), (label, labels[index + 2], "second")]
    edges = np.searchsorted(times_s, np.array(spans).reshape(-1, 2))
    weight = measured.astype(np.float64)
    values = np.where(measured[..., None], positions_mm, 0.0)
    n_frames = _between(weight, edges)
    means = _between(values, edges) / np.maximum(n_frames, 1.0)[..., None]
    return PhoneHalves(tuple(cells), means, n_frames)


def _between(values: FloatArray, edges: IntArray) -> FloatArray:
    """Return the sum of the frames from edges[:, 0] up to, not including, edges[:, 1]."""
    total = np.concatenate([np.zeros((1, *values.shape[1:])), np.cumsum(values, axis=0)])
    return np.asarray(total[edges[:, 1]] - total[edges[:, 0]])


def recording_bias(halves: Sequence[PhoneHalves], rounds: int = 2) -> RecordingBias:
    """Find the constant offset of each recording.

    In the least-squares solution the offset of a recording is exactly its mean residual to the cell means of
    the *other* recordings, freed of their offsets: its own frames do not inform its own phone means. Half
    phones that are far off (a wrong label) count less. Each offset is then shrunk as in a mixed model, the
    more the fewer its frames: what a recording's first half does not share with its second is no constant.

    Parameters
    ----------
    halves : sequence of PhoneHalves
        One per recording, with the same markers.
    rounds : int
        Of reweighting; 0 is plain least squares.
    """
    known: dict[tuple[str, str, str], int] = {}
    cell = np.array([known.setdefault(c, len(known)) for h in halves for c in h.cells], dtype=np.int64)
    row = np.repeat(np.arange(len(halves)), [len(h.cells) for h in halves])
    values = np.concatenate([h.means_mm for h in halves])
    weight = np.concatenate([h.n_frames for h in halves])
    doubt = np.ones(len(row))
    for turn in range(rounds + 1):
        offsets, rest = _solve(values, weight * doubt[:, None], row, cell, len(halves))
        if turn < rounds:
            doubt = _down(rest, weight)
    trust = _trust(rest + offsets[row], weight * doubt[:, None], row, len(halves))
    shrunk = offsets * trust[..., None]
    return RecordingBias(frozen(shrunk - shrunk.mean(axis=0)), frozen(trust))


def holding(offsets_mm: FloatArray, functionals: FloatArray) -> FloatArray:
    """Return the offsets nearest to the given ones that leave linear measures of the face as they are.

    Parameters
    ----------
    offsets_mm : (n_recordings, n_markers, 3) mm
    functionals : (n_measures, n_markers, 3)
        Each measure is the sum of weights times positions.
    """
    flat = offsets_mm.reshape(len(offsets_mm), -1)
    rows = functionals.reshape(len(functionals), flat.shape[1])
    return np.asarray(flat - (flat @ rows.T) @ np.linalg.pinv(rows).T).reshape(offsets_mm.shape)


def _onto(groups: IntArray, n_groups: int, weight: FloatArray) -> sparse.csr_array:
    """Return the matrix (n_groups, n_values) that sums weighted values by group."""
    return sparse.csr_array((weight, (groups, np.arange(len(groups)))), shape=(n_groups, len(groups)))


def _solve(
    values: FloatArray, weight: FloatArray, row: IntArray, cell: IntArray, n_rows: int
) -> tuple[FloatArray, FloatArray]:
    """Return the offsets (n_rows, n_markers, 3) and the rest of every value, both mm.

    Markers that are seen alike share one system of equations: mostly that is all of them.
    """
    n_cells = int(cell.max(initial=-1)) + 1
    offsets, rest = np.zeros((n_rows, *values.shape[1:])), np.empty_like(values)
    in_cell = _onto(cell, n_cells, np.ones(len(cell)))
    for columns in _alike(weight):
        w, y = weight[:, columns[0]], values[:, columns].reshape(len(values), -1)
        by_row, by_cell = _onto(row, n_rows, w), _onto(cell, n_cells, w)
        count = np.asarray((by_row @ in_cell.T).todense())
        n = np.maximum(count.sum(axis=0), TINY)
        normal = np.diag(count.sum(axis=1)) - (count / n) @ count.T
        normal += max(RIDGE * count.sum() / n_rows, TINY) * np.eye(n_rows)
        sums = by_cell @ y
        b = np.linalg.solve(normal, by_row @ y - (count / n) @ sums)
        means = (sums - count.T @ b) / n[:, None]
        offsets[:, columns] = b.reshape(n_rows, len(columns), 3)
        y -= means[cell]
        y -= b[row]
        rest[:, columns] = y.reshape(len(y), len(columns), 3)
    return offsets, rest


def _alike(weight: FloatArray) -> list[list[int]]:
    """Return the columns grouped by equal content, in order."""
    groups: dict[bytes, list[int]] = {}
    for index, column in enumerate(np.ascontiguousarray(weight.T)):
        groups.setdefault(column.tobytes(), []).append(index)
    return list(groups.values())


def _down(rest: FloatArray, weight: FloatArray) -> FloatArray:
    """Return Geman-McClure weights of the half phones, by the rms of what is left of their seen markers."""
    seen = weight > 0
    far = np.sqrt(((rest**2).sum(axis=2) * seen).sum(axis=1) / np.maximum(seen.sum(axis=1), 1))
    usual = np.median(far[far > 0]) if (far > 0).any() else 1.0
    return np.asarray(1.0 / (1.0 + (far / (DOUBT * usual)) ** 2) ** 2)


def _trust(residual: FloatArray, weight: FloatArray, row: IntArray, n_rows: int) -> FloatArray:
    """Return which share of each offset is constant (n_rows, n_markers).

    The first half of a recording and its second are two measurements of one offset: over all markers, what
    they share estimates its square; over all recordings, how they differ the noise of a mean of n frames.
    """
    total = _sums(weight, row, n_rows)
    start = np.concatenate([np.zeros((1, weight.shape[1])), np.cumsum(total, axis=0)[:-1]])
    early = np.cumsum(weight, axis=0) - weight - start[row] < 0.5 * total[row]
    (n1, first), (n2, second) = (_mean(residual, weight * part, row, n_rows) for part in (early, ~early))
    both = (n1 > 0) & (n2 > 0)
    of_one = ((first - second) ** 2).sum(axis=2) * both * n1 * n2 / np.maximum(n1 + n2, TINY)
    noise = of_one.sum(axis=0) / np.maximum(both.sum(axis=0), 1) / np.maximum(total, TINY)
    shared = np.maximum(((first * second).sum(axis=2) * both).sum(axis=1), 0.0)
    doubted = (noise * both).sum(axis=1)
    share = shared / np.maximum(shared + doubted, TINY)
    return np.where(total > 0, share[:, None], 0.0)


def _mean(
    values: FloatArray, weight: FloatArray, row: IntArray, n_rows: int
) -> tuple[FloatArray, FloatArray]:
    n = _sums(weight, row, n_rows)
    return n, _sums(weight[..., None] * values, row, n_rows) / np.maximum(n, TINY)[..., None]


def _sums(values: FloatArray, row: IntArray, n_rows: int) -> FloatArray:
    flat = _onto(row, n_rows, np.ones(len(row))) @ values.reshape(len(values), -1)
    return np.asarray(flat).reshape(n_rows, *values.shape[1:])
