import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import InputError
from corpus_tools.synthesis import WEIGHTINGS, weighting
from corpus_tools.synthesis.weighting import crossover

# derivatives that vanish at both ends, largest slope and largest curvature
CONTACT = {
    "linear": 0,
    "raised-cosine": 1,
    "smoothstep": 1,
    "smootherstep": 2,
    "septic": 3,
    "exponential": 0,
    "sigmoid": 0,
    "bump": np.inf,
    "user": 2,
}
STEEPEST = {"raised-cosine": (1.571, 4.93), "smoothstep": (1.5, 6), "smootherstep": (1.875, 5.77)}
STEEPEST |= {"septic": (2.19, 7.51), "exponential": (6.0, 36), "sigmoid": (2.5, 9.8)}
STEEPEST |= {"bump": (2.0, 9.84), "user": (1.35, 9.09)}
GRID = np.linspace(0, 1, 20_001)
shapes = st.floats(-1, 1)
names = pytest.mark.parametrize("name", list(WEIGHTINGS))


def test_every_weighting_is_looked_at():
    assert set(CONTACT) == set(WEIGHTINGS)


@names
@given(shape=shapes)
def test_it_falls_from_one_to_zero(name, shape):
    g = weighting(name, shape)(GRID)
    assert g[0] == pytest.approx(1, abs=1e-15)
    assert g[-1] == pytest.approx(0, abs=1e-15)
    assert (np.diff(g) <= 1e-14).all()
    assert g.min() >= 0
    assert g.max() <= 1


@names
def test_outside_the_overlap_only_one_fragment_counts(name):
    np.testing.assert_allclose(
        weighting(name, 0.3)(np.array([-2.0, -1e-9, 1 + 1e-9, 7.0])), [1, 1, 0, 0], atol=1e-6
    )


@names
@given(shape=shapes)
def test_its_order_of_contact_is_kept_by_the_shape(name, shape):
    """1 - g(h) and g(1 - h) fall as h^(k+1) when k derivatives vanish: by one-sided differences."""
    order = CONTACT[name]
    if order == np.inf:
        falls = weighting(name, shape)(1 - np.array([0.012, 0.024]))
        assert np.log2(falls[1] / falls[0]) > 6  # as if six derivatives vanished, and more for smaller steps
        return
    h = 1e-11 ** (1 / (order + 1))
    g = weighting(name, shape)
    steps = np.array([h, 2 * h])
    for fall in (1 - g(steps), g(1 - steps)):
        assert np.log2(fall[1] / fall[0]) == pytest.approx(order + 1, abs=0.15)


@names
def test_slope_and_curvature_are_those_of_the_table(name):
    if name == "linear":
        np.testing.assert_allclose(weighting(name)(GRID), 1 - GRID, atol=1e-15)
        return
    g, step = weighting(name)(GRID), GRID[1]
    slope, curvature = STEEPEST[name]
    assert np.abs(np.diff(g)).max() / step == pytest.approx(slope, rel=0.02)
    assert np.abs(np.diff(g, 2)).max() / step**2 == pytest.approx(curvature, rel=0.02)


@pytest.mark.parametrize("name", [n for n in CONTACT if n != "exponential"])
def test_without_a_shape_both_halves_are_alike(name):
    g = weighting(name)(GRID)
    np.testing.assert_allclose(g + g[::-1], 1, atol=1e-12)


@names
@given(shape=st.floats(-1, 0.95), u=st.floats(0.05, 0.95))
def test_a_greater_shape_holds_the_first_fragment_longer(name, shape, u):
    earlier, later = (float(weighting(name, s)(np.array(u))) for s in (shape, shape + 0.05))
    assert later > earlier or (later == earlier and not 1e-15 < earlier < 1 - 1e-15)


@given(shapes)
def test_the_crossover_is_undone_by_its_opposite(shape):
    np.testing.assert_allclose(crossover(crossover(GRID, shape), -shape), GRID, atol=1e-14)


def test_what_does_not_exist_is_refused():
    with pytest.raises(InputError, match=r"no weighting function called 'smoothstp'.*'smoothstep'"):
        weighting("smoothstp")
    with pytest.raises(InputError, match=r"shape of g\(u\) is 1.5"):
        weighting("linear", 1.5)
