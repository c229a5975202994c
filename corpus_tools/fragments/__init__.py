"""Fragments of captured speech: the index of all units, cutting, coverage and views by kind."""

from corpus_tools.fragments.band import natural_band
from corpus_tools.fragments.coverage import CoverageReport, UtteranceCoverage, coverage
from corpus_tools.fragments.cutting import cut_fragment
from corpus_tools.fragments.inventory import (
    build_inventory,
    diphone_keys,
    diphone_rows,
    find_spans,
    phone_codes,
    recording_mask,
)
from corpus_tools.fragments.views import UnitViews, unit_views

__all__ = [
    "CoverageReport",
    "UnitViews",
    "UtteranceCoverage",
    "build_inventory",
    "coverage",
    "cut_fragment",
    "diphone_keys",
    "diphone_rows",
    "find_spans",
    "natural_band",
    "phone_codes",
    "recording_mask",
    "unit_views",
]
