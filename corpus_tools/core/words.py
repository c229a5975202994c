"""Numbers in sentences."""

from __future__ import annotations

__all__ = ["counted"]


def counted(n: int, one: str, many: str = "") -> str:
    """Return "1 recording" or "2 recordings"; `many` for what does not form its plural with an s."""
    return f"{n} {one}" if n == 1 else f"{n} {many or one + 's'}"
