"""What the cards of the blend page say of a result."""

from __future__ import annotations

from corpus_tools.core import counted
from workbench.state import Effects, Result, missing_of, stand_ins

__all__ = ["beside_of", "head_text", "lower_text", "missing_text"]


BESIDE = ("female", "male", "child")
"""Heads that stand beside the first unless others are chosen (our choice: faces that differ in size)."""


def beside_of(mesh: str) -> list[str]:
    """Return two bundled heads to show beside another."""
    return [name for name in BESIDE if name != mesh][:2]


def head_text(result: Result, cast: tuple[Result, ...] = ()) -> str:
    """Return which head is shown and how large it is; of several, which, and that they speak one motion."""
    if cast:
        return f"{', '.join(r.head.mesh.name for r in (result, *cast))} · the same motion"
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
