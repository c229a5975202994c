"""``corpus-tools``: one command a file, joined here."""

from __future__ import annotations

import sys
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

import corpus_tools
from corpus_tools.cli import bench, config, corpus, demo, grammar, synth
from corpus_tools.cli.common import guarded, say
from corpus_tools.core import InputError

__all__ = ["app", "run"]

_HELP = """Speech animation from captured motion fragments: the batch command under the workbench.

Begin with your own recordings:

  corpus-tools init WORK --motion 'markers/{id}.npz' --audio 'wav/{id}.wav' --labels 'textgrid/{id}.TextGrid'

  corpus-tools check WORK

  corpus-tools synth WORK --text "a sentence that nobody recorded" --out OUT

  workbench WORK
"""


class _Commands(TyperGroup):
    """The commands; a misspelt option costs one sentence, as every other mistake does."""

    def main(self, *args: Any, **extra: Any) -> Any:
        """Run a command; what typer would print or swallow itself is raised instead."""
        try:
            code = super().main(*args, **(extra | {"standalone_mode": False}))
        except SystemExit as stop:
            if isinstance(stop.__context__, BrokenPipeError):
                raise stop.__context__ from None
            raise
        except Exception as error:
            if type(error).__name__ == "NoArgsIsHelpError":
                error.show()  # type: ignore[attr-defined]
                raise SystemExit(2) from None
            if not hasattr(error, "format_message"):
                raise
            place = getattr(getattr(error, "ctx", None), "command_path", "corpus-tools")
            sentence = error.format_message().rstrip(".")
            raise InputError(f"{sentence}; '{place} --help' lists what there is.") from None
        if isinstance(code, int) and code:
            raise SystemExit(code)
        return code


app = typer.Typer(
    cls=_Commands,
    help=_HELP,
    no_args_is_help=True,
    rich_markup_mode=None,
    add_completion=False,
    pretty_exceptions_enable=False,
)
for module in (demo, grammar, corpus, synth, config, bench):
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
