"""What the cards of the blend page say of a result."""

from __future__ import annotations

from corpus_tools.core import counted
from workbench.state import Effects, Result, stand_ins
from workbench.state.said import contacts_of, missed_text

__all__ = ["beside_of", "head_text", "lower_text", "missing_text", "overlap_label"]


BESIDE = ("female", "male", "child")
"""Heads that stand beside the first unless others are chosen (our choice: faces that differ in size)."""

MOST_TOLD = 3
"""Stand-ins told one by one (our choice: a line of the lane)."""


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
    """Return what the motion lacks, in one line: diphones for which others stood in, contacts not made."""
    most, told = stand_ins(result)
    more = f" · and {len(told) - MOST_TOLD} more" if len(told) > MOST_TOLD else ""
    stood_in = most or f"{' · '.join(told[:MOST_TOLD])}{more}"
    return " · ".join(filter(None, (stood_in, missed_text(contacts_of(result)))))


def lower_text(effects: Effects | None, result: Result, join: int) -> str:
    """Return what would bring a join lower; empty when it moves as speech does, or nothing helps.

    Where the join is below the 95th percentile of natural stretches already, less is no better. Less than
    5 % is no help (our choice).
    """
    best = effects.best(join) if effects is not None and effects.fits(result) else None
    ratio = result.ratios[join]
    if best is None or not ratio > 1.0 or best[2] > 0.95 * ratio:
        return ""
    return f"lower: {best[0]} at {1000 * best[1]:.0f} ms, {best[2]:.2f}"


def overlap_label(result: Result | None) -> str:
    """Return the label of the overlap's slider, with how many joins the rule keeps shorter than asked."""
    label = "Longest overlap, ms"
    if result is None or result.request.config.blend.mode == "inertial":
        return label
    joins, asked_s = result.trajectory.joins, result.request.config.blend.overlap_s
    shorter = sum(join.overlap_s < asked_s - 0.0005 for join in joins)
    return f"{label} ({shorter}/{len(joins)} less)" if shorter else label
