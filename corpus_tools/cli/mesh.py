"""``corpus-tools mesh``: what a mesh of one's own is, what is wrong with it, and its markers."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Annotated

import typer

from corpus_tools.cli.common import PATH, emit_json, say
from corpus_tools.core import Mesh, MeshError, counted
from corpus_tools.mesh import CHARACTERS, UNITS_MM, bundled_head, check_mesh, read_mesh, read_surface

__all__ = ["register"]

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


def register(app: typer.Typer) -> None:
    """Enter the commands in the app."""
    group = typer.Typer(help="Check a mesh of your own.", no_args_is_help=True, rich_markup_mode=None)
    group.command()(check)
    app.add_typer(group, name="mesh")
