"""The committed list of public names; run ``python tests/architecture/public_names.py`` to write it anew."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from architecture import house

LIST = Path(__file__).with_name("public_names.txt")


def current() -> list[str]:
    """Return ``module: name, name`` lines for every module that has public names."""
    lines = []
    for path in house.modules():
        names = house.public_names(house.parse(path))
        if names:
            lines.append(f"{house.module_name(path)}: {', '.join(sorted(names))}")
    return sorted(lines)


if __name__ == "__main__":
    LIST.write_text("\n".join(current()) + "\n", encoding="utf-8")
