"""The scripts under .ci: they find a working Python, install once, and name what the system lacks."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

TARGETS = "setup run check-run test test-fast lint bench lab".split()  # noqa: SIM905
TOOLS = "bash env id sed grep cat cksum head rm dirname ldconfig find sort mktemp mkdir cp ls".split()  # noqa: SIM905


def call(
    script: Path, *arguments: str, cwd: Path | None = None, **environment: str
) -> subprocess.CompletedProcess[str]:
    """Run a script with a changed environment and return what came of it."""
    return subprocess.run(
        [str(script), *arguments],
        cwd=cwd,
        env={**os.environ, "PYTHON": "", **environment},
        capture_output=True,
        text=True,
        check=False,
    )


def executable(path: Path, text: str) -> Path:
    """Write a small script that can be run."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    path.chmod(0o755)
    return path


@pytest.fixture
def bare_path(tmp_path: Path) -> Path:
    """Return a folder for PATH with the plain tools and no Python, browser or sudo."""
    folder = tmp_path / "bin"
    folder.mkdir()
    for tool in TOOLS:
        if found := shutil.which(tool):
            (folder / tool).symlink_to(found)
    return folder


PASSING = """#!/bin/bash
# passes for a working Python of another version
[ "$1" = -c ] && exec {python} -c "import sys; sys.version_info = ({major}, {minor}, 0)
$2" "${{@:3}}"
"""


def python_of(version: str) -> str:
    """Return a script that passes for a working Python X.Y, whatever X.Y is."""
    major, minor = version.split(".")
    return PASSING.format(python=sys.executable, major=major, minor=minor)


@pytest.mark.parametrize("target", TARGETS)
def test_every_target_of_the_makefile_parses(project: Path, target: str) -> None:
    result = subprocess.run(["make", "-n", target], cwd=project, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    assert ".ci/setup" in result.stdout


def test_a_python_that_only_seems_to_be_there_is_passed_over(project: Path, bare_path: Path) -> None:
    executable(bare_path / "python3.13", "#!/bin/bash\necho 'no such version' >&2\nexit 127\n")
    good = executable(bare_path / "python3.12", python_of("3.12"))
    executable(bare_path / "python3.11", python_of("3.11"))
    found = call(
        project / ".ci/find-python",
        PATH=str(bare_path),
        HOME=str(bare_path),
        PYENV_ROOT=str(bare_path / "no"),
    )
    assert found.stdout.strip() == str(good), found.stderr


def test_a_version_kept_by_pyenv_is_found(project: Path, bare_path: Path) -> None:
    executable(bare_path / "python3.11", python_of("3.11"))
    kept = executable(bare_path / "pyenv/versions/3.13.0/bin/python3.13", python_of("3.13"))
    found = call(
        project / ".ci/find-python",
        PATH=str(bare_path),
        HOME=str(bare_path),
        PYENV_ROOT=str(bare_path / "pyenv"),
    )
    assert found.stdout.strip() == str(kept), found.stderr


def test_without_a_usable_python_one_line_says_so(project: Path, bare_path: Path) -> None:
    found = call(
        project / ".ci/find-python",
        PATH=str(bare_path),
        HOME=str(bare_path),
        PYENV_ROOT=str(bare_path / "no"),
    )
    assert found.returncode == 2
    assert len(found.stderr.splitlines()) == 1
    assert "python3-venv" in found.stderr


def test_a_wrong_python_that_was_asked_for_is_named(project: Path) -> None:
    found = call(project / ".ci/find-python", PYTHON="/no/such/python")
    assert found.returncode == 2
    assert "/no/such/python" in found.stderr


FAKE_PYTHON = """#!/bin/bash
# stands for an interpreter: makes environments out of itself and writes down every start of pip
case "$1 $2" in
  "-m venv") mkdir -p "$3/bin"; cp "$0" "$3/bin/python"; echo "#!$(pwd)/$3/bin/python" >"$3/bin/pip" ;;
  "-m pip") echo "$@" >>"$PIP_LOG" ;;
  *) exec {python} "$@" ;;
esac
"""


def test_setup_installs_once_and_again_only_when_something_changed(project: Path, tmp_path: Path) -> None:
    checkout, log = tmp_path / "checkout", tmp_path / "pip.log"
    shutil.copytree(project / ".ci", checkout / ".ci")
    shutil.copyfile(project / "pyproject.toml", checkout / "pyproject.toml")
    python = executable(tmp_path / "fake", FAKE_PYTHON.format(python=sys.executable))
    version = "py%d%d" % sys.version_info[:2]  # noqa: UP031

    def n_installs(**environment: str) -> int:
        result = call(checkout / ".ci/setup", PIP_LOG=str(log), PYTHON=str(python), **environment)
        assert result.returncode == 0, result.stderr
        return len(log.read_text(encoding="utf-8").splitlines())

    assert n_installs() == 1
    assert "--quiet" in log.read_text(encoding="utf-8"), "no bars in a log"
    assert n_installs() == 1
    assert f".ci/constraints/{version}.txt" in log.read_text(encoding="utf-8")
    with (checkout / "pyproject.toml").open("a", encoding="utf-8") as stream:
        stream.write("# another\n")
    assert n_installs() == 2
    with (checkout / f".ci/constraints/{version}.txt").open("a", encoding="utf-8") as stream:
        stream.write("another==1\n")
    assert n_installs() == 3
    assert n_installs() == 3
    moved = checkout.rename(tmp_path / "moved")
    result = call(moved / ".ci/setup", PIP_LOG=str(log), PYTHON=str(python))
    assert result.returncode == 0, result.stderr
    stages = [line[:3] for line in result.stdout.splitlines()[1:]]
    assert stages == ["1/3", "2/3", "3/3"], "one line per stage, where there is no terminal"
    assert str(moved) in (moved / ".venv/bin/pip").read_text(encoding="utf-8")


def test_an_installation_that_broke_off_is_taken_up_again(project: Path, tmp_path: Path) -> None:
    checkout, log = tmp_path / "checkout", tmp_path / "pip.log"
    shutil.copytree(project / ".ci", checkout / ".ci")
    shutil.copyfile(project / "pyproject.toml", checkout / "pyproject.toml")
    broken = FAKE_PYTHON.format(python=sys.executable).replace(
        '>>"$PIP_LOG" ;;', '>>"$PIP_LOG"; [ -z "$FAIL" ] ;;'
    )
    python = executable(tmp_path / "fake", broken)
    first = call(checkout / ".ci/setup", PIP_LOG=str(log), PYTHON=str(python), FAIL="1")
    assert first.returncode != 0
    second = call(checkout / ".ci/setup", PIP_LOG=str(log), PYTHON=str(python), FAIL="")
    assert second.returncode == 0, second.stderr
    assert len(log.read_text(encoding="utf-8").splitlines()) == 2


def test_what_the_system_lacks_is_one_line_with_the_command(project: Path, bare_path: Path) -> None:
    result = call(project / ".ci/system-packages", PATH=str(bare_path))
    assert result.returncode == 0
    assert len(result.stderr.splitlines()) == 1
    assert "chromium" in result.stderr
    assert "apt-get install" in result.stderr
    assert "SYSTEM=1" in result.stderr


def test_somebody_who_may_not_install_is_told_in_one_line(project: Path, bare_path: Path) -> None:
    (bare_path / "id").unlink()
    executable(bare_path / "id", "#!/bin/bash\necho 1000\n")
    executable(bare_path / "apt-get", "#!/bin/bash\necho called >&2\n")
    result = call(project / ".ci/system-packages", "--install", PATH=str(bare_path))
    assert result.returncode == 2
    assert len(result.stderr.splitlines()) == 1
    assert "root or sudo" in result.stderr


def test_packages_are_installed_with_sudo_where_there_is_sudo(
    project: Path, bare_path: Path, tmp_path: Path
) -> None:
    (bare_path / "id").unlink()
    executable(bare_path / "id", "#!/bin/bash\necho 1000\n")
    executable(bare_path / "sudo", f'#!/bin/bash\necho "$@" >>{tmp_path}/calls\n')
    executable(bare_path / "apt-get", "#!/bin/bash\nexit 1\n")
    result = call(project / ".ci/system-packages", "--install", PATH=str(bare_path))
    assert result.returncode == 0, result.stderr
    update, install = (tmp_path / "calls").read_text(encoding="utf-8").splitlines()
    assert update.startswith("apt-get update")
    assert "DEBIAN_FRONTEND=noninteractive apt-get install" in install
    assert "chromium" in install
