"""The rules of tests/conftest.py: when a skip is a failure, and which marks a folder gives."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

CASES = {
    "real/test_it.py": "def test_real(corpora):\n    assert corpora.is_dir()\n",
    "real/test_gone.py": "import pytest\npytest.skip('nothing here', allow_module_level=True)\n",
    "browser/test_page.py": "import pytest\ndef test_page():\n    pytest.skip('no Chromium')\n",
    "cli/test_drawn.py": "import pytest\n@pytest.fixture\ndef offscreen():\n    pytest.skip('no VTK')\n"
    "def test_drawn(offscreen):\n    pass\n",
    "core/test_plain.py": "def test_plain():\n    assert True\n",
}


@pytest.fixture
def suite(tmp_path: Path, project: Path) -> Path:
    """Return a small project with the same conftest."""
    for name, text in CASES.items():
        path = tmp_path / "tests" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    shutil.copyfile(project / "tests/conftest.py", tmp_path / "tests/conftest.py")
    shutil.copyfile(project / "pyproject.toml", tmp_path / "pyproject.toml")
    return tmp_path


def run(suite: Path, *arguments: str, **environment: str) -> dict[str, int]:
    """Run the small project and return how many tests passed, failed, were skipped or left out."""
    clean = {name: value for name, value in os.environ.items() if name not in {"CI", "SPEECH_CORPORA"}}
    command = [sys.executable, "-m", "pytest", "-q", *arguments]
    result = subprocess.run(
        command, cwd=suite, env={**clean, **environment}, capture_output=True, text=True, check=False
    )
    summary = result.stdout.strip().splitlines()[-1].split(" in ")[0]
    return {word.rstrip("s"): int(n) for n, word in (part.split() for part in summary.split(", "))}


def test_without_recordings_the_tests_on_them_skip(suite: Path) -> None:
    assert run(suite) == {"passed": 1, "skipped": 4}


def test_with_recordings_a_skip_is_a_failure(suite: Path, tmp_path: Path) -> None:
    counts = run(suite, "--continue-on-collection-errors", SPEECH_CORPORA=str(tmp_path))
    assert counts == {"passed": 2, "skipped": 2, "error": 1}


def test_recordings_that_are_not_there_are_a_failure(suite: Path) -> None:
    counts = run(suite, "tests/real/test_it.py", SPEECH_CORPORA="/no/such/folder")
    assert counts == {"error": 1}


def test_continuous_integration_must_have_a_browser(suite: Path) -> None:
    assert run(suite, "tests/browser", CI="true") == {"failed": 1}


def test_what_asks_for_drawing_must_draw_there_wherever_it_stands(suite: Path) -> None:
    assert run(suite, "tests/cli", CI="true") == {"error": 1}
    assert run(suite, "tests/cli") == {"skipped": 1}


def test_folders_give_marks(suite: Path) -> None:
    assert run(suite, "-m", "not slow", "--ignore=tests/real/test_gone.py") == {"passed": 1, "deselected": 3}
    assert run(suite, "-m", "real", "--ignore=tests/real/test_gone.py") == {"skipped": 1, "deselected": 3}
