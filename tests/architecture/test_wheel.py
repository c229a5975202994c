"""The wheel, installed outside the checkout, brings everything it needs and synthesises a sentence."""

from __future__ import annotations

import csv
import os
import subprocess
import sys
import sysconfig
import zipfile
from importlib import metadata
from pathlib import Path

import pytest
from architecture import house
from packaging.requirements import Requirement

pytestmark = pytest.mark.slow


def run(*command: str | Path, cwd: Path) -> str:
    """Run a command away from the checkout and return what it printed."""
    environment = {
        name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "PYTEST"))
    }
    result = subprocess.run(
        [str(part) for part in command], cwd=cwd, env=environment, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, f"{command}\n{result.stdout}\n{result.stderr}"
    return result.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the wheel from the checkout, without network."""
    out = tmp_path_factory.mktemp("wheel")
    run(sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", out, house.ROOT, cwd=out)
    (built,) = out.glob("*.whl")
    return built


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Install the wheel in an environment of its own, next to the dependencies that stand here already.

    The dependencies come through a path file, which lends their folder and does not follow its path files:
    the editable installation of the checkout is therefore not seen.
    """
    folder = tmp_path_factory.mktemp("elsewhere")
    run(sys.executable, "-m", "venv", "--without-pip", folder / "env", cwd=folder)
    python = folder / "env/bin/python"
    run(
        sys.executable,
        "-m",
        "pip",
        "--python",
        python,
        "install",
        "-q",
        "--no-deps",
        "--no-index",
        wheel,
        cwd=folder,
    )
    site = run(python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))", cwd=folder).strip()
    (Path(site) / "dependencies.pth").write_text(sysconfig.get_path("purelib") + "\n", encoding="utf-8")
    return folder


def test_every_file_of_both_packages_is_in_the_wheel(wheel: Path) -> None:
    inside = {name for name in zipfile.ZipFile(wheel).namelist() if not name.endswith("/")}
    ours = {path.relative_to(house.ROOT).as_posix() for path in house.files(*house.PACKAGES)}
    expected = {name for name in ours if not name.startswith("corpus_tools/decisions/")}
    packed = {name for name in inside if ".dist-info/" not in name}
    assert packed == expected
    for suffix in (".npz", ".toml", ".js", ".css", ".woff2"):
        assert any(name.endswith(suffix) for name in packed), f"no {suffix} in the wheel"
    assert any(name.endswith("licenses/LICENSE") for name in inside)


def test_the_wheel_says_all_it_requires_and_all_of_it_fits(installed: Path) -> None:
    code = "from importlib.metadata import requires; print('\\n'.join(requires('visual-speech-workbench')))"
    required = [
        Requirement(line)
        for line in run(installed / "env/bin/python", "-c", code, cwd=installed).splitlines()
    ]
    core = {r.name: r for r in required if r.marker is None}
    assert {"numpy", "panel", "pyvista", "praatio"} <= set(core)
    for name, requirement in core.items():
        assert metadata.version(name) in requirement.specifier, requirement


def test_the_installed_package_is_the_one_that_runs(installed: Path) -> None:
    code = "import corpus_tools, workbench; print(corpus_tools.__file__); print(workbench.__file__)"
    for line in run(installed / "env/bin/python", "-c", code, cwd=installed).splitlines():
        assert Path(line).is_relative_to(installed), line


def test_the_commands_say_what_they_do(installed: Path) -> None:
    for command in ("corpus-tools", "workbench"):
        assert "Usage" in run(installed / "env/bin" / command, "--help", cwd=installed)


def test_a_sentence_is_synthesised_outside_the_checkout(installed: Path) -> None:
    command = installed / "env/bin/corpus-tools"
    run(command, "demo", installed / "simulated", "--sentences", "14", cwd=installed)
    run(command, "check", installed / "simulated", "--json", cwd=installed)
    names = "from corpus_tools.io import find_recordings, read_description as r; import sys; "
    names += "print(find_recordings(r(sys.argv[1]))[0].id)"
    name = run(installed / "env/bin/python", "-c", names, installed / "simulated", cwd=installed).strip()
    run(
        command,
        "synth",
        installed / "simulated",
        "--utterance",
        name,
        "--out",
        installed / "out",
        cwd=installed,
    )
    written = {path.name for path in (installed / "out").iterdir()}
    assert {
        "motion.npz",
        "mesh.npz",
        "speech.wav",
        "labels.TextGrid",
        "joins.csv",
        "manifest.json",
    } <= written
    with (installed / "out/joins.csv").open(encoding="utf-8", newline="") as stream:
        assert {row["left_source"] for row in csv.DictReader(stream)}.isdisjoint({name})
