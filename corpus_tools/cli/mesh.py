"""``corpus-tools mesh``: what a mesh of one's own is, what is wrong with it, and its markers."""

from __future__ import annotations

import dataclasses
import json
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from corpus_tools.cli.common import PATH, emit_json, say
from corpus_tools.core import Mesh, MeshError, OutputError, atomic_file, check_writable, counted
from corpus_tools.mesh import (
    CHARACTERS,
    UNITS_MM,
    bundled_head,
    check_mesh,
    propose_markers,
    read_mesh,
    read_picks,
    read_surface,
    ready_to_speak,
    write_mesh,
)

__all__ = ["register"]

LEAST_PICKS = 8
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object as the last line.")]
File = Annotated[Path, typer.Argument(**PATH, help="A mesh file, or a bundled head by name.")]


def _surface(file: Path) -> tuple[Mesh, float]:
    """Return a mesh with its markers where it has them, and how many mm its unit is."""
    if str(file) in CHARACTERS:
        return bundled_head(str(file)), 1.0
    mesh, unit = read_surface(file)
    if file.suffix.lower() != ".npz" and file.with_suffix(".markers.json").is_file():
        mesh = read_mesh(file)
    return mesh, unit


def check(file: File, json_: Json = False) -> None:
    """Tell size, unit and faults of a mesh; exit code 2 when it cannot be bound."""
    mesh, scale = _surface(file)
    unit = next(name for name, mm in UNITS_MM.items() if mm == scale)
    size = [round(float(e), 1) for e in mesh.vertices_mm.max(axis=0) - mesh.vertices_mm.min(axis=0)]
    faults = check_mesh(mesh)
    say(
        f"{file}: {counted(mesh.n_vertices, 'vertex', 'vertices')}, {counted(len(mesh.faces), 'face')}, "
        f"{counted(len(mesh.markers), 'marker')}; {size[0]:g} x {size[1]:g} x {size[2]:g} mm, read as {unit}."
    )
    for fault in faults:
        say(f"{'✗' if fault.fatal else '▲'} {fault.sentence}")
    if not faults:
        say("No fault found.")
    if json_:
        rows = [dataclasses.asdict(fault) for fault in faults]
        facts = {"vertices": mesh.n_vertices, "faces": len(mesh.faces), "markers": len(mesh.markers)}
        ok = not any(f.fatal for f in faults)
        emit_json({"ok": ok, "file": str(file), **facts, "unit": unit, "size_mm": size, "faults": rows})
    if any(f.fatal for f in faults):
        raise MeshError(next(f.sentence for f in faults if f.fatal))


def propose(
    file: File,
    out: Annotated[Path, typer.Option("--out", **PATH, help="Folder for NAME.npz and NAME.markers.json.")],
    picks: Annotated[
        Path | None,
        typer.Option("--picks", **PATH, help="Markers that you know: a NAME.markers.json, edited."),
    ] = None,
    json_: Json = False,
) -> None:
    """Put the 66 markers and the lip pairs on a mesh that names none; the mesh itself is not altered.

    NAME.npz is a copy that can speak (synth --mesh), its lips opened; NAME.markers.json names
    vertices of your file: edit it, and give it back with --picks.
    """
    if out.resolve() == file.parent.resolve():
        raise OutputError(f"'{out}' is the folder of the mesh; choose a folder of its own for --out.")
    check_writable(out)
    mesh, scale = _surface(file)
    given, pairs = read_picks(picks, mesh.vertices_mm, scale) if picks else ({}, mesh.lip_pairs[:0])
    whole = len(pairs) and {"lip_in0", "lip_in4"} <= given.keys() and len(given) >= LEAST_PICKS
    marked = mesh if whole else propose_markers(mesh)
    markers = given if whole else dict(marked.markers) | given
    marked = replace(marked, markers=markers, lip_pairs=pairs if len(pairs) else marked.lip_pairs)
    ready, n_deleted = ready_to_speak(marked)
    table = {
        "scale_to_mm": scale,
        "markers": dict(ready.markers),
        "lip_pairs": ready.lip_pairs.tolist(),
    }
    out.mkdir(parents=True, exist_ok=True)
    write_mesh(out / f"{mesh.name}.npz", ready)
    with atomic_file(out / f"{mesh.name}.markers.json") as temporary:
        temporary.write_text(json.dumps(table, indent=1), encoding="utf-8")
    say(f"{out}: {mesh.name}.npz and {mesh.name}.markers.json with {counted(len(markers), 'marker')}.")
    if n_deleted:
        say(f"▲ {counted(n_deleted, 'face')} that closed the mouth between the lips are not in the copy.")
    say("Look at it before you trust it: the markers are a proposal.")
    if json_:
        emit_json({"out": str(out), "markers": len(markers), "given": len(given), "deleted_faces": n_deleted})


def register(app: typer.Typer) -> None:
    """Enter the commands in the app."""
    group = typer.Typer(
        help="Check a mesh of your own; put markers on it.", no_args_is_help=True, rich_markup_mode=None
    )
    group.command()(check)
    group.command()(propose)
    app.add_typer(group, name="mesh")
