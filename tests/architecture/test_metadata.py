"""Version, dependencies, conda file, constraints and citation agree with one another."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
import yaml
from architecture import house
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name
from packaging.version import Version

import corpus_tools

PYPROJECT = tomllib.loads((house.ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
CONSTRAINTS = sorted((house.ROOT / ".ci" / "constraints").glob("py*.txt"))


def requirements(*extras: str) -> list[Requirement]:
    """Return what is required, own extras resolved."""
    found = [Requirement(text) for text in PYPROJECT["dependencies"]]
    waiting = list(extras)
    while waiting:
        for text in PYPROJECT["optional-dependencies"][waiting.pop()]:
            requirement = Requirement(text)
            if requirement.name == PYPROJECT["name"]:
                waiting.extend(requirement.extras)
            else:
                found.append(requirement)
    return found


def test_version_changelog_and_citation_agree() -> None:
    changelog = (house.ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    newest = re.search(r"^## (\d\S*)", changelog, re.MULTILINE)
    citation = yaml.safe_load((house.ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert newest is not None
    assert newest[1] == corpus_tools.__version__ == citation["version"]
    assert citation["license"] == PYPROJECT["license"] == "BSD-3-Clause"
    assert {"title", "authors", "message"} <= set(citation)


def test_conda_users_get_the_same_list() -> None:
    environment = yaml.safe_load((house.ROOT / "environment.yml").read_text(encoding="utf-8"))
    *conda, pip = environment["dependencies"]
    assert conda == [f"python{PYPROJECT['requires-python']}", "pip"]
    assert pip == {"pip": ["--editable .[all]"]}
    assert environment["name"] == PYPROJECT["name"]


def test_all_is_every_extra_but_dev() -> None:
    users = {name for name in PYPROJECT["optional-dependencies"] if name not in {"all", "dev"}}
    (everything,) = (Requirement(text) for text in PYPROJECT["optional-dependencies"]["all"])
    assert everything.extras == users
    assert Requirement(PYPROJECT["optional-dependencies"]["dev"][0]).extras == {"all"}


def test_there_are_constraints_for_every_python() -> None:
    supported = SpecifierSet(PYPROJECT["requires-python"])
    wanted = {f"py3{minor}" for minor in range(8, 30) if Version(f"3.{minor}") in supported}
    assert {path.stem for path in CONSTRAINTS} == wanted


@pytest.mark.parametrize("path", CONSTRAINTS, ids=lambda path: path.stem)
def test_constraints_hold_names_and_versions_only_and_cover_what_is_required(path: Path) -> None:
    lines = path.read_text(encoding="utf-8").splitlines()
    for line in lines:
        assert re.fullmatch(r"[A-Za-z0-9._-]+==[A-Za-z0-9.+!_-]+", line), line
    pinned = {canonicalize_name(name): Version(version) for name, version in (x.split("==") for x in lines)}
    for requirement in requirements("dev"):
        version = pinned.get(canonicalize_name(requirement.name))
        assert version is not None, f"{requirement.name} is not pinned in {path.name}"
        assert version in requirement.specifier, f"{path.name} pins {requirement.name} to {version}"


@pytest.mark.parametrize("package", house.PACKAGES)
def test_every_import_is_a_declared_dependency(package: str) -> None:
    declared = {canonicalize_name(r.name) for r in requirements("all")}
    by_module = packages_distributions()
    undeclared = {
        f"{house.module_name(path)} imports {top}"
        for path in house.files(package, suffixes=(".py",))
        for top in _imported(house.parse(path))
        if top not in sys.stdlib_module_names and top not in house.PACKAGES
        if not declared & {canonicalize_name(name) for name in by_module.get(top, [])}
    }
    assert not undeclared, sorted(undeclared)


def _imported(tree: ast.Module) -> set[str]:
    found: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            found.add(node.module.split(".")[0])
    return found
