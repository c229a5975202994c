"""The stages behind the blend page, each computed again only when something it depends on has changed."""

from __future__ import annotations

import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from corpus_tools.config import ConfigBase
from corpus_tools.core import Audio, Selection, Trajectory, Utterance
from corpus_tools.pipeline import (
    Animation,
    Head,
    OpenCorpus,
    align_units,
    animate,
    blend_units,
    link_sound,
    prepare_head,
    select_units,
    speak_for,
)
from corpus_tools.synthesis import AlignedPieces

__all__ = ["Request", "Result", "Stages"]

T = TypeVar("T")


@dataclass(frozen=True, slots=True, eq=False)
class Request:
    """Everything a result depends on.

    Attributes
    ----------
    corpus : OpenCorpus
    sentence : str
        Recording whose sentence is spoken.
    config : config
    held_out : bool
        Keep the recording of the sentence out of the inventory.
    text : str
        Words that are spoken instead of a recording's sentence.
    """

    corpus: OpenCorpus
    sentence: str
    config: ConfigBase
    held_out: bool = True
    text: str = ""

    @property
    def exclude(self) -> tuple[str, ...]:
        """Recordings kept out of the inventory."""
        return (self.sentence,) if self.held_out and not self.text else ()

    def same_target(self, other: Request) -> bool:
        """Tell whether both speak the same sentence of the same corpus."""
        return self.corpus is other.corpus and (self.sentence, self.text) == (other.sentence, other.text)


@dataclass(frozen=True, slots=True, eq=False)
class Result:
    """What a request gave.

    Attributes
    ----------
    request : Request
    utterance : Utterance
    selection : Selection
    pieces : AlignedPieces
    trajectory : Trajectory
    head : Head
    animation : Animation
    ran : tuple of str
        Stages that were computed for this result; the others were still valid.
    elapsed_ms : float
        Time of the stages that ran.
    """

    request: Request
    utterance: Utterance
    selection: Selection
    pieces: AlignedPieces
    trajectory: Trajectory
    head: Head
    animation: Animation
    ran: tuple[str, ...]
    elapsed_ms: float

    @property
    def ratios(self) -> tuple[float, ...]:
        """Peak acceleration of each join over that of natural stretches (95th percentile), lips open."""
        return self.trajectory.peak_ratios

    @property
    def audio(self) -> Audio | None:
        """The sound that goes with the motion."""
        return self.utterance.audio


def _values(config: ConfigBase, *names: str) -> tuple[str, ...]:
    return tuple(getattr(config, n).model_dump_json() for n in names)


class Stages:
    """Keeps the last values of every stage, keyed by what they depend on.

    One object per session; :meth:`run` may be called from a worker thread. A change of g(u) runs `blend` and
    `animate` only; another mesh runs `head` and `animate`; another sentence runs everything but `head`.

    Parameters
    ----------
    keep : int
        Values kept per stage: going back to a setting just left costs nothing.
    """

    def __init__(self, keep: int = 4) -> None:
        self._keep = keep
        self._kept: dict[str, OrderedDict[Hashable, Any]] = {}
        self._lock = threading.Lock()

    def _stage(self, name: str, key: Hashable, make: Callable[[], T], ran: list[str]) -> T:
        kept = self._kept.setdefault(name, OrderedDict())
        if key in kept:
            kept.move_to_end(key)
            value: T = kept[key]
            return value
        value = make()
        ran.append(name)
        kept[key] = value
        while len(kept) > self._keep:
            kept.popitem(last=False)
        return value

    def run(self, request: Request, check: Callable[[], None] = lambda: None) -> Result:
        """Compute what is missing for a request.

        Parameters
        ----------
        request : Request
        check : callable
            Called between the stages; may raise to stop early.

        Raises
        ------
        WorkbenchError
            The sentence, method, mesh or a setting cannot be used; the message says which and why.
        """
        with self._lock:
            return self._run(request, check)

    def _run(self, request: Request, check: Callable[[], None]) -> Result:
        corpus, config = request.corpus, request.config
        ran: list[str] = []
        started = time.perf_counter()
        exclude = request.exclude
        utterance = self._target(request, ran)
        check()
        root = (corpus, request.sentence, request.text, *_values(config, "speech"), exclude)
        key = (*root, *_values(config, "selection", "overrides"))
        selection = self._stage("select", key, lambda: select_units(corpus, utterance, config, exclude), ran)
        said = utterance
        utterance = self._stage("link", key, lambda: link_sound(corpus, said, selection, config), [])
        check()
        key = (*key, *_values(config, "alignment"))
        pieces = self._stage("align", key, lambda: align_units(corpus, utterance, selection, config), ran)
        check()
        key = (*key, *_values(config, "blend", "closure", "rest"))
        trajectory = self._stage("blend", key, lambda: blend_units(corpus, utterance, pieces, config), ran)
        check()
        head_key = (corpus, *_values(config, "retarget", "deform"))
        head = self._stage("head", head_key, lambda: prepare_head(corpus, config.deform.mesh, config), ran)
        animation = self._stage("animate", (key, head_key), lambda: animate(head, trajectory), ran)
        elapsed_ms = 1000 * (time.perf_counter() - started)
        parts = (utterance, selection, pieces, trajectory, head, animation)
        return Result(request, *parts, tuple(ran), elapsed_ms)

    def on_head(self, result: Result, name: str) -> Result:
        """Return the same motion on another head.

        Parameters
        ----------
        result : Result
        name : str
            Of a bundled head, or a mesh file.

        Raises
        ------
        WorkbenchError
            The head cannot be used; the message says why.
        """
        corpus, config = result.request.corpus, result.request.config
        key = (corpus, *_values(config, "retarget", "deform"))
        with self._lock:
            head = self._stage(f"head {name}", key, lambda: prepare_head(corpus, name, config), [])
        return replace(result, head=head, animation=animate(head, result.trajectory))

    def recorded(self, result: Result) -> Result | None:
        """Return the result with the motion of the recording itself in place of the blend; None for a text.

        The cleaned capture of the sentence, in its own posture, moves the same head: what the blend is
        compared with.
        """
        request = result.request
        if request.text:
            return None
        capture = request.corpus.recorded(request.sentence)
        trajectory = Trajectory(
            capture.times_s, capture.positions_mm, capture.names, (), capture.flags, capture.history
        )
        animation = animate(result.head, trajectory)
        return replace(result, trajectory=trajectory, animation=animation)

    def _target(self, request: Request, ran: list[str]) -> Utterance:
        if not request.text:
            return request.corpus.utterance(request.sentence)
        key = (request.corpus, request.text, *_values(request.config, "speech"))
        return self._stage("speak", key, lambda: speak_for(request.corpus, request.text, request.config), ran)
