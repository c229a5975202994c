"""Which filler serves gaps of a length best, and how wide its band must be: tried on what was seen."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from corpus_tools.cleaning.face_model import FaceModel, face_model
from corpus_tools.cleaning.fillers import GAP_FILLERS, others_tell
from corpus_tools.cleaning.gaps import frame_ranges
from corpus_tools.core import BoolArray, Capture, FloatArray, IntArray, frozen

__all__ = ["REHEARSED", "Rehearsals", "Trial", "length_class", "rehearse"]

REHEARSED = ("pca-gp", "gp", "dct")
"""Fillers that are tried, the first where they are alike."""

N_TRIALS = 24
"""Stretches that are hidden per length of gap (our choice: the error of each filler to about a fifth)."""

QUANTILE, NORMAL = 0.9, 1.645
"""The band is scaled so that this share of the errors lies within so many standard deviations."""

FOLDS = 5
"""Parts of the corpus; what is hidden in one is filled with a model of the face that the others gave."""

MARGIN = 8
"""Frames that must be there before and behind a stretch."""


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """How one filler did on stretches of one length.

    Attributes
    ----------
    errors_mm : (n_stretches,) mm
        Root mean square of the 3-D error of each stretch; NaN where the filler could not say.
    widen : float
        Factor for the standard deviations it gives, so that the band holds what it says.
    """

    errors_mm: FloatArray
    widen: float

    @property
    def rms_mm(self) -> float:
        """Root mean square of the error over all stretches, mm."""
        return float(np.sqrt(np.nanmean(self.errors_mm**2)))

    def beats(self, other: Trial) -> bool:
        """Return whether its errors on the same stretches are smaller beyond doubt, by two standard errors.

        Of their logarithms: one stretch that went wrong decides nothing.
        """
        n = min(len(self.errors_mm), len(other.errors_mm))
        ours, theirs = (np.log(np.maximum(t.errors_mm[:n], 1e-9)) for t in (self, other))
        gain = theirs - ours
        gain = gain[np.isfinite(gain)]
        return len(gain) > 2 and bool(gain.mean() > 2.0 * gain.std(ddof=1) / np.sqrt(len(gain)))


@dataclass(frozen=True, slots=True)
class Rehearsals:
    """What was found: by length class (frames), whether other markers are seen, and filler."""

    trials: dict[tuple[int, bool, str], Trial] = field(default_factory=dict)

    def best(self, n_frames: int, others: bool) -> str:
        """Return the filler for a length: the first of :data:`REHEARSED` unless another beats it."""
        length = length_class(n_frames)
        known = [(m, t) for m in REHEARSED if (t := self.trials.get((length, others, m)))]
        if not known:
            return REHEARSED[0]
        first, usual = known[0]
        better = [(trial.rms_mm, m) for m, trial in known[1:] if trial.beats(usual)]
        return min(better)[1] if better else first

    def widen(self, n_frames: int, others: bool, method: str) -> float:
        """Return the factor for the band of a filler at a length; 1 if untried."""
        trial = self.trials.get((length_class(n_frames), others, method))
        return trial.widen if trial else 1.0


def length_class(n_frames: int) -> int:
    """Return the length, of 3, 6, 12, 24, ... frames, that stands for gaps of `n_frames`."""
    return int(3 * 2 ** max(0, round(float(np.log2(n_frames / 3.0)))))


def _wanted(captures: Sequence[Capture]) -> dict[tuple[int, bool], list[int]]:
    """Return for each length class, with and without others, the markers that have such gaps."""
    found: dict[tuple[int, bool], list[int]] = {}
    for capture in captures:
        seen = np.asarray(np.isfinite(capture.positions_mm).all(axis=2))
        for marker in np.flatnonzero(~seen.all(axis=0) & seen.any(axis=0)):
            for gap in frame_ranges(~seen[:, marker]):
                key = length_class(gap[1] - gap[0] + 1), others_tell(seen, gap)
                found.setdefault(key, []).append(int(marker))
    return found


def _stretches(
    seen: Sequence[BoolArray], length: int, markers: Sequence[int], rng: np.random.Generator, n: int
) -> list[tuple[int, int, int]]:
    """Return (recording, first frame, marker) of stretches that are seen with a margin, at random."""
    found: list[tuple[int, int, int]] = []
    fit = [i for i, s in enumerate(seen) if len(s) >= length + 2 * MARGIN]
    for _ in range(20 * n if fit else 0):
        recording = fit[int(rng.integers(len(fit)))]
        first = int(rng.integers(MARGIN, len(seen[recording]) - length - MARGIN + 1))
        marker = int(markers[int(rng.integers(len(markers)))])
        if seen[recording][first - MARGIN : first + length + MARGIN, marker].all():
            found.append((recording, first, marker))
        if len(found) == n:
            break
    return found


def _models(captures: Sequence[Capture], model: FaceModel | None) -> list[FaceModel | None]:
    """Return a model for each fifth of all frames that was learned without it."""
    if model is None:
        return [None] * FOLDS
    edges = np.linspace(0, sum(c.n_frames for c in captures), FOLDS + 1).astype(int)
    n = len(model.variances)
    return [face_model(captures, n, slice(int(a), int(b))) or model for a, b in pairwise(edges)]


def _errors(
    positions: FloatArray,
    rate_hz: float,
    gap: tuple[int, int],
    hidden: IntArray,
    model: FaceModel | None,
    method: str,
) -> tuple[FloatArray, FloatArray]:
    """Return errors (n_frames, 3) mm of the first hidden marker, and the band it was given (n_frames,)."""
    rows = slice(gap[0], gap[1] + 1)
    hole = positions.copy()
    truth = hole[rows, hidden[0]].copy()
    hole[rows, hidden] = np.nan
    values, sd = GAP_FILLERS[method](hole, rate_hz, gap, hidden[:1], model)
    return values[:, 0] - truth, sd[:, 0]


def _trial(errors: Sequence[tuple[FloatArray, FloatArray]]) -> Trial | None:
    said = [(e, sd) for e, sd in errors if np.isfinite(e).all()]
    if not said:
        return None
    rms = np.array([np.sqrt((e**2).sum(axis=1).mean()) for e, _ in errors])
    far = np.concatenate([(np.abs(e) / np.maximum(sd, 1e-9)[:, None]).ravel() for e, sd in said])
    level = min(QUANTILE * (2 * len(said) + 1) / (2 * len(said)), 1.0)
    return Trial(frozen(rms), float(np.clip(np.quantile(far, level) / NORMAL, 0.5, 5.0)))


def rehearse(
    captures: Sequence[Capture],
    model: FaceModel | None,
    methods: Sequence[str] = REHEARSED,
    *,
    n_trials: int = N_TRIALS,
    progress: Callable[[float, str], None] | None = None,
) -> Rehearsals:
    """Hide stretches that were seen, as long as the gaps are and of the same markers, and fill them.

    The error of each filler is then known at each length, and so is how wide its band must be: motion may
    begin in a gap and nothing beside it tell so, which no model of the neighbourhood accounts for. The band
    is scaled to hold 90 % of the errors, and some more because few stretches have seen less than there is: as
    in split conformal prediction (Vovk 2005), a stretch counted as two observations (our choice). The same
    gaps give the same stretches.

    Parameters
    ----------
    captures : sequence of Capture
        Head-stabilised, not filled.
    model : FaceModel or None
    methods : sequence of str
        Of the fillers.
    n_trials : int
        Stretches per length; half as many for fillers other than the first.
    progress : callable, optional
        ``progress(fraction, what)``; may raise to cancel.
    """
    report = progress or (lambda fraction, what: None)
    seen = [np.asarray(np.isfinite(c.positions_mm).all(axis=2)) for c in captures]
    starts = np.cumsum([0, *(c.n_frames for c in captures)])
    models: list[FaceModel | None] = []
    wanted = sorted(_wanted(captures).items())
    trials: dict[tuple[int, bool, str], Trial] = {}
    for index, ((length, others), markers) in enumerate(wanted):
        report(index / len(wanted), "rehearsing gaps")
        rng = np.random.default_rng(length)
        spots = _stretches(seen, length, markers, rng, n_trials)
        if others and not models:
            models = _models(captures, model)
        for method in methods if others else [m for m in methods if m != "pca-gp"]:
            errors = []
            for recording, first, marker in spots if method == methods[0] else spots[: n_trials // 2]:
                capture, gap = captures[recording], (first, first + length - 1)
                rest = [] if others else [m for m in range(len(capture.names)) if m != marker]
                hidden, positions = np.array([marker, *rest]), np.asarray(capture.positions_mm)
                fold = int(FOLDS * (starts[recording] + first) / starts[-1])
                left_out = models[fold] if others else None
                errors.append(_errors(positions, capture.rate_hz, gap, hidden, left_out, method))
            if trial := _trial(errors):
                trials[length, others, method] = trial
    return Rehearsals(trials)
