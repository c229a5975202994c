"""What a benchmark is: a function of the ground it measures on, giving rows; entered by topic."""

from __future__ import annotations

import functools
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from corpus_tools.config import Config, ConfigBase
from corpus_tools.core import Interval, Registry, Selection, Tier, Trajectory, Utterance
from corpus_tools.pipeline import (
    Animation,
    Head,
    OpenCorpus,
    align_units,
    animate,
    blend_units,
    prepare_head,
    select_units,
)
from corpus_tools.synthesis import AlignedPieces

__all__ = ["BENCHMARKS", "TARGET_S", "Ground", "Row"]

TARGET_S = 2.5
"""Length of the utterance that the bars speak of."""


@dataclass(frozen=True, slots=True)
class Row:
    """One figure beside its bar and its peer.

    Attributes
    ----------
    what : str
        What was measured, sizes included.
    measured : float
    unit : str
        "ms", "frames/s", "mm", ...
    bar : float, optional
        In the same unit; None where nothing was promised.
    at_least : bool
        The figure must be at least the bar; else at most.
    peer : str
        What it was compared with in the same run; empty without.
    peer_measured : float, optional
        In the same unit.
    least_ratio : float, optional
        How many times better than the peer it has to be.
    note : str
        What a reader must know, such as a peer measured on a part of the size.
    """

    what: str
    measured: float
    unit: str = "ms"
    bar: float | None = None
    at_least: bool = False
    peer: str = ""
    peer_measured: float | None = None
    least_ratio: float | None = None
    note: str = ""

    @property
    def ratio(self) -> float | None:
        """How many times better than the peer; None without one."""
        if self.peer_measured is None:
            return None
        ours, theirs = max(self.measured, 1e-12), max(self.peer_measured, 1e-12)
        return ours / theirs if self.at_least else theirs / ours

    @property
    def met(self) -> bool | None:
        """Whether every bar of the row is met; None where there is none."""
        held = []
        if self.bar is not None:
            held.append(self.measured >= self.bar if self.at_least else self.measured <= self.bar)
        if self.least_ratio is not None:
            held.append(self.ratio is not None and self.ratio >= self.least_ratio)
        return all(held) if held else None

    def as_dict(self) -> dict[str, Any]:
        """Return the row for JSON, without what does not apply."""
        row: dict[str, Any] = {"what": self.what, "measured": _short(self.measured), "unit": self.unit}
        if self.bar is not None:
            row |= {"bar": self.bar, "at_least": self.at_least}
        if self.ratio is not None and self.peer_measured is not None:
            row |= {
                "peer": self.peer,
                "peer_measured": _short(self.peer_measured),
                "ratio": _short(self.ratio),
            }
        if self.least_ratio is not None:
            row["least_ratio"] = self.least_ratio
        if self.note:
            row["note"] = self.note
        return row | {"met": self.met}


def _short(value: float) -> float:
    return float(f"{value:.4g}")


class Ground:
    """What the benchmarks measure on: an opened corpus, a bound head, one utterance held out.

    Parameters
    ----------
    corpus : OpenCorpus
    full : bool
        The large sizes and the slow peers too; takes minutes.
    config : config, optional
        The defaults when None.
    repeats : int
        Runs of each measurement, of which the best counts.
    scale : float
        Share of the sizes of a real measurement; less than 1 only to try out whether a topic works.
    """

    def __init__(
        self,
        corpus: OpenCorpus,
        full: bool = False,
        config: ConfigBase | None = None,
        repeats: int = 3,
        scale: float = 1.0,
    ) -> None:
        self.corpus = corpus
        self.full = full
        self.config = config or Config()
        self.repeats = repeats
        self.scale = scale

    def best_ms(self, call: Callable[[], Any]) -> float:
        """Return the shortest run of `call` in ms, after one warm-up."""
        call()
        times = []
        for _ in range(self.repeats):
            start = time.perf_counter()
            call()
            times.append(1000 * (time.perf_counter() - start))
        return min(times)

    @functools.cached_property
    def head(self) -> Head:
        """The bundled head, bound to the corpus."""
        return prepare_head(self.corpus, "base", self.config)

    @functools.cached_property
    def longest(self) -> Utterance:
        """The longest sentence of the corpus."""
        return max((r.utterance for r in self.corpus.recordings), key=lambda u: u.duration_s)

    @functools.cached_property
    def target(self) -> Utterance:
        """The first 2.5 s of the longest sentence."""
        spoken = [p for p in self.longest.phones if p.start_s < TARGET_S - 0.02]
        last = spoken[-1]
        phones = (*spoken[:-1], Interval(last.start_s, min(last.end_s, TARGET_S), last.text))
        return Utterance(self.longest.name, self.longest.text, Tier("phones", phones))

    @property
    def held_out(self) -> tuple[str, ...]:
        """The recording of the target, which must not speak it."""
        return (self.longest.name,)

    @functools.cached_property
    def selection(self) -> Selection:
        """The fragments chosen for the target."""
        return select_units(self.corpus, self.target, self.config, self.held_out)

    @functools.cached_property
    def pieces(self) -> AlignedPieces:
        """The fragments, aligned and resampled."""
        return align_units(self.corpus, self.target, self.selection, self.config)

    @functools.cached_property
    def trajectory(self) -> Trajectory:
        """The blended motion."""
        return blend_units(self.corpus, self.target, self.pieces, self.config)

    @functools.cached_property
    def animation(self) -> Animation:
        """The motion on the head."""
        return animate(self.head, self.trajectory)


BENCHMARKS: Registry[Callable[[Ground], list[Row]]] = Registry("benchmark")
