"""One module text out of several files: relative imports cannot be resolved inside a notebook."""

from __future__ import annotations

import functools
import re
from pathlib import Path

from workbench.views.theme import FRONTEND

__all__ = ["esm", "join_modules"]

_IMPORT = re.compile(r'^import\s*\{([^}]*)\}\s*from\s*"([^"]+)";[ \t]*\n?', re.MULTILINE)
_ANY_IMPORT = re.compile(r"^import\b.*$", re.MULTILINE)
_EXPORT = re.compile(
    r"^export\s+((?:async\s+)?function\*?|class|const|let)\s+([A-Za-z_$][\w$]*)", re.MULTILINE
)
_ANY_EXPORT = re.compile(r"^export\b.*$", re.MULTILINE)


def _variable(name: str) -> str:
    return f"module_{name}"


def _module_name(path: str, importer: str) -> str:
    match = re.fullmatch(r"\./(\w+)\.js", path)
    if match is None:
        raise ValueError(f'{importer}.js imports "{path}"; only files beside it ("./name.js") can be joined.')
    return match.group(1)


def _binding(names: str) -> str:
    """Turn the names of an import, ``a, b as c``, into those of a destructuring, ``a, b: c``."""
    parts = [re.sub(r"\s+as\s+", ": ", part.strip()) for part in names.split(",")]
    return ", ".join(part for part in parts if part)


def _imported(names: str) -> set[str]:
    """Return what an import, ``a, b as c``, asks of the other module."""
    return {part.split()[0] for part in names.split(",") if part.strip()}


def _wrap(name: str, text: str) -> tuple[str, list[tuple[str, set[str]]]]:
    """Return a module as the text of a function called at once, and what it needs of which modules."""
    needs: list[tuple[str, set[str]]] = []

    def take_import(match: re.Match[str]) -> str:
        needed = _module_name(match.group(2), name)
        needs.append((needed, _imported(match.group(1))))
        return f"const {{ {_binding(match.group(1))} }} = {_variable(needed)};\n"

    body = _IMPORT.sub(take_import, text)
    if (left := _ANY_IMPORT.search(body)) is not None:
        raise ValueError(
            f'{name}.js: "{left.group(0)}" cannot be joined; write import {{ a }} from "./x.js";'
        )
    names = [match.group(2) for match in _EXPORT.finditer(body)]
    body = _EXPORT.sub(r"\1 \2", body)
    if (left := _ANY_EXPORT.search(body)) is not None:
        raise ValueError(f'{name}.js: "{left.group(0)}" cannot be joined; export declarations by name.')
    returned = f"return {{ {', '.join(names)} }};"
    return f"const {_variable(name)} = (() => {{\n{body.rstrip()}\n{returned}\n}})();\n", needs


def _check_exports(name: str, wanted: set[str], wrapped: str, by: str) -> None:
    """Refuse an import of what a module does not export: in a browser it would be undefined, silently."""
    returned = re.search(r"return {([^}]*)};\n}\)\(\);\n$", wrapped)
    missing = wanted - {n.strip() for n in (returned.group(1) if returned else "").split(",")}
    if missing:
        raise ValueError(f"{name}.js does not export '{min(missing)}', which {by} needs.")


def join_modules(name: str, render: str, folder: Path) -> str:
    """Return one module that holds `name` and everything it imports, and exports ``{render}``.

    Every file becomes a function that is called at once and returns what it exports, so that private names of
    two files never meet. Each stands once, before those that need it.

    Parameters
    ----------
    name : str
        File in `folder`, without ``.js``.
    render : str
        Its exported function that Panel calls.
    folder : path

    Raises
    ------
    ValueError
        An import or export of another form than ``import { a } from "./x.js";`` and ``export function``,
        ``class``, ``const``; files that import one another; a name that is not exported.
    FileNotFoundError
        A file is not there.
    """
    done: dict[str, str] = {}

    def visit(module: str, above: tuple[str, ...]) -> None:
        if module in above:
            raise ValueError(f"{' -> '.join([*above, module])}: these modules import one another.")
        if module in done:
            return
        text, needs = _wrap(module, (folder / f"{module}.js").read_text(encoding="utf-8"))
        for needed, names in needs:
            visit(needed, (*above, module))
            _check_exports(needed, names, done[needed], module)
        done[module] = text

    visit(name, ())
    _check_exports(name, {render}, done[name], "Panel")
    return "".join(done.values()) + f"export default {{ render: {_variable(name)}.{render} }};\n"


@functools.cache
def esm(name: str, render: str) -> str:
    """Return the module of a component, made of the files of the front end (see :func:`join_modules`)."""
    return join_modules(name, render, FRONTEND)
