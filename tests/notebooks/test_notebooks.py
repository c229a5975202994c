"""Every notebook runs from its first cell to its last, which asserts what it set out to show."""

from __future__ import annotations

import ast
from pathlib import Path

import jupytext
import nbformat
import pytest
from nbclient import NotebookClient

NOTEBOOKS = sorted((Path(__file__).parents[2] / "notebooks").glob("*.py"))
ON_RECORDINGS = [path for path in NOTEBOOKS if "SPEECH_CORPORA" in path.read_text(encoding="utf-8")]


def run(path: Path, folder: Path) -> nbformat.NotebookNode:
    """Run a notebook in `folder` and return it with its outputs."""
    notebook = jupytext.read(path)
    notebook.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    client = NotebookClient(notebook, timeout=240, resources={"metadata": {"path": str(folder)}})
    return client.execute()


def shown(notebook: nbformat.NotebookNode) -> set[str]:
    """Return the kinds of output that the cells gave."""
    return {
        kind
        for cell in notebook.cells
        for output in cell.get("outputs", [])
        for kind in output.get("data", {})
    }


def complaints(notebook: nbformat.NotebookNode) -> list[str]:
    """Return what cells wrote to stderr: a plot that cannot be drawn is told there, and is no error."""
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    return [output["text"] for output in outputs if output.get("name") == "stderr"]


def test_there_are_notebooks() -> None:
    assert NOTEBOOKS
    assert ON_RECORDINGS


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_the_last_cell_asserts(path: Path) -> None:
    code = [cell.source for cell in jupytext.read(path).cells if cell.cell_type == "code"]
    assert any(isinstance(node, ast.Assert) for node in ast.walk(ast.parse(code[-1])))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_runs_on_the_simulated_corpus(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SPEECH_CORPORA", raising=False)
    done = run(path, tmp_path)
    assert "text/html" in shown(done)
    assert complaints(done) == []


@pytest.mark.parametrize("path", ON_RECORDINGS, ids=lambda path: path.stem)
def test_it_runs_on_recordings(path: Path, tmp_path: Path, corpora: Path) -> None:
    assert corpora.is_dir()
    done = run(path, tmp_path)
    assert "text/html" in shown(done)
    assert complaints(done) == []


def test_a_false_assertion_is_seen(tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.py"
    wrong.write_text("# %%\nvalue = 1\n\n# %%\nassert value == 2\n", encoding="utf-8")
    with pytest.raises(Exception, match="AssertionError"):
        run(wrong, tmp_path)
