"""Pictures of an evaluation: axes that hold every value, however close they lie together."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.evaluate import Estimate
from corpus_tools.evaluate.drawing import interval_plot, scatter_plot, ticks
from corpus_tools.evaluate.numbers import interval_text, value_text

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


def test_names_start_inside_the_picture_and_end_before_the_dots():
    """A letter of the widest usual font (DejaVu Sans, 12 px) is 7.4 px on average."""
    name = "greedy:remove_bias=off+closure=off+mode=inertial"
    drawn = interval_plot(
        [(name, Estimate(1.0, 0.5, 1.5, 3)), ("mean", Estimate(2.0, 2.0, 2.0, 3))], "r", 0.1
    )
    starts = re.findall(r'<text x="([\d.]+)" [^>]*text-anchor="start"[^>]*>(?:greedy|mean)', drawn)
    assert [float(x) for x in starts] == [4.0, 4.0]
    dots = [float(x) for x in re.findall(r'<circle cx="([\d.]+)"', drawn)]
    assert min(dots) > 4 + 7.4 * len(name)


@given(st.floats(-100, 100), st.floats(0, 10), st.floats(0, 10))
def test_a_value_is_printed_with_its_interval_and_inside_it(value, below, above):
    found = Estimate(value, value - below, value + above, 5)
    text, interval = value_text(found), interval_text(found)
    assert "e" not in text + interval
    assert text != "-0"
    if interval:
        low, high = map(float, interval.split(" – "))
        assert low < high
        assert low <= float(text) <= high
        assert abs(high - low - below - above) <= 0.11 * (below + above) + 1e-4
    assert float(text) == pytest.approx(value, abs=0.05 * (below + above) + 1e-3)


def test_rounding_is_not_printed():
    assert value_text(Estimate(2.58e-14, 2.52e-14, 2.63e-14, 9)) == "0"
    assert interval_text(Estimate(2.58e-14, 2.52e-14, 2.63e-14, 9)) == ""
    assert value_text(Estimate(0.99999999, 0.99999998, 1.0, 9)) == "1"
    assert interval_text(Estimate(0.99999999, 0.99999998, 1.0, 9)) == ""
    assert value_text(None) == value_text(Estimate(float("nan"), 0, 0, 0)) == "–"
    assert value_text(Estimate(1.0661, 0.886, 1.203, 9)) == "1.07"
    assert interval_text(Estimate(1.0661, 0.886, 1.203, 9)) == "0.89 – 1.20"


def test_a_number_that_gave_way_is_led_to_its_point():
    apart = scatter_plot([("a", 1.0, 1.0), ("b", 2.0, 2.0)], "x", "y", natural_y=0.3)
    close = scatter_plot([("a", 1.0, 1.0), ("b", 1.0, 1.001), ("c", 9.0, 2.0)], "x", "y", natural_y=0.3)
    leader = r'<line x1="([\d.]+)" y1="([\d.]+)" [^>]*stroke-width="0.6"'
    assert re.findall(leader, apart) == []
    [(x, y)] = re.findall(leader, close)
    assert f'<circle cx="{x}" cy="{y}"' in close


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
