"""The families of g(u): what each costs, and how rough the joins are that it makes."""

from __future__ import annotations

import numpy as np

from corpus_tools.cli.bench.rows import BENCHMARKS, Ground, Row
from corpus_tools.config import config_with
from corpus_tools.core import FloatArray
from corpus_tools.pipeline import blend_units
from corpus_tools.synthesis import WEIGHTINGS, weighting

__all__ = ["measure_weightings"]

N_POINTS = 1_000_000


def _peak_mm_s2(values_mm: FloatArray, rate_hz: float) -> float:
    """Return the 99th percentile of the acceleration over markers and frames."""
    acceleration = np.diff(values_mm, 2, axis=0) * rate_hz**2
    return float(np.percentile(np.linalg.norm(acceleration, axis=-1), 99))


@BENCHMARKS.register("weightings")
def measure_weightings(ground: Ground) -> list[Row]:
    """Measure each family on a million points, and the acceleration of the sentence it blends."""
    u = np.linspace(0.0, 1.0, round(ground.scale * N_POINTS))
    rows = []
    for name in WEIGHTINGS:
        g = weighting(name)
        rows.append(Row(f"g(u) {name}: {len(u)} points", ground.best_ms(lambda g=g: g(u))))  # type: ignore[misc]
    rate = ground.config.alignment.rate_hz
    for name in WEIGHTINGS:
        settings = config_with(ground.config, blend__weighting=name)
        trajectory = blend_units(ground.corpus, ground.target, ground.pieces, settings)
        peak = _peak_mm_s2(np.asarray(trajectory.values_mm), rate)
        rows.append(Row(f"g(u) {name}: 99 % of accelerations are below", peak, "mm/s2"))
    return rows
