"""``workbench``: serve the dashboards and open the browser."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer
from typer.core import TyperCommand

import corpus_tools
from corpus_tools.cli.common import PATH, OneSentence, guarded, say
from corpus_tools.core import InputError
from workbench.apps.options import Options, check_options
from workbench.apps.stopping import StoppedBySignal

__all__ = ["APPS", "app", "run"]

APPS = ("corpus", "blend")
"""Dashboards that exist."""

_HELP = """The visual speech workbench in the browser.

  workbench                 a simulated starter corpus, made on first use

  workbench WORK            a corpus that 'corpus-tools init' made

  workbench WORK --config CONFIG.toml    with the settings, and the sentence, of an export
"""

app = typer.Typer(help=_HELP, rich_markup_mode=None, add_completion=False, pretty_exceptions_enable=False)


def _check_app(name: str) -> None:
    if name not in APPS:
        raise InputError(f"There is no dashboard called '{name}'; there is: {', '.join(APPS)}.")


class _Command(OneSentence, TyperCommand):
    """The one command."""


@app.command(cls=_Command)
def workbench(
    corpus: Annotated[
        Path | None, typer.Argument(**PATH, help="Corpus folder; the simulated starter corpus when left out.")
    ] = None,
    config: Annotated[
        Path | None, typer.Option("--config", **PATH, help="Config to begin with, as the page exports it.")
    ] = None,
    app_name: Annotated[
        str, typer.Option("--app", help=f"Dashboard to begin with: {', '.join(APPS)}.")
    ] = "blend",
    port: Annotated[int, typer.Option("--port", help="Port to listen on; 0 takes a free one.")] = 5006,
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Do not open the browser.")] = False,
    host: Annotated[str, typer.Option("--host", help="Address to listen on.")] = "127.0.0.1",
    password_file: Annotated[
        Path | None, typer.Option("--password-file", **PATH, help="File whose first line is the password.")
    ] = None,
    origin: Annotated[
        list[str] | None, typer.Option("--origin", help="HOST:PORT the page may be asked from; repeatable.")
    ] = None,
    root: Annotated[
        Path | None, typer.Option("--root", **PATH, help="Folder that corpora and exports must lie in.")
    ] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Start on a free port, wait for the page and a corpus, stop.")
    ] = False,
    version: Annotated[bool, typer.Option("--version", help="Show the version.")] = False,
) -> None:
    """Serve the dashboards on this machine and open the browser."""
    if version:
        say(f"workbench {corpus_tools.__version__}")
        return
    _check_app(app_name)
    with StoppedBySignal(noted=not check) as stop:
        options = Options(
            corpus,
            host,
            0 if check else port,
            password_file,
            tuple(origin or ()),
            root,
            not no_browser,
            app=app_name,
            config=config,
        )
        check_options(options)
        if check:
            _check(options)
            return
        from workbench.apps.serving import Workbench  # and Panel, which takes seconds to import

        server = Workbench(options)
        if port:
            say(f"The workbench is at http://{host}:{port}/ (stop it with Ctrl-C).", at_once=True)
        server.run(stop)
        say("The workbench has stopped.")


def _check(options: Options) -> None:
    from workbench.apps.check import check_run

    report = check_run(options)
    say(
        f"The page answered after {report.page_s:.1f} s; {report.corpus}, sentence {report.sentence}: "
        f"{report.n_frames} frames of motion after {report.ready_s:.1f} s."
    )


def run() -> None:
    """Entry point of the console script."""
    sys.exit(guarded(lambda: app(standalone_mode=True)))
