"""What a command answers: what is asked of it in every test."""

from __future__ import annotations

import json
import re
import sys

START = [sys.executable, "-c", "from corpus_tools.cli.start import run; run()"]
"""The command in a process of its own."""


def refused(answer, *words):
    """Check exit 2 and one sentence, no novel (but for names that are long), that holds `words`."""
    code, out, err = answer
    assert code == 2, out + err
    assert len(err.splitlines()) == 1
    assert len(re.sub("x{99,}", "x", err)) < 400
    for word in words:
        assert word in err
    assert "Traceback" not in out + err


def last_json(out):
    """Return the object that the last line of stdout holds."""
    return json.loads(out.splitlines()[-1])
