"""What the cards of the blend page say of a result."""

from __future__ import annotations

from corpus_tools.core import counted
from workbench.state import Effects, Result, missing_of, stand_ins

__all__ = ["head_text", "lower_text", "missing_text"]


def head_text(result: Result) -> str:
    """Return which head is shown and how large it is."""
    mesh, n_markers = result.head.mesh, len(result.head.names)
    vertices = counted(mesh.n_vertices, "vertex", "vertices")
    return f"{mesh.name} head · {vertices} · {counted(n_markers, 'marker')}"


def missing_text(result: Result) -> str:
    """Return which diphones the corpus does not hold, and what stood in; empty when it holds all."""
    stood = stand_ins(result)
    if not stood:
        return ""
    gone = ", ".join(f"{a}-{b}" for a, b in missing_of(result)) or "Banned units"
    more = f" and {counted(len(stood) - 3, 'more phone')}" if len(stood) > 3 else ""
    return f"No motion for {gone}: {'; '.join(stood[:3])}{more}"


def lower_text(effects: Effects | None, result: Result, join: int) -> str:
    """Return what would bring a join lower still, empty when nothing does by more than 2 %."""
    best = effects.best(join) if effects is not None and effects.fits(result) else None
    if best is None or best[2] > 0.98 * result.ratios[join]:
        return ""
    return f"lower still: {best[0]} at {1000 * best[1]:.0f} ms, {best[2]:.2f}"
