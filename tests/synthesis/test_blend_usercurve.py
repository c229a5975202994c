import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from corpus_tools.core import InputError
from corpus_tools.synthesis import (
    DEFAULT_CURVE,
    curve_order,
    curve_through,
    user_weighting,
    weighting,
)

GRID = np.linspace(0, 1, 2001)
shares = st.one_of(st.just(0.0), st.floats(1e-3, 1e3))
weights = st.lists(shares, min_size=4, max_size=30).filter(any)
handles = st.lists(st.tuples(st.floats(0, 1), st.floats(0, 1)), min_size=1, max_size=9)


@given(weights, st.floats(-1, 1))
def test_every_choice_of_weights_falls_from_one_to_zero(chosen, shape):
    g = weighting("user", shape, chosen)(GRID)
    assert g[0] == 1
    assert g[-1] == 0
    assert (np.diff(g) <= 1e-14).all()


@given(weights)
def test_the_order_at_both_ends_is_the_one_that_is_stated(chosen):
    """1 - g(h) and g(1 - h) fall at least as h^(k+1) when k derivatives vanish: by one-sided differences."""
    order = curve_order(chosen)
    h = np.array([1.0, 2.0]) * 0.2 / len(chosen) * 2.0 ** -(8 / (order + 1))
    g = user_weighting(chosen)
    used = [(np.flatnonzero(w)[0], fall) for w, fall in ((chosen, 1 - g(h)), (chosen[::-1], g(1 - h)))]
    for zeros, fall in used:
        if fall[0] > 1e-11:
            assert np.log2(fall[1] / fall[0]) > order + 0.5
        else:
            assert zeros > order or fall[1] < 1e-9
    assert order == min(3, *(zeros for zeros, _ in used))


@given(st.lists(st.floats(0.1, 1), min_size=1, max_size=12), st.integers(0, 3), st.integers(0, 3))
def test_zeros_at_both_ends_are_the_order(inner, before, after):
    assume(len(inner) + before + after >= 4)
    assert curve_order([0.0] * before + inner + [0.0] * after) == min(before, after)


@given(st.lists(st.floats(0.2, 1), min_size=2, max_size=9))
def test_two_zeros_at_both_ends_make_the_curve_c2_everywhere(inner):
    """Velocity and acceleration of g go on across the ends and across every knot."""
    g = weighting("user", 0.0, (0.0, 0.0, *inner, 0.0, 0.0))
    at = np.linspace(0, 1, len(inner) + 2)[:, None]
    h = 1e-3
    before = [g(at - k * h) for k in range(4)]
    after = [g(at + k * h) for k in range(4)]
    speed = [sign * (-1.5 * s[0] + 2 * s[1] - 0.5 * s[2]) / h for sign, s in ((-1, before), (1, after))]
    bend = [(2 * s[0] - 5 * s[1] + 4 * s[2] - s[3]) / h**2 for s in (before, after)]
    steep = np.abs(np.diff(g(GRID), 3)).max() / GRID[1] ** 3
    np.testing.assert_allclose(speed[0], speed[1], atol=h**2 * steep + 1e-9)
    np.testing.assert_allclose(bend[0], bend[1], atol=4 * h * steep + 1e-5)


def test_four_weights_are_the_bernstein_polynomials():
    g = user_weighting((1.0, 2.0, 5.0, 2.0))
    falls = [1.0, 0.9, 0.7, 0.2, 0.0]
    binomial = [1, 4, 6, 4, 1]
    terms = zip(falls, binomial, range(5), strict=True)
    expected = sum(c * b * GRID**i * (1 - GRID) ** (4 - i) for c, b, i in terms)
    np.testing.assert_allclose(g(GRID), expected, atol=1e-14)


@given(weights, st.floats(1e-3, 1e3))
def test_only_the_shares_count(chosen, factor):
    other = user_weighting([factor * w for w in chosen])
    np.testing.assert_allclose(other(GRID), user_weighting(chosen)(GRID), atol=1e-12)


@given(weights)
def test_weights_backwards_are_the_curve_backwards(chosen):
    np.testing.assert_allclose(
        user_weighting(chosen[::-1])(1 - GRID), 1 - user_weighting(chosen)(GRID), atol=1e-12
    )


@given(handles)
def test_any_handles_give_a_c2_curve(points):
    found = curve_through(points)
    assert curve_order(found) >= 2
    assert sum(found) == pytest.approx(1, abs=1e-4)
    assert curve_through(points) == found


@given(st.lists(st.floats(0.05, 1), min_size=12, max_size=12), st.integers(1, 6))
def test_handles_on_a_curve_of_the_family_are_passed_through(inner, n):
    g = user_weighting((0.0, 0.0, *inner, 0.0, 0.0))
    u = np.linspace(0, 1, n + 2)[1:-1]
    found = user_weighting(curve_through(list(zip(u, g(u), strict=True))))
    np.testing.assert_allclose(found(u), g(u), atol=3e-3)


@pytest.mark.parametrize("name", ["smoothstep", "raised-cosine", "smootherstep", "septic", "bump"])
@pytest.mark.parametrize("shape", [-0.5, 0.0, 0.5])
def test_the_other_curves_can_be_drawn_with_five_handles(name, shape):
    g = weighting(name, shape)
    u = np.array([0.15, 0.35, 0.5, 0.65, 0.85])
    drawn = user_weighting(curve_through(list(zip(u, g(u), strict=True))))
    np.testing.assert_allclose(drawn(GRID), g(GRID), atol=0.035)


def test_handles_that_ask_for_a_rise_are_met_half_way():
    g = user_weighting(curve_through([(0.4, 0.3), (0.6, 0.7)]))
    assert g(np.array([0.4, 0.6])) == pytest.approx([0.5, 0.5], abs=0.01)


@pytest.mark.parametrize("bad", [(1, 1, 1), (1, -1, 1, 1), (0,) * 4, (1, 1, np.nan, 1), (np.inf,) * 4, ()])
def test_weights_that_are_none_are_refused(bad):
    with pytest.raises(InputError, match=r"weights of the slope of g\(u\) are \(.*four or more numbers"):
        user_weighting(bad)
    with pytest.raises(InputError):
        curve_order(bad)
    assert weighting("linear", 0.0, bad)(np.array([0.5])) == 0.5


def test_handles_that_are_none_are_refused():
    for bad in ([], [(0.5, 1.2)], [(np.nan, 0.5)], [(0.5,)]):
        with pytest.raises(InputError, match=r"handles of g\(u\) must be pairs"):
            curve_through(bad)
    with pytest.raises(InputError, match="5 weights or more; 4"):
        curve_through([(0.5, 0.5)], 4)


def test_the_default_is_c2_and_symmetric():
    assert curve_order(DEFAULT_CURVE) == 2
    assert list(DEFAULT_CURVE) == list(reversed(DEFAULT_CURVE))
