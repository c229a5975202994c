"""The stages of a synthesis, each a plain call: select, align, blend, close; together or one by one."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from corpus_tools.config import ConfigBase
from corpus_tools.core import Fragment, InputError, Selection, Trajectory, UnitRef, Utterance
from corpus_tools.fragments import cut_fragment
from corpus_tools.methods import CONTEXT_S, SEARCHES
from corpus_tools.pipeline.head import Animation, Head, animate, vertex_frames
from corpus_tools.pipeline.opened import OpenCorpus
from corpus_tools.pipeline.overrides import overrides_of
from corpus_tools.pipeline.threads import one_thread
from corpus_tools.pipeline.usable import LEAST_RATE_HZ
from corpus_tools.synthesis import (
    AlignedPieces,
    AlignmentFacts,
    Contact,
    align_fragments,
    alignment_facts,
    blend_pieces,
    linked_utterance,
    lip_contacts,
    rest_at_ends,
)
from corpus_tools.synthesis.lips import make_contacts

__all__ = [
    "Synthesis",
    "align_units",
    "blend_units",
    "compare_alignments",
    "link_sound",
    "select_units",
    "synthesise",
]

MOST_BYTES = 2e9
"""Of the vertices of one synthesis (our choice: about 5 minutes of the bundled head at 120 frames/s)."""


@dataclass(frozen=True, slots=True, eq=False)
class Synthesis:
    """A whole result: what was chosen, the marker motion, the motion of the head, and how long it took.

    Attributes
    ----------
    utterance : Utterance
    selection : Selection
    trajectory : Trajectory
    contacts : tuple of Contact
        What the lips have to touch, and whether they do.
    animation : Animation
    vertices_mm : (n_frames, n_vertices, 3) float32, mm
    timings_ms : dict of stage -> ms
    """

    utterance: Utterance
    selection: Selection
    trajectory: Trajectory
    contacts: tuple[Contact, ...]
    animation: Animation
    vertices_mm: npt.NDArray[np.float32]
    timings_ms: dict[str, float]


@one_thread
def select_units(
    corpus: OpenCorpus,
    utterance: Utterance,
    config: ConfigBase,
    exclude: Iterable[str] = (),
    pins: Iterable[tuple[int, int, UnitRef]] = (),
    bans: Iterable[UnitRef | str] = (),
) -> Selection:
    """Choose the fragments that speak an utterance, by the method of the config.

    Parameters
    ----------
    corpus : OpenCorpus
    utterance : Utterance
    config : config
        Sections `selection` and `overrides`.
    exclude : iterable of str
        Recordings kept out of the inventory: the held-out sentence itself.
    pins : iterable of (first, last, unit)
        Units that must speak the target phones `first` to `last`, beside those of the config.
    bans : iterable of UnitRef or recording id
        Units, or whole recordings, that must not be used, beside those of the config.

    Raises
    ------
    InputError
        There is no such method, or a pin or a ban does not fit the utterance or the corpus.
    NoUnitError
        A diphone is covered by nothing, not even by backoff.
    """
    weights = config.selection.model_dump(exclude={"method", "components", "allow_backoff"})
    search = SEARCHES[config.selection.method]
    if config.selection.method == "greedy":
        weights.pop("prune")
    pinned, banned = overrides_of(config)
    return search(
        corpus.model,
        utterance,
        exclude=tuple(exclude),
        pins=(*pinned, *pins),
        bans=(*banned, *bans),
        allow_backoff=config.selection.allow_backoff,
        **weights,
    )


def link_sound(
    corpus: OpenCorpus, utterance: Utterance, selection: Selection, config: ConfigBase
) -> Utterance:
    """Return the target as it is, or on the clock of its units with their sound (`speech.sound` = "units").

    Raises
    ------
    InputError
        A chosen recording has no sound, or two differ in their rate.
    """
    if config.speech.sound == "voice":
        return utterance
    return linked_utterance(utterance, selection, corpus.inventory)


def _check_rate(rate_hz: float) -> None:
    if rate_hz < LEAST_RATE_HZ:
        raise InputError(
            f"alignment.rate_hz (--fps) is {rate_hz:g}: at least {LEAST_RATE_HZ:g} frames per second are "
            "needed, or phones fall between the frames."
        )


def _fragments(corpus: OpenCorpus, selection: Selection) -> list[Fragment]:
    return [cut_fragment(corpus.inventory, c.unit, context_s=CONTEXT_S) for c in selection.chosen]


@one_thread
def compare_alignments(
    corpus: OpenCorpus, utterance: Utterance, selection: Selection, config: ConfigBase
) -> AlignmentFacts:
    """Align the chosen fragments by both warps and both ways of resampling, and say how they differ."""
    _check_rate(config.alignment.rate_hz)
    return alignment_facts(
        selection,
        utterance,
        _fragments(corpus, selection),
        names=corpus.markers,
        natural=corpus.natural,
        silence=corpus.phones.silence,
        rate_hz=config.alignment.rate_hz,
        c=config.alignment.shape_c,
    )


@one_thread
def align_units(
    corpus: OpenCorpus, utterance: Utterance, selection: Selection, config: ConfigBase
) -> AlignedPieces:
    """Cut, warp and resample the chosen fragments; g(u) and the overlap do not matter yet."""
    _check_rate(config.alignment.rate_hz)
    return align_fragments(
        selection,
        utterance,
        _fragments(corpus, selection),
        names=corpus.markers,
        rate_hz=config.alignment.rate_hz,
        warp=config.alignment.warp,
        resampling=config.alignment.resampling,
        c=config.alignment.shape_c,
        silence=corpus.phones.silence,
    )


@one_thread
def blend_units(
    corpus: OpenCorpus, utterance: Utterance, pieces: AlignedPieces, config: ConfigBase
) -> Trajectory:
    """Blend aligned fragments, close the lips, rest at the ends: the quick part that a slider calls."""
    settings = config.blend.model_dump()
    blended = blend_pieces(pieces, **settings, classes=corpus.phones.display_classes, natural=corpus.natural)
    if config.closure.project:
        closure = config.closure
        blended = make_contacts(
            corpus.lips,
            blended,
            utterance,
            corpus.phones,
            closure.iterations,
            closure.hold_s,
            closure.on_teeth,
        )
    return rest_at_ends(
        blended,
        utterance.phones.intervals,
        neutral_mm=corpus.neutral_mm,
        silence=corpus.phones.silence,
        ease_s=config.rest.ease_s,
    )


def _check_size(utterance: Utterance, rate_hz: float, head: Head) -> None:
    """Refuse before the work what would not fit: all vertices of all frames are held at once."""
    _check_rate(rate_hz)
    length_s, per_s = utterance.duration_s, 12.0 * rate_hz * head.mesh.n_vertices
    if length_s * per_s > MOST_BYTES:
        raise InputError(
            f"'{utterance.name}' lasts {length_s:.0f} s with its silences and its sound, which makes "
            f"{length_s * per_s / 1e9:.0f} GB of vertices on the mesh '{head.mesh.name}'; speak at most "
            f"{MOST_BYTES / per_s:.0f} s at a time, or lower --fps."
        )


def synthesise(
    corpus: OpenCorpus,
    utterance: Utterance,
    config: ConfigBase,
    head: Head,
    exclude: Iterable[str] = (),
) -> Synthesis:
    """Run every stage from timed phones to moving vertices (paper A figure 1)."""
    timings: dict[str, float] = {}
    clock = time.perf_counter()

    def lap(stage: str) -> None:
        nonlocal clock
        now = time.perf_counter()
        timings[stage], clock = 1000 * (now - clock), now

    _check_size(utterance, config.alignment.rate_hz, head)
    selection = select_units(corpus, utterance, config, exclude)
    utterance = link_sound(corpus, utterance, selection, config)
    lap("select")
    pieces = align_units(corpus, utterance, selection, config)
    lap("align")
    trajectory = blend_units(corpus, utterance, pieces, config)
    lap("blend")
    contacts = lip_contacts(corpus.lips, trajectory, utterance, corpus.phones)
    animation = animate(head, trajectory)
    lap("retarget")
    vertices = vertex_frames(head, animation)
    lap("deform")
    timings["total"] = sum(timings.values())
    return Synthesis(utterance, selection, trajectory, contacts, animation, vertices, timings)
