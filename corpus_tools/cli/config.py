"""``corpus-tools config``: show, check, compare configs; their schema."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from corpus_tools.cli.common import PATH, emit_json, say
from corpus_tools.config import Config, config_diff, config_schema, config_text, load_config
from corpus_tools.core import counted

__all__ = ["register"]

Json = Annotated[bool, typer.Option("--json", help="Print one JSON object as the last line.")]
File = Annotated[Path, typer.Argument(**PATH, help="A config file (TOML).")]


def show(
    file: Annotated[
        Path | None, typer.Argument(**PATH, help="A config file; the defaults when left out.")
    ] = None,
    json_: Json = False,
) -> None:
    """Show every value of a config, or the defaults; redirected into a file, the start of your own."""
    config = load_config(file) if file else Config()
    if json_:
        emit_json(config.values())
    else:
        say(config_text(config).rstrip())


def check(file: File, json_: Json = False) -> None:
    """Check a config: unknown keys and bad values are refused with the nearest known name."""
    config = load_config(file)
    changed = config_diff(Config(), config)
    if json_:
        emit_json({"ok": True, "file": str(file), "changed": [key for key, _, _ in changed]})
    else:
        say(f"{file}: in order; {counted(len(changed), 'value differs', 'values differ')} from the defaults.")


def diff(before: File, after: File, json_: Json = False) -> None:
    """List the values in which two configs differ."""
    rows = config_diff(load_config(before), load_config(after))
    if json_:
        emit_json({"changes": [{"key": k, "before": a, "after": b} for k, a, b in rows]})
        return
    for key, old, new in rows:
        say(f"{key}: {old} -> {new}")
    if not rows:
        say("No difference.")


def schema() -> None:
    """Print the JSON schema of config files."""
    say(json.dumps(config_schema(), indent=1))


def register(app: typer.Typer) -> None:
    """Enter the commands in the app."""
    group = typer.Typer(help="Show, check and compare configs.", no_args_is_help=True, rich_markup_mode=None)
    for command in (show, check, diff, schema):
        group.command()(command)
    app.add_typer(group, name="config")
