"""Widgets whose changes reach Python at once: for a head that follows a slider."""

from __future__ import annotations

from typing import TypeVar

import panel as pn

__all__ = ["prompt"]

W = TypeVar("W", bound=pn.reactive.Reactive)


def prompt(widget: W, *attributes: str) -> W:
    """Let what a widget says reach Python without the 50 ms that Panel's server gathers changes for.

    What is said while Python is at work is still gathered, so that a drag never queues up. In notebooks a
    :class:`~workbench.views.mesh_view.MeshView` on the page sees to the same.

    Parameters
    ----------
    widget : Panel widget
    *attributes : str
        Of its model; "value" unless given.

    Returns
    -------
    The widget.
    """
    widget._priority_changes = [*type(widget)._priority_changes, *(attributes or ("value",))]
    return widget
