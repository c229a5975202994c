"""README tells the truth: its files, links, make targets and commands exist."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from architecture import house
from typer.testing import CliRunner

from corpus_tools.cli.main import app

README = (house.ROOT / "README.md").read_text(encoding="utf-8")
DECISIONS = sorted((house.ROOT / "corpus_tools" / "decisions").glob("*.md"))


def test_the_two_commands_stand_at_the_top() -> None:
    top = README.split("\n\n")[1]
    assert [line.split("#")[0].strip() for line in top.splitlines()[1:-1]] == ["make run", "make test"]


@pytest.mark.parametrize("link", sorted(set(re.findall(r"\]\((?!http)([^)#]+)\)", README))))
def test_links_lead_somewhere(link: str) -> None:
    assert (house.ROOT / link).exists(), link


def test_pictures_are_small_and_the_only_ones() -> None:
    """Pictures of the README stand in docs: a package would carry them into every wheel."""
    shown = set(re.findall(r"!\[[^\]]+\]\(([^)]+)\)", README))
    assert shown == {f"docs/{path.name}" for path in (house.ROOT / "docs").iterdir()}
    for picture in shown:
        data = (house.ROOT / picture).read_bytes()
        assert data.startswith(b"\x89PNG"), picture
        assert len(data) < 250_000, f"{picture} has {len(data)} bytes"


@pytest.mark.parametrize(
    "path", sorted(set(re.findall(r"`((?:corpus_tools|workbench|tests|notebooks|\.ci)/[^`<> ]*)`", README)))
)
def test_named_files_exist(path: str) -> None:
    assert (house.ROOT / path).exists(), path


def test_the_map_names_every_package() -> None:
    rows = "\n".join(line for line in README.splitlines() if line.startswith("| `"))
    for package in house.PACKAGES:
        for folder in (house.ROOT / package).iterdir():
            if folder.is_dir() and not folder.name.startswith((".", "_")):
                assert re.search(rf"\b{folder.name}`", rows), f"the map does not name {package}/{folder.name}"


def test_make_targets_exist() -> None:
    makefile = (house.ROOT / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([a-z-]+):", makefile, re.MULTILINE))
    named = set(
        re.findall(r"^(?:PYTHON=\S+ )?make ([a-z-]+)|`(?:PYTHON=\S+ )?make ([a-z-]+)", README, re.MULTILINE)
    )
    assert {a or b for a, b in named} <= targets


def test_commands_and_their_options_exist() -> None:
    for line in README.replace("\\\n", " ").splitlines():
        if not (found := re.match(r"\W*corpus-tools ([a-z]+)(.*)", line)):
            continue
        command, rest = found.groups()
        options = set(re.findall(r"--[a-z]+", rest.split("#")[0]))
        shown = CliRunner().invoke(app, [command, "--help"])
        assert shown.exit_code == 0, f"README calls 'corpus-tools {command}'"
        assert options <= set(re.findall(r"--[a-z]+", shown.stdout)), line


@pytest.mark.parametrize("record", DECISIONS, ids=lambda path: path.stem)
def test_decision_records_are_numbered_and_titled(record: Path) -> None:
    number = re.match(r"(\d{3})-[a-z0-9-]+\.md$", record.name)
    assert number is not None, record.name
    assert record.read_text(encoding="utf-8").startswith(f"# {number[1]} ")


def test_decision_numbers_are_taken_once() -> None:
    numbers = [path.name[:3] for path in DECISIONS]
    assert numbers == sorted(set(numbers))
