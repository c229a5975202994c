"""Frames across an utterance with the paths of lip and jaw vertices (paper A figure 5)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from corpus_tools.config import ConfigBase
from corpus_tools.core import FloatArray, Interval, Mesh, MeshError
from corpus_tools.core.capture import region_of
from corpus_tools.pipeline import Head, Progress, Synthesis
from corpus_tools.render.drawing import Drawing
from corpus_tools.render.moving import MovingHead, poses_at

__all__ = ["chosen_phones", "strip_drawing", "tracked_vertices", "write_strip"]

WIDTH, LEFT, RIGHT = 1400.0, 74.0, 20.0
GAP = 8.0
PLOT_HEIGHT, LANE_HEIGHT = 130.0, 24.0
ZOOM_MM = 104.0
PATH_S = 0.12
"""How much of a path is drawn over a frame, before and after its time (our choice: about a syllable)."""
COLOURS = {"upper lip": "#1f6feb", "lower lip": "#d1242f", "chin": "#1a7f37", "corner": "#8250df"}
PANELS = (("up (mm)", 1), ("forward (mm)", 2))


def tracked_vertices(mesh: Mesh) -> dict[str, int]:
    """Return the vertices whose paths are shown: both lips in the middle, the chin, the left corner.

    Raises
    ------
    MeshError
        The mesh has no markers on the outer lips or the chin.
    """
    lips = {n: v for n, v in mesh.markers.items() if region_of(n) == "lip_out"}
    chin = {n: v for n, v in mesh.markers.items() if region_of(n) == "chin"}
    if len(lips) < 4 or not chin:
        raise MeshError(
            f"The mesh '{mesh.name}' has {len(lips)} markers on the outer lips and {len(chin)} on the chin; "
            "the strip needs 4 and 1 to draw their paths."
        )
    at = {v: mesh.vertices_mm[v] for v in (*lips.values(), *chin.values())}
    middle = sorted(lips.values(), key=lambda v: abs(at[v][0]))[:2]
    upper, lower = sorted(middle, key=lambda v: -at[v][1])
    return {
        "upper lip": upper,
        "lower lip": lower,
        "chin": min(chin.values(), key=lambda v: at[v][1]),
        "corner": max(lips.values(), key=lambda v: at[v][0]),
    }


def chosen_phones(
    phones: Sequence[Interval], n: int, silence: str, apertures_mm: Callable[[float], float]
) -> list[Interval]:
    """Return `n` phones across the spoken time, in order; fewer when fewer are spoken.

    The spoken time is cut into `n` equal parts. Of the phones whose centre lies in a part the one is taken
    whose mouth is most unlike the median of the sentence, so that closures and open vowels are shown; a part
    without any gives none.

    Parameters
    ----------
    phones : sequence of Interval
    n : int
    silence : str
        Label of what is not spoken.
    apertures_mm : callable
        ``apertures_mm(time_s)``: how far the mouth is open.
    """
    spoken = [p for p in phones if p.text != silence] or list(phones)
    opening = np.array([apertures_mm(p.centre_s) for p in spoken])
    unlike = np.abs(opening - np.median(opening))
    edges = np.linspace(spoken[0].start_s, spoken[-1].end_s, n + 1)
    part = np.clip(np.searchsorted(edges, [p.centre_s for p in spoken], side="right") - 1, 0, n - 1)
    found = [max(np.flatnonzero(part == k), key=lambda i: unlike[i]) for k in range(n) if (part == k).any()]
    return [spoken[i] for i in found]


def write_strip(
    folder: Path, synthesis: Synthesis, head: Head, config: ConfigBase, progress: Progress
) -> dict[str, Any]:
    """Write ``strip.svg`` and ``strip.png``.

    Parameters
    ----------
    folder : Path
    synthesis, head, config
        Section `film`: the view, the zoom, and how many poses.
    progress : callable
        ``progress(fraction, what)``; may raise to cancel.

    Returns
    -------
    dict
        File, and the phones and times of the poses.
    """
    lips = head.mesh.lip_pairs
    opening = (synthesis.vertices_mm[:, lips[:, 0], 1] - synthesis.vertices_mm[:, lips[:, 1], 1]).mean(axis=1)
    phones = chosen_phones(
        synthesis.utterance.phones.intervals,
        config.film.strip_frames,
        _silence(synthesis),
        lambda time: float(np.interp(time, synthesis.trajectory.times_s, opening)),
    )
    drawing = strip_drawing(synthesis, head, config, phones, progress)
    (folder / "strip.svg").write_text(drawing.svg(), encoding="utf-8")
    (folder / "strip.png").write_bytes(drawing.png())
    shown = [{"phone": p.text, "time_s": round(p.centre_s, 6)} for p in phones]
    return {"file": "strip.svg", "poses": shown}


def _silence(synthesis: Synthesis) -> str:
    """Return the label of silence: what the utterance begins with (an utterance starts and ends at rest)."""
    first, *_, last = synthesis.utterance.labels
    return first if first == last else ""


def strip_drawing(
    synthesis: Synthesis, head: Head, config: ConfigBase, phones: Sequence[Interval], progress: Progress
) -> Drawing:
    """Return the figure: a row of frames with paths over them, the phones, and the paths against time."""
    tracked = tracked_vertices(head.mesh)
    n = len(phones)
    cell = (WIDTH - LEFT - RIGHT - GAP * (n - 1)) / n
    side = min(cell, 260.0)
    top = 12.0
    lane = top + side + 66.0
    height = lane + LANE_HEIGHT + len(PANELS) * (PLOT_HEIGHT + 16.0) + 62.0
    drawing = Drawing(WIDTH, height, f"Frames and vertex trajectories of '{synthesis.utterance.name}'")
    times = np.asarray(synthesis.trajectory.times_s)
    axis = _Axis(float(times[0]), float(times[-1]))
    lefts = [LEFT + k * (cell + GAP) + 0.5 * (cell - side) for k in range(n)]
    _frames(drawing, synthesis, head, config, phones, lefts, side, top, progress)
    for phone, left in zip(phones, lefts, strict=True):
        middle = left + 0.5 * side
        drawing.text(middle, top + side + 14, f"{phone.text}   {phone.centre_s:.2f} s", 15)
        here = axis.x(phone.centre_s)
        bottom = lane + LANE_HEIGHT + len(PANELS) * (PLOT_HEIGHT + 16.0)
        drawing.line([(middle, top + side + 26), (here, lane - 2)], "#8c959f", 1, dashed=True)
        drawing.line([(here, lane + LANE_HEIGHT + 2), (here, bottom)], "#8c959f", 1, dashed=True)
    _lane(drawing, synthesis.utterance.phones.intervals, axis, lane)
    for k, (label, column) in enumerate(PANELS):
        paths = {
            name: synthesis.vertices_mm[:, v, column] - head.mesh.vertices_mm[v, column]
            for name, v in tracked.items()
        }
        y = lane + LANE_HEIGHT + 8 + k * (PLOT_HEIGHT + 16.0)
        _panel(drawing, axis, times, paths, label, y, last=k == len(PANELS) - 1)
    _legend(drawing, height - 14)
    return drawing


class _Axis:
    """Time along the width of the figure."""

    def __init__(self, first_s: float, last_s: float) -> None:
        self.first_s, self.last_s = first_s, last_s

    def x(self, time_s: Any) -> Any:
        share = (np.asarray(time_s) - self.first_s) / (self.last_s - self.first_s)
        return LEFT + share * (WIDTH - LEFT - RIGHT)


def _frames(
    drawing: Drawing,
    synthesis: Synthesis,
    head: Head,
    config: ConfigBase,
    phones: Sequence[Interval],
    lefts: Sequence[float],
    side: float,
    top: float,
    progress: Progress,
) -> None:
    pixels = 2 * round(side)
    times = np.asarray(synthesis.trajectory.times_s)
    options = {"view": config.film.view, "zoom_mm": config.film.zoom_mm or ZOOM_MM}
    poses = poses_at(times, synthesis.vertices_mm, [p.centre_s for p in phones])
    with MovingHead(head.mesh, poses, size=(pixels, pixels), **options) as moving:
        for k, (phone, pose, left) in enumerate(zip(phones, poses, lefts, strict=True)):
            progress(k / len(phones), f"strip, pose {k + 1} of {len(phones)}")
            drawing.picture(left, top, side, side, moving.draw(pose))
            near = np.abs(times - phone.centre_s) <= PATH_S
            for name, vertex in tracked_vertices(head.mesh).items():
                path = moving.on_screen(synthesis.vertices_mm[near, vertex]) * side / pixels + (left, top)
                drawing.line(path, "#ffffff", 3.6)
                drawing.line(path, COLOURS[name], 2.0)
                here = moving.on_screen(pose[vertex])[0] * side / pixels + (left, top)
                drawing.line(_ring(here, 3.2), COLOURS[name], 1.8)


def _ring(centre: FloatArray, radius: float) -> FloatArray:
    angle = np.linspace(0, 2 * np.pi, 25)
    return np.asarray(centre + radius * np.column_stack([np.cos(angle), np.sin(angle)]))


def _lane(drawing: Drawing, phones: Sequence[Interval], axis: _Axis, y: float) -> None:
    """Draw the phones with their boundaries."""
    first, last = axis.x(axis.first_s), axis.x(axis.last_s)
    for level in (y, y + LANE_HEIGHT):
        drawing.line([(first, level), (last, level)], "#57606a", 0.8)
    for phone in phones:
        a, b = np.clip(axis.x([phone.start_s, phone.end_s]), first, last)
        drawing.line([(a, y), (a, y + LANE_HEIGHT)], "#57606a", 0.8)
        if b - a > 7.0 * len(phone.text):
            drawing.text(0.5 * (a + b), y + 0.5 * LANE_HEIGHT, phone.text, 12)
    drawing.line([(last, y), (last, y + LANE_HEIGHT)], "#57606a", 0.8)
    drawing.text(LEFT - 8, y + 0.5 * LANE_HEIGHT, "phones", 13, anchor="right")


def _ticks(low: float, high: float, most: int) -> FloatArray:
    """Return round numbers inside [low, high], at most `most` of them."""
    least = (high - low) / most
    size = 10.0 ** np.floor(np.log10(least))
    step = next(size * k for k in (1, 2, 5, 10) if size * k >= least * (1 - 1e-9))
    return np.asarray(np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1) * step + 0.0)


def _panel(
    drawing: Drawing,
    axis: _Axis,
    times: FloatArray,
    paths: dict[str, FloatArray],
    label: str,
    top: float,
    last: bool,
) -> None:
    """Draw displacements against time, with both axes."""
    every = np.concatenate(list(paths.values()))
    low, high = float(every.min()), float(every.max())
    pad = 0.06 * max(high - low, 1.0)
    low, high = low - pad, high + pad

    def y(value: Any) -> Any:
        return top + PLOT_HEIGHT * (high - np.asarray(value)) / (high - low)

    first, end = axis.x(axis.first_s), axis.x(axis.last_s)
    for tick in _ticks(low, high, 5):
        drawing.line([(first, y(tick)), (end, y(tick))], "#d0d7de" if tick else "#8c959f", 0.7)
        drawing.text(LEFT - 8, float(y(tick)), f"{tick:g}", 12, anchor="right")
    drawing.line(
        [(first, top), (end, top), (end, top + PLOT_HEIGHT), (first, top + PLOT_HEIGHT), (first, top)],
        width=0.9,
    )
    drawing.text(22, top + 0.5 * PLOT_HEIGHT, label, 13, upright=True)
    for name, path in paths.items():
        drawing.line(np.column_stack([axis.x(times), y(path)]), COLOURS[name], 1.7)
    if last:
        for tick in _ticks(axis.first_s, axis.last_s, 12):
            at = axis.x(tick)
            drawing.line([(at, top + PLOT_HEIGHT), (at, top + PLOT_HEIGHT + 5)], width=0.9)
            drawing.text(float(at), top + PLOT_HEIGHT + 15, f"{tick:g}", 12)
        drawing.text(0.5 * (first + end), top + PLOT_HEIGHT + 32, "time (s)", 13)


def _legend(drawing: Drawing, y: float) -> None:
    x = LEFT
    for name, colour in COLOURS.items():
        drawing.line([(x, y), (x + 24, y)], colour, 2.4)
        drawing.text(x + 30, y, name, 13, anchor="left")
        x += 56 + 8 * len(name)
