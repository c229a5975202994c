"""Configs: every value explicit, unknown keys refused, files and values round trip."""

import os
import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.config import (
    SECTIONS,
    Config,
    config_diff,
    config_from_dict,
    config_schema,
    config_text,
    config_with,
    load_config,
    write_config,
)
from corpus_tools.core import ConfigError, OutputError

NUMBERS = st.fixed_dictionaries(
    {
        "blend__shape": st.floats(-1, 1),
        "blend__overlap_s": st.floats(0, 0.5),
        "blend__curve_weights": st.lists(st.floats(0.1, 9), min_size=4, max_size=9),
        "blend__rule": st.sampled_from(["shared-phone", "paper"]),
        "selection__join": st.floats(0, 100),
        "selection__prune": st.integers(1, 10_000),
        "retarget__contact": st.booleans(),
        "selection__method": st.text(min_size=1, max_size=12),
    }
)


@given(NUMBERS)
def test_text_round_trip(values):
    config = config_with(Config(), **values)
    assert config_from_dict(tomllib.loads(config_text(config))) == config


@given(NUMBERS)
def test_diff_names_what_changed_and_nothing_else(values):
    before, after = Config(), config_with(Config(), **values)
    changed = {key: new for key, _, new in config_diff(before, after)}
    expected = {k.replace("__", "."): v for k, v in values.items()}
    defaults = {f"{s}.{k}": v for s in SECTIONS for k, v in before.values()[s].items()}
    assert changed == {k: v for k, v in expected.items() if defaults[k] != v}
    assert config_diff(after, after) == []


@pytest.mark.parametrize("name", list(SECTIONS))
def test_every_field_is_written_bounded_and_described(name):
    section = SECTIONS[name]
    assert section.__doc__
    written = tomllib.loads(config_text(Config()))[name]
    for key, field in section.model_fields.items():
        assert field.description, f"{name}.{key} has no description"
        assert key in written


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ({"corpsu": 1}, ["corpsu"]),
        ({"blnd": {}}, ["blnd", "did you mean 'blend'"]),
        ({"blend": {"overlp_s": 0.1}}, ["blend.overlp_s", "did you mean 'overlap_s'"]),
        ({"blend": {"shape": 3}}, ["blend.shape", "3", "less than or equal to 1"]),
        ({"blend": {"shape": float("nan")}}, ["blend.shape", "finite"]),
        ({"blend": {"rule": "longest"}}, ["blend.rule", "shared-phone"]),
        ({"blend": {"curve_weights": [1, 2, 3]}}, ["blend.curve_weights", "at least 4"]),
        ({"blend": {"curve_weights": [1, 2, -3, 1]}}, ["blend.curve_weights.2", "-3", "greater than"]),
        ({"blend": {"curve_weights": [0, 0, 0, 0]}}, ["blend.curve_weights", "all weights are 0"]),
        ({"blend": {"curve_weights": [1] * 500}}, ["blend.curve_weights", "1,...: ", "at most 64"]),
        ({"blend": {"curve_weights": [-1] * 5}}, ["blend.curve_weights.0", " more of its values"]),
        ({"cleaning": {"cutoff_hz": 1e-300}}, ["cleaning.cutoff_hz", "0.1"]),
        ({"cleaning": {"head_cutoff_mm": 1e-300}}, ["cleaning.head_cutoff_mm", "0.001"]),
        ({"selection": {"join": 1e308}}, ["selection.join", "1000000"]),
        ({"cleaning": {"gap_method": "dtc"}}, ["cleaning.gap_method", "did you mean 'dct'", "auto, "]),
        ({"schema": 99}, ["schema", "99"]),
        ({"schema": True}, ["schema", "True"]),
        ({"rest": {"ease_s": True}}, ["rest.ease_s", "True", "a number without quotes"]),
        ({"rest": {"ease_s": "1"}}, ["rest.ease_s", "'1'", "a number without quotes"]),
        ({"output": {"seed": False}}, ["output.seed", "False", "a number without quotes"]),
        ({"output": {"seed": 1.5}}, ["output.seed", "1.5"]),
        ({"closure": {"project": 1}}, ["closure.project", "true or false"]),
        ({"closure": {"project": "no"}}, ["closure.project", "true or false"]),
        ({"blend": {"curve_weights": [1, 2, "3", 1]}}, ["blend.curve_weights", "a number without quotes"]),
        ({"blend": {"curve_weights": [1, 2, True, 1]}}, ["blend.curve_weights", "a number without quotes"]),
        ({"overrides": {"bans": [1]}}, ["overrides.bans.0", "1"]),
        ({"blend": 3}, ["blend"]),
    ],
)
def test_bad_data_is_refused_by_name(data, words):
    with pytest.raises(ConfigError) as caught:
        config_from_dict(data, "mine.toml")
    for word in ["mine.toml", *words]:
        assert word in str(caught.value)
    assert str(caught.value).count("mine.toml") == 1  # one sentence
    assert len(str(caught.value)) < 300


@given(ease_s=st.integers(0, 1), seed=st.integers(0, 10**9))
def test_whole_numbers_are_numbers(ease_s, seed):
    config = config_from_dict({"rest": {"ease_s": ease_s}, "output": {"seed": float(seed)}})
    assert (config.rest.ease_s, config.output.seed) == (ease_s, seed)
    assert isinstance(config.rest.ease_s, float)


def test_configs_do_not_change():
    config = Config()
    with pytest.raises(Exception, match="frozen"):
        config.blend.shape = 0.5


@pytest.mark.parametrize(
    ("content", "word"),
    [
        (b"corpsu = 1\n", "corpsu"),
        (b"a = [", "TOML"),
        (b"\xff\xfe\x00", "cannot be read"),
        (b"a = " + b"[" * 100000, "cannot be read"),
        (b"a = " + b"9" * 5000, "a number in it is too long"),
        (None, "no config file"),
    ],
)
def test_bad_files_are_named(tmp_path, content, word):
    path = tmp_path / "tuned.toml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(ConfigError, match=word) as caught:
        load_config(path)
    assert "tuned.toml" in str(caught.value)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_a_pipe_and_a_folder_are_refused_and_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe.toml")
    for path, words in ((tmp_path / "pipe.toml", "no regular file"), (tmp_path, "a folder")):
        with pytest.raises(ConfigError, match=f"'{path}' cannot be read: it is {words}"):
            load_config(path)


def test_a_byte_order_mark_is_no_fault(tmp_path):
    path = tmp_path / "tuned.toml"
    path.write_bytes(b"\xef\xbb\xbf[blend]\nshape = 0.5\n")
    assert load_config(path).blend.shape == 0.5


def test_write_is_whole_or_nothing(tmp_path):
    path = tmp_path / "tuned.toml"
    config = config_with(Config(), blend__shape=0.25)
    write_config(path, config)
    assert load_config(path) == config
    assert [p.name for p in tmp_path.iterdir()] == ["tuned.toml"]
    blocker = tmp_path / "file"
    blocker.write_text("x")
    with pytest.raises(OutputError, match="file"):
        write_config(blocker / "below.toml", config)


def test_provenance_is_kept_and_does_not_count_as_a_difference():
    config = config_from_dict({"provenance": {"corpus": {"name": "simulated", "motion_sha256": "00"}}})
    again = config_from_dict(tomllib.loads(config_text(config)))
    assert again.provenance["corpus"]["name"] == "simulated"
    assert config_diff(Config(), config) == []


def test_schema_lists_every_section():
    schema = config_schema()
    assert set(SECTIONS) <= set(schema["properties"])
    assert schema["additionalProperties"] is False
