"""Pictures of an evaluation: axes that hold every value, however close they lie together."""

from __future__ import annotations

import re

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.evaluate import Estimate
from corpus_tools.evaluate.drawing import interval_plot, scatter_plot, ticks

numbers = st.floats(-1e6, 1e6, allow_subnormal=False).map(lambda v: round(v, 6))


@given(numbers, st.floats(0, 1e6).map(lambda v: round(v, 6)))
def test_an_axis_holds_its_values_and_has_a_length(low, span):
    at = ticks(low, low + span)
    assert 2 <= len(at) <= 15
    step = at[1] - at[0]
    assert step > 0
    assert at[0] <= low + 1e-6 * step
    assert at[-1] >= low + span - 1e-6 * step
    np.testing.assert_allclose(np.diff(at), step, rtol=1e-6)


def test_equal_values_are_drawn():
    drawn = interval_plot([("a<b", Estimate(0.0, 0.0, 0.0, 3)), ("c", Estimate(0.0, 0.0, 0.0, 3))], "r", None)
    assert "a&lt;b" in drawn
    assert drawn.count("<circle") == 2
    assert "nan" not in drawn
    assert "inf" not in drawn


def test_every_point_lies_inside_the_picture():
    points = [(f"m{i}", 1.0 + 0.001 * i, 5.0 - i) for i in range(5)]
    drawn = scatter_plot(points, "x", "y", natural_y=0.3)
    width, height = (float(re.search(rf'{k}="(\d+)"', drawn)[1]) for k in ("width", "height"))
    places = re.findall(r'<circle cx="([\d.]+)" cy="([\d.]+)"', drawn)
    assert len(places) == 5
    for x, y in places:
        assert 0 < float(x) < width
        assert 0 < float(y) < height
    numbers = re.findall(r'<text x="([\d.]+)" y="([\d.]+)" text-anchor="start"[^>]*>(\d)</text>', drawn)
    assert [n for _, _, n in numbers] == list("12345")
    assert len({(x, y) for x, y, _ in numbers}) == 5
    for k in range(5):
        assert f">{k + 1}  m{k}</text>" in drawn
