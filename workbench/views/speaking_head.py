"""A head that moves as an animation says, in a view of its own or in one that is there."""

from __future__ import annotations

from typing import Any

import numpy as np

from corpus_tools.pipeline import Animation, Head
from workbench.views.cameras import head_camera
from workbench.views.head_actors import head_actors
from workbench.views.mesh_view import MeshView

__all__ = ["head_motion", "move_head", "show_head"]

_HEIGHT_PIXELS = 420


def head_motion(
    head: Head, animation: Animation, actors: list[dict[str, Any]], prefix: str = ""
) -> dict[str, Any]:
    """Return the motion of a head, for :meth:`MeshView.set_motion`, for those actors that are there.

    Parameters
    ----------
    head : Head
    animation : Animation
        Of this head.
    actors : list of dict
        Of the view.
    prefix : str
        As of :func:`workbench.views.head_actors.head_actors`.
    """
    rest_mm = head.mesh.vertices_mm[[head.mesh.markers[name] for name in head.names]]
    shift = (np.asarray(animation.targets_mm) - rest_mm).astype(np.float32)
    mine = {a["name"].removeprefix(prefix): a for a in actors if a["name"].startswith(prefix)}
    moving = [a["name"] for a in mine.values() if a["basis"] or a["patches"]]
    rigid = {prefix + part: m for part, m in animation.rigid.items() if part in mine}
    return {"displacements": dict.fromkeys(moving, shift), "rigid": rigid}


def show_head(head: Head, animation: Animation | None = None, **params: Any) -> MeshView:
    """Return a view of a head that moves with the clock, to be the last line of a notebook cell.

    Parameters
    ----------
    head : Head
        As of :func:`corpus_tools.pipeline.prepare_head`.
    animation : Animation, optional
        As of :func:`corpus_tools.pipeline.animate`; without one the head rests.
    **params
        Of :class:`MeshView`: `session`, the id of the clock that a transport shares; `height`, pixels;
        `wheel_needs_ctrl`, True unless given, so that the wheel scrolls the notebook.
    """
    shown = {"height": _HEIGHT_PIXELS, "sizing_mode": "stretch_width", "wheel_needs_ctrl": True}
    view = MeshView(**{**shown, **params})
    view.show_actors(head_actors(head.mesh, head.binding), camera=head_camera(head.mesh))
    if animation is not None:
        move_head(view, head, animation)
    return view


def move_head(view: MeshView, head: Head, animation: Animation) -> None:
    """Let the head of :func:`show_head` move as another animation says."""
    times = animation.times_s
    rate_hz = (len(times) - 1) / float(times[-1] - times[0]) if len(times) > 1 else 1.0
    motion = head_motion(head, animation, view.actors)
    view.set_motion(round(rate_hz, 6), start_s=float(times[0]), **motion)
