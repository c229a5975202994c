"""What the architecture tests share: the project's files and their names, read without importing them."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGES = ("corpus_tools", "workbench")
FOLDERS = (*PACKAGES, "tests", "notebooks", ".ci")
IGNORED = {"__pycache__", "node_modules", ".ipynb_checkpoints"}


def files(*folders: str, suffixes: tuple[str, ...] = (), root: Path = ROOT) -> list[Path]:
    """Return our files under the folders, sorted; all suffixes when none is named."""
    found = (path for folder in folders for path in (root / folder).rglob("*"))
    return sorted(
        path
        for path in found
        if path.is_file() and not IGNORED & set(path.parts) and (not suffixes or path.suffix in suffixes)
    )


def modules(root: Path = ROOT) -> list[Path]:
    """Return every Python module of both packages."""
    return files(*PACKAGES, suffixes=(".py",), root=root)


def module_name(path: Path, root: Path = ROOT) -> str:
    """Return the dotted name of a module file."""
    parts = path.relative_to(root).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def parse(path: Path) -> ast.Module:
    """Return the syntax tree of a file."""
    return ast.parse(path.read_text(encoding="utf-8"), filename=str(path))


def public_names(tree: ast.Module) -> list[str] | None:
    """Return the literal ``__all__`` of a module, or None when it has none."""
    for node in tree.body:
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
        if any(isinstance(t, ast.Name) and t.id == "__all__" for t in targets):
            return list(ast.literal_eval(node.value))
    return None


def defined_names(tree: ast.Module) -> dict[str, ast.AST]:
    """Return what a module binds at its top level (functions, classes, values, imports), with the node."""
    return {name: node for statement in _statements(tree.body) for name, node in _bound(statement)}


def _statements(body: list[ast.stmt]) -> Iterator[ast.stmt]:
    for node in body:
        yield node
        for part in ("body", "orelse", "handlers", "finalbody"):
            if isinstance(node, ast.If | ast.Try | ast.ExceptHandler | ast.With):
                yield from _statements(getattr(node, part, []))


def _bound(node: ast.stmt) -> Iterator[tuple[str, ast.AST]]:
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        yield node.name, node
    elif isinstance(node, ast.Import | ast.ImportFrom):
        for alias in node.names:
            yield (alias.asname or alias.name).split(".")[0], node
    elif isinstance(node, ast.Assign | ast.AnnAssign):
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        for target in targets:
            for leaf in ast.walk(target):
                if isinstance(leaf, ast.Name):
                    yield leaf.id, node
