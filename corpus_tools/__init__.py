"""Library and batch command for speech animation from captured motion fragments."""

__all__ = ["__version__"]

__version__ = "0.1.0"
