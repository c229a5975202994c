"""Counts with their nouns."""

from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import counted


@given(st.integers(0, 10**6))
def test_only_one_is_singular(n):
    assert counted(n, "recording") == f"{n} recording" + ("" if n == 1 else "s")
    assert counted(n, "vertex", "vertices").endswith("vertex" if n == 1 else "vertices")
