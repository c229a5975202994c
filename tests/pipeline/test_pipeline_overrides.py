"""Pins and bans of a config: their text and back, obeyed by the search, refused in one sentence."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.config import Config, config_from_dict, config_with
from corpus_tools.core import ConfigError, InputError, UnitRef
from corpus_tools.pipeline import ban_of, parse_pin, pin_text, select_units

NAMES = st.text("ab:=-/ 0123", min_size=1, max_size=8)


@given(NAMES, *[st.integers(0, 999)] * 4)
def test_a_pin_is_read_as_it_was_written(name, first, last, i, j):
    unit = UnitRef(name, i, j)
    text = pin_text(first, last, unit)
    assert parse_pin(text) == (first, last, unit)
    assert ban_of(unit.key) == unit
    assert config_from_dict({"overrides": {"pins": [text]}}).overrides.pins == (text,)


def test_what_is_no_unit_names_a_recording():
    assert ban_of("time01") == "time01"


@pytest.mark.parametrize("bad", ["", "time01:1-2", "1-2=time01", "1-2=time01:3", "a-b=time01:1-2"])
def test_what_is_no_pin_is_refused(bad):
    with pytest.raises(InputError, match="no pin"):
        parse_pin(bad)
    with pytest.raises(ConfigError, match=r"overrides\.pins"):
        config_from_dict({"overrides": {"pins": [bad]}})


def test_the_search_obeys_the_config(opened_corpus):
    utterance = opened_corpus.utterance("time05")
    plain = select_units(opened_corpus, utterance, Config(), ["time05"])
    place = next(c for c in plain.chosen if any(r.unit.last - r.unit.first > 0 for r in c.rejected))
    other = place.rejected[0].unit
    pin = pin_text(place.first, place.first + other.last - other.first, other)
    config = config_with(Config(), overrides__pins=[pin], overrides__bans=[plain.chosen[0].unit.recording])
    for method in ("greedy", "viterbi"):
        found = select_units(
            opened_corpus, utterance, config_with(config, selection__method=method), ["time05"]
        )
        spoken = next(c for c in found.chosen if c.first <= place.first < c.last)
        assert spoken.unit.recording == other.recording
        assert spoken.unit.first - spoken.first == other.first - place.first
        banned = plain.chosen[0].unit.recording
        assert banned == other.recording or banned not in {c.unit.recording for c in found.chosen}


def test_a_pin_of_another_sentence_is_one_sentence(opened_corpus):
    utterance = opened_corpus.utterance("time05")
    config = config_with(Config(), overrides__pins=["900-903=time02:1-4"])
    with pytest.raises(InputError, match="inside the target"):
        select_units(opened_corpus, utterance, config)
