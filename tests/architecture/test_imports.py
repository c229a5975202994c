"""The import contracts of pyproject.toml hold, and each kind of them goes red when it is broken."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from architecture import house

# (file, line added to it, words of the contract that must break)
BREAKS = {
    "upward": ("corpus_tools/core/errors.py", "import corpus_tools.pipeline", "an arrow may only point down"),
    "sibling": (
        "corpus_tools/mesh/__init__.py",
        "import corpus_tools.retarget",
        "an arrow may only point down",
    ),
    "hidden in a function": (
        "corpus_tools/io/__init__.py",
        "def hidden():\n    import corpus_tools.synthesis",
        "an arrow may only point down",
    ),
    "unplaced package": ("corpus_tools/new_thing/__init__.py", "", "an arrow may only point down"),
    "unplaced dashboard package": ("workbench/new_thing/__init__.py", "", "workbench: an arrow"),
    "views import apps": ("workbench/views/__init__.py", "import workbench.apps", "workbench: an arrow"),
    "library knows workbench": (
        "corpus_tools/cli/__init__.py",
        "import workbench.state",
        "knows nothing of workbench",
    ),
    "library imports panel": ("corpus_tools/mesh/__init__.py", "import panel", "imports no Panel"),
    "state imports panel": (
        "workbench/state/__init__.py",
        "import panel",
        "workbench.state imports no Panel",
    ),
    "pyvista below render": (
        "corpus_tools/mesh/__init__.py",
        "import pyvista",
        "pyvista and VTK only in render",
    ),
    "praatio elsewhere": ("corpus_tools/speech/__init__.py", "import praatio", "praatio in one module only"),
    "the voice in our process": (
        "corpus_tools/speech/engines/espeak.py",
        "import espeakng_loader",
        "only in its child process",
    ),
    "simulator and synthesiser": (
        "corpus_tools/demo/__init__.py",
        "import corpus_tools.synthesis",
        "the simulator is another model",
    ),
    "settings below": (
        "corpus_tools/fragments/__init__.py",
        "import pydantic",
        "settings objects enter only",
    ),
}


def lint_imports(folder: Path) -> subprocess.CompletedProcess[str]:
    """Run the linter in a folder, on the packages that stand there."""
    command = [str(Path(sys.executable).with_name("lint-imports")), "--no-cache"]
    environment = {**os.environ, "PYTHONPATH": str(folder), "COLUMNS": "200"}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


@pytest.fixture
def copied(tmp_path: Path) -> Path:
    """Copy the Python files of both packages and pyproject.toml."""
    for path in house.modules():
        target = tmp_path / path.relative_to(house.ROOT)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, target)
    shutil.copyfile(house.ROOT / "pyproject.toml", tmp_path / "pyproject.toml")
    return tmp_path


def test_contracts_hold(project: Path) -> None:
    result = lint_imports(project)
    assert result.returncode == 0, result.stdout + result.stderr


@pytest.mark.slow
@pytest.mark.parametrize("kind", BREAKS)
def test_contract_goes_red(copied: Path, kind: str) -> None:
    file, line, contract = BREAKS[kind]
    target = copied / file
    target.parent.mkdir(exist_ok=True)
    text = target.read_text(encoding="utf-8") if target.exists() else '"""New."""\n'
    target.write_text(f"{text}\n\n{line}\n", encoding="utf-8")
    result = lint_imports(copied)
    broken = [text for text in result.stdout.splitlines() if "BROKEN" in text]
    assert result.returncode != 0, result.stdout
    assert any(contract in text for text in broken), result.stdout + result.stderr


ALL_MODULES = """
import importlib, pkgutil, sys

class Block:
    blocked = {blocked!r}

    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in self.blocked:
            raise ModuleNotFoundError(f"No module named {{name!r}} (blocked)", name=name)
        return None

sys.meta_path.insert(0, Block())
for package in {packages!r}:
    module = importlib.import_module(package)
    for found in pkgutil.walk_packages(module.__path__, package + "."):
        importlib.import_module(found.name)
print(" ".join(sorted({{name.split(".")[0] for name in sys.modules}})))
"""

# what an installation without extras, or without anything under the GPL, does not have
OPTIONAL = """
    espeakng_loader parselmouth pocketsphinx ezc3d imageio_ffmpeg av pygltflib pxr alembic3d pympi dask
    distributed ipykernel jupyter_bokeh jupyterlab jupytext nbclient pytest hypothesis playwright
""".split()  # noqa: SIM905


def imported(packages: list[str], blocked: list[str]) -> set[str]:
    """Import every module of the packages in a new process and return the top-level modules then loaded."""
    code = ALL_MODULES.format(packages=packages, blocked=blocked)
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    return set(result.stdout.split())


@pytest.mark.parametrize("package", house.PACKAGES)
def test_every_module_imports_without_optional_packages(package: str) -> None:
    assert not imported([package], OPTIONAL) & set(OPTIONAL)


def test_blocking_blocks() -> None:
    with pytest.raises(AssertionError, match="blocked"):
        imported(["corpus_tools"], ["numpy"])


def test_the_library_loads_no_dashboard() -> None:
    assert not imported(["corpus_tools"], []) & {"panel", "bokeh", "holoviews", "param", "workbench"}


def test_the_state_of_a_session_loads_no_panel() -> None:
    loaded = imported(["workbench.state"], [])
    assert not loaded & {"panel", "bokeh", "holoviews", "pyvista", "vtkmodules"}
