"""The command as tests call it."""

from __future__ import annotations

import pytest

from corpus_tools.cli.common import guarded
from corpus_tools.cli.main import app


@pytest.fixture
def tool(capsys):
    """Return ``tool(*args) -> (exit code, stdout, stderr)``, run in this process."""

    def run(*args):
        capsys.readouterr()
        try:
            code = guarded(lambda: app([str(a) for a in args], standalone_mode=True))
        except SystemExit as stop:
            code = stop.code or 0
        out, err = capsys.readouterr()
        return code, out, err

    return run
