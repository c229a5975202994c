"""Every file is small, says what it is, names what it offers, and speaks of nothing but the project."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
from architecture import house
from architecture import public_names as public

MODULES = {house.module_name(path): path for path in house.modules()}
SOURCES = house.files(*house.FOLDERS, suffixes=(".py", ".js"))
TEXTS = [
    *house.files(
        *house.FOLDERS, suffixes=(".py", ".js", ".css", ".toml", ".md", ".txt", ".json", ".csv", "")
    ),
    *(path for path in house.ROOT.iterdir() if path.is_file()),
]

# built in pieces, so that this file may be read by its own check
_REGISTRIES = (
    "pypi" + r"\.org",
    "python" + "hosted",
    r"registry\." + "npmjs",
    "npmjs" + r"\.com",
    "deb" + r"\.debian",
)
_REGISTRIES = (*_REGISTRIES, "node" + "source", "artifact" + "registry")
_MACHINE = (
    "/" + r"work/\w",
    "/" + "farm/",
    r"\." + r"pyenv/versions",
    "/" + r"root/\.",
    "/tmp/" + "(?:team|house)",
)
FORBIDDEN = {
    "a package registry's host": "|".join(_REGISTRIES),
    "a path of one machine": "|".join(_MACHINE),
    "work left to do": r"\b(?:TO" + "DO|FIX" + "ME|X" + r"XX)\b",
    "the workplace": r"(?i)\b(?:sub" + "agents?|co-auth" + "ored|in this " + r"issue)\b",
}
BESIDE = re.compile(r"\.\./" + "shared")


def rel(path: Path) -> str:
    """Return the path as it is written in the project."""
    return path.relative_to(house.ROOT).as_posix()


@pytest.mark.parametrize("path", SOURCES, ids=rel)
def test_no_file_needs_a_table_of_contents(path: Path) -> None:
    n_lines = len(path.read_text(encoding="utf-8").splitlines())
    assert n_lines <= (300 if path.suffix == ".js" else 400), f"{rel(path)} has {n_lines} lines: split it"


@pytest.mark.parametrize("what", FORBIDDEN)
def test_nothing_stands_in_a_text_that_does_not_belong(what: str) -> None:
    pattern = re.compile(FORBIDDEN[what])
    found = [
        f"{rel(path)}:{number}: {line.strip()[:80]}"
        for path in TEXTS
        for number, line in enumerate(_text(path).splitlines(), 1)
        if pattern.search(line)
    ]
    assert not found, f"{what} stands in\n" + "\n".join(found)


def test_the_folder_beside_the_clone_is_named_once() -> None:
    assert {rel(path) for path in TEXTS if BESIDE.search(_text(path))} == {".ci/run"}


@pytest.mark.parametrize(
    ("what", "line"),
    [
        ("a package registry's host", "see https://pypi" + ".org/simple"),
        ("a path of one machine", "open('/" + "work/main/x')"),
        ("work left to do", "# TO" + "DO later"),
        ("the workplace", "as the sub" + "agent said"),
    ],
)
def test_forbidden_words_are_seen(what: str, line: str) -> None:
    assert re.search(FORBIDDEN[what], line)


def _text(path: Path) -> str:
    data = path.read_bytes()
    return "" if b"\0" in data[:4096] else data.decode("utf-8")


@pytest.mark.parametrize("path", MODULES.values(), ids=MODULES)
def test_module_says_what_it_is_and_offers(path: Path) -> None:
    tree = house.parse(path)
    assert ast.get_docstring(tree), f"{rel(path)} has no docstring"
    names = house.public_names(tree)
    assert names is not None, f"{rel(path)} has no __all__"
    bound = house.defined_names(tree)
    for name in names:
        assert name in bound, f"{rel(path)} offers '{name}' in __all__ and does not have it"
        if isinstance(bound[name], ast.FunctionDef | ast.ClassDef | ast.AsyncFunctionDef):
            assert ast.get_docstring(bound[name]), f"{rel(path)}: '{name}' has no docstring"
    assert len(set(names)) == len(names), f"{rel(path)} names something twice in __all__"


def test_public_names_are_the_committed_ones() -> None:
    committed = public.LIST.read_text(encoding="utf-8").splitlines()
    current = public.current()
    news = [f"+ {line}" for line in current if line not in committed]
    gone = [f"- {line}" for line in committed if line not in current]
    assert committed == current, "\n".join(
        ["public names changed; if meant: python tests/architecture/public_names.py", *gone, *news]
    )


def test_no_two_test_files_have_one_name() -> None:
    names = [path.name for path in house.files("tests", suffixes=(".py",)) if path.name.startswith("test_")]
    assert sorted(set(names)) == sorted(names)
    assert not house.files("tests", suffixes=(".py",)) or not list(
        (house.ROOT / "tests").rglob("__init__.py")
    )
