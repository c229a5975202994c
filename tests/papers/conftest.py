"""What tests of the papers share: the modules with the tests are named after their subject, not test_*."""

from __future__ import annotations

import pytest

for subject in (
    "alignment",
    "bids",
    "blending",
    "corpus",
    "equations",
    "future",
    "preprocessing",
    "results",
    "retarget",
    "selection",
    "units",
):
    pytest.register_assert_rewrite(f"tests.papers.paper_a.{subject}")
