import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.config import Config, config_with
from corpus_tools.core import ConfigError, InputError
from corpus_tools.speech import phone_set
from corpus_tools.synthesis import (
    WEIGHTINGS,
    align_fragments,
    blend_pieces,
    parse_weighting_at,
    weighting,
    weightings_of_joins,
)
from tests.strategies.fragments import NAMES, seeds, spliced

CLASSES = phone_set("arpabet").display_classes
PHONES = ("B", "AA", "S", "B")
names = st.sampled_from(sorted(WEIGHTINGS))
shapes = st.floats(-1, 1).map(lambda v: round(v, 3))
U = np.linspace(0, 1, 31)


def told(*exceptions: str) -> list[str]:
    found = weightings_of_joins(PHONES, ("smootherstep", 0.0), exceptions, CLASSES)
    return [name for name, _ in found]


@given(names, shapes)
def test_an_exception_is_read_as_it_is_written(name, shape):
    rule = parse_weighting_at(f"bilabial={name}:{shape}")
    assert (rule.where, rule.weighting, rule.shape) == ("bilabial", name, shape)
    ((_, g), *_) = weightings_of_joins(PHONES, ("linear", 0.0), [f"bilabial={name}:{shape}"], CLASSES)
    np.testing.assert_array_equal(g(U), weighting(name, shape)(U))


def test_the_join_goes_before_its_phone_and_the_phone_before_its_class():
    everyone = ["smootherstep"] * 4
    assert told() == everyone
    assert told("bilabial=linear") == ["linear", "smootherstep", "smootherstep", "linear"]
    assert told("B=septic", "bilabial=linear") == ["septic", "smootherstep", "smootherstep", "septic"]
    assert told("3=bump", "B=septic", "bilabial=linear")[3] == "bump"
    assert told("B=septic", "B=linear")[0] == "linear"
    assert told("02=bump") == ["smootherstep", "smootherstep", "bump", "smootherstep"]


@given(seeds, names, st.integers(0, 2))
def test_an_exception_changes_the_motion_at_its_join_and_nowhere_else(seed, name, which):
    aligned = align_fragments(*spliced(np.random.default_rng(seed), n_units=4), names=NAMES)
    plain = blend_pieces(aligned, weighting="septic")
    changed = blend_pieces(aligned, weighting="septic", weighting_at=[f"{which}={name}"])
    join = plain.joins[which]
    outside = np.abs(plain.times_s - join.time_s) > 0.5 * join.overlap_s
    np.testing.assert_array_equal(changed.values_mm[outside], plain.values_mm[outside])
    every = blend_pieces(aligned, weighting=name)
    np.testing.assert_allclose(changed.values_mm[~outside], every.values_mm[~outside], atol=1e-9)


@pytest.mark.parametrize(
    ("texts", "words"),
    [
        (["7=linear"], ["join 7", "4 joins"]),
        (["bilabal=linear"], ["'bilabal'", "bilabial", "Classes:"]),
        (["QQ=linear"], ["'QQ'", "no phone"]),
        (["linear"], ["'linear'", "where=name"]),
        (["B=linear:x"], ["where=name"]),
        (["B=linear:1.2.3"], ["where=name"]),
        (["B=linear:1.5"], ["1.5", "-1"]),
        (["B=liner"], ["liner", "linear"]),
    ],
)
def test_an_exception_that_names_nothing_is_told_in_a_sentence(texts, words):
    with pytest.raises(InputError) as told_:
        weightings_of_joins(PHONES, ("linear", 0.0), texts, CLASSES)
    for word in words:
        assert word in str(told_.value)


def test_a_config_holds_exceptions_and_refuses_what_is_none():
    config = config_with(Config(), blend__weighting_at=("bilabial=septic", "3=linear:-0.2"))
    assert config.blend.weighting_at == ("bilabial=septic", "3=linear:-0.2")
    with pytest.raises(ConfigError, match=re.escape("blend.weighting_at")):
        config_with(Config(), blend__weighting_at=("bilabial",))
