"""Motion of actors as plain data for the browser: each track sent once, whoever follows it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from corpus_tools.core import MeshError

__all__ = ["motion_data", "n_markers_of"]

Actors = Mapping[str, Mapping[str, Any]]
Tracks = Mapping[str, npt.ArrayLike] | None


def motion_data(
    actors: Actors,
    rate_hz: float,
    displacements: Tracks,
    rigid: Tracks,
    points: Tracks,
    start_s: float,
) -> dict[str, Any]:
    """Return motion as the browser takes it; parameters as of :meth:`MeshView.set_motion`.

    Actors that were given the same array share one track.

    Raises
    ------
    MeshError
        The numbers of an actor do not fit, or the actors differ in their number of frames.
    """
    kinds: list[tuple[str, Tracks, Callable[..., npt.NDArray[np.float32]]]] = [
        ("deform", displacements, _displacements),
        ("rigid", rigid, _matrices),
        ("points", points, _positions),
    ]
    tracks: list[dict[str, Any]] = []
    frames: set[int] = set()
    for kind, given, convert in kinds:
        shared: dict[int, dict[str, Any]] = {}
        for name, values in (given or {}).items():
            track = convert(name, actors, np.asarray(values, np.float32))
            frames.add(len(track))
            entry = shared.setdefault(id(values), {"kind": kind, "actors": [], "values": track.tobytes()})
            entry["actors"].append(name)
        tracks += shared.values()
    if len(frames) != 1 or not all(frames):
        raise MeshError(f"All motion must have one number of frames, at least 1; it has {sorted(frames)}.")
    return {"rate": float(rate_hz), "start": float(start_s), "frames": frames.pop(), "tracks": tracks}


def n_markers_of(actor: Mapping[str, Any], actors: Actors) -> int:
    """Return how many markers move an actor; 0: none do."""
    patches = actor["patches"]
    if patches:
        return int(patches["k"] if "k" in patches else n_markers_of(actors[patches["of"]], actors))
    n_points = len(actor["points"]) // 12
    return len(actor["basis"]) // (4 * n_points) if n_points else 0


def _displacements(name: str, actors: Actors, track: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    markers = n_markers_of(actors[name], actors)
    if not markers:
        raise MeshError(f"The motion of '{name}' has shape {track.shape}; it has no basis and no patches.")
    return _shaped(name, track, (markers, 3))


def _positions(name: str, actors: Actors, track: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    return _shaped(name, track, (len(actors[name]["points"]) // 12, 3))


def _shaped(name: str, track: npt.NDArray[np.float32], rows: tuple[int, ...]) -> npt.NDArray[np.float32]:
    if track.ndim != 3 or track.shape[1:] != rows:
        wanted = ", ".join(str(n) for n in rows)
        raise MeshError(f"The motion of '{name}' has shape {track.shape}; (frames, {wanted}) was expected.")
    return np.ascontiguousarray(track)


def _matrices(name: str, actors: Actors, track: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """Return matrices column by column, (n_frames, 16)."""
    if track.ndim != 3 or track.shape[1:] != (4, 4):
        raise MeshError(f"The matrices of '{name}' have shape {track.shape}; (frames, 4, 4) was expected.")
    return np.ascontiguousarray(track.transpose(0, 2, 1)).reshape(len(track), 16)
