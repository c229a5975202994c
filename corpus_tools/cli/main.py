"""``corpus-tools``: one command a file, joined here."""

from __future__ import annotations

import sys
from typing import Annotated

import typer
from typer.core import TyperGroup

import corpus_tools
from corpus_tools.cli import bench, clean, config, corpus, demo, evaluate, grammar, mesh, synth, warps
from corpus_tools.cli.common import OneSentence, guarded, say

__all__ = ["app", "run"]

_HELP = """Speech animation from captured motion fragments: the batch command under the workbench.

Begin with your own recordings:

  corpus-tools init WORK --motion 'markers/{id}.npz' --audio 'wav/{id}.wav' --labels 'textgrid/{id}.TextGrid'

  corpus-tools check WORK

  corpus-tools synth WORK --text "a sentence that nobody recorded" --out OUT

  workbench WORK
"""


class _Commands(OneSentence, TyperGroup):
    """The commands."""


app = typer.Typer(
    cls=_Commands,
    help=_HELP,
    no_args_is_help=True,
    rich_markup_mode=None,
    add_completion=False,
    pretty_exceptions_enable=False,
)
for module in (demo, grammar, corpus, clean, warps, synth, evaluate, mesh, config, bench):
    module.register(app)


def _version(show: bool) -> None:
    if show:
        say(f"corpus-tools {corpus_tools.__version__}")
        raise typer.Exit


@app.callback()
def _main(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """Hold the options that stand before every command."""


def run() -> None:
    """Entry point of the console script."""
    sys.exit(guarded(lambda: app(standalone_mode=True)))
