"""What a corpus lacks, what can be done without, and which lines of corpus.toml would mend it."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from corpus_tools.core import Capture, CorpusError, counted
from corpus_tools.core.errors import suggestion
from corpus_tools.io import CorpusDescription, parsed_axes

__all__ = ["axes_advice", "offset_advice", "what_is_lacking", "what_is_left_out"]

OFFSET_LIMIT_FRAMES, OFFSET_LIMIT_S = 0.35, 0.005
"""Closure offset from which a change is advised; both must be reached (our choice: frames that are taken for
their start but stand for their middle come half a frame early; the offset itself is found to some ms)."""

_AS_THEY_ARE = "x,y,z"


def axes_advice(description: CorpusDescription, captures: Sequence[Capture]) -> list[str]:
    """Return the line for corpus.toml when the motion files say that another axis than y is up."""
    steps = [dict(c.history[0].settings) for c in captures if c.history and c.history[0].name == "read"]
    said = {(s["right"], s["up"]) for s in steps if "right" in s and "up" in s}
    if description.marker_axes != _AS_THEY_ARE or len(said) != 1:
        return []
    right, up = said.pop()
    for out in ("x", "y", "z", "-x", "-y", "-z"):
        axes = f"{right},{up},{out}"
        try:
            parsed_axes(axes, "")  # only the one that is left, with the sign that mirrors nothing, is right
        except CorpusError:
            continue
        return [] if axes == _AS_THEY_ARE else [f'marker_axes = "{axes}"']
    return []


def offset_advice(description: CorpusDescription, offset_s: float | None, rate_hz: float) -> list[str]:
    """Return the line for corpus.toml that brings the closures to the bilabials, when one is needed.

    Half a frame too early is what frames do that are taken for their start and stand for their middle.

    Parameters
    ----------
    description : CorpusDescription
    offset_s : float or None
        From :func:`~corpus_tools.speech.closure_offset`, s.
    rate_hz : float
        Of the captures, Hz.
    """
    if offset_s is None or abs(offset_s) < max(OFFSET_LIMIT_FRAMES / rate_hz, OFFSET_LIMIT_S):
        return []
    if description.frame_time == "start" and abs(offset_s - 0.5 / rate_hz) < 0.25 / rate_hz:
        return ['frame_time = "centre"']
    return [f"audio_offset_s = {description.audio_offset_s + offset_s:.3f}"]


def what_is_left_out(description: CorpusDescription, ids: Collection[str]) -> list[str]:
    """Say how many recordings 'exclude' leaves out, and which of its names stand for none."""
    left_out = set(description.exclude) & set(ids)
    told = []
    if left_out:
        all_of_them = counted(len(ids), "recording")
        told.append(f"'exclude' in '{description.file}' leaves out {len(left_out)} of {all_of_them}.")
    for name in sorted(set(description.exclude) - left_out):
        hint = suggestion(name, ids) or "; give the names of recordings."
        told.append(f"'exclude' in '{description.file}' names '{name}', which is no recording{hint}")
    return told


def what_is_lacking(description: CorpusDescription) -> list[str]:
    """Say what a corpus without sound or labels can do, and how to give it the rest."""
    told = []
    if not description.labels:
        told.append(
            "No labels: its motion can be checked, but nothing can be synthesised from it; when there are "
            f"TextGrids with phones, name their pattern as 'labels' in '{description.file}'."
        )
    if not description.audio:
        told.append(
            "No sound: what is synthesised from it is silent; when there is any, name its pattern as 'audio' "
            f"in '{description.file}'."
        )
    return told
