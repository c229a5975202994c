"""Views."""

__all__: list[str] = []
