"""Apps."""

__all__: list[str] = []
