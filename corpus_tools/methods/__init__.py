"""Every way from timed phones to marker motion, by id."""

from corpus_tools.methods.registry import METHODS, FragmentMethod

__all__ = ["METHODS", "FragmentMethod"]
