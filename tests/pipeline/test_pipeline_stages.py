"""Stages: what depends on what, held-out sentences, and a whole that equals its parts."""

import dataclasses

import numpy as np
import pytest

from corpus_tools.config import Config, config_with
from corpus_tools.core import InputError, UnitRef
from corpus_tools.pipeline import (
    align_units,
    animate,
    blend_units,
    prepare_head,
    select_units,
    synthesise,
    vertex_frames,
)
from corpus_tools.speech import lip_aperture_mm

HELD_OUT = "time05"


@pytest.fixture(scope="module")
def utterance(opened_corpus):
    return opened_corpus.utterance(HELD_OUT)


def blended(corpus, utterance, config):
    selection = select_units(corpus, utterance, config, [HELD_OUT])
    pieces = align_units(corpus, utterance, selection, config)
    return blend_units(corpus, utterance, pieces, config)


@pytest.mark.parametrize("method", ["greedy", "viterbi"])
def test_a_held_out_recording_is_not_used_and_one_in_the_inventory_speaks_itself(
    opened_corpus, utterance, method
):
    config = config_with(Config(), selection__method=method)
    held_out = select_units(opened_corpus, utterance, config, [HELD_OUT])
    used = {c.unit.recording for c in held_out.chosen}
    assert HELD_OUT not in used
    assert len(used) > 1
    (itself,) = select_units(opened_corpus, utterance, config).chosen
    assert itself.unit == UnitRef(HELD_OUT, 0, len(utterance.labels) - 1)


@pytest.mark.parametrize(
    "changes",
    [
        {"blend__weighting": "linear"},
        {"blend__shape": 0.7},
        {"blend__overlap_s": 0.03},
        {"blend__rule": "paper"},
        {"closure__project": False},
    ],
)
def test_the_blend_changes_the_motion_and_not_the_selection(opened_corpus, utterance, changes):
    before, after = Config(), config_with(Config(), **changes)
    one, two = (select_units(opened_corpus, utterance, c, [HELD_OUT]) for c in (before, after))
    assert one.chosen == two.chosen
    pieces = align_units(opened_corpus, utterance, one, before)
    moved = [np.asarray(blend_units(opened_corpus, utterance, pieces, c).values_mm) for c in (before, after)]
    assert moved[0].shape == moved[1].shape
    assert 1e-3 < np.abs(moved[0] - moved[1]).max() < 10.0


def test_every_selection_setting_reaches_the_search(opened_corpus, utterance):
    def chosen(**changes):
        config = config_with(Config(), **changes)
        return select_units(opened_corpus, utterance, config, [HELD_OUT])

    plain = chosen()
    for key in ("duration", "context", "join", "velocity"):
        other = chosen(**{f"selection__{key}": 20.0})
        assert other.total_cost > plain.total_cost, key
    assert chosen(selection__prune=1).total_cost >= plain.total_cost


def test_pins_are_used_and_bans_are_not(opened_corpus, utterance):
    plain = select_units(opened_corpus, utterance, Config(), [HELD_OUT])
    first = plain.chosen[1]
    banned = select_units(opened_corpus, utterance, Config(), [HELD_OUT], bans=[first.unit.recording])
    assert first.unit.recording not in {c.unit.recording for c in banned.chosen}
    pins = [(c.first, c.last, c.unit) for c in banned.chosen[:2]]
    pinned = select_units(opened_corpus, utterance, Config(), [HELD_OUT], pins=pins)
    assert all(pin in [(c.first, c.last, c.unit) for c in pinned.chosen] for pin in pins)


def test_an_unknown_method_is_refused_by_name(opened_corpus, utterance):
    config = config_with(Config(), selection__method="viterbl")
    with pytest.raises(InputError, match=r"viterbl.*viterbi"):
        select_units(opened_corpus, utterance, config)


@pytest.mark.parametrize("rate_hz", [60.0, 120.0])
def test_motion_covers_the_utterance_at_the_asked_rate(opened_corpus, utterance, rate_hz):
    trajectory = blended(opened_corpus, utterance, config_with(Config(), alignment__rate_hz=rate_hz))
    assert trajectory.times_s[0] == 0.0
    np.testing.assert_allclose(np.diff(trajectory.times_s), 1 / rate_hz, atol=1e-9)
    assert trajectory.times_s[-1] == pytest.approx(utterance.duration_s, abs=1.01 / rate_hz)
    assert trajectory.names == opened_corpus.markers
    assert np.isfinite(trajectory.values_mm).all()
    assert all(0 <= j.natural_percentile <= 100 for j in trajectory.joins)


def test_lips_close_in_every_bilabial_and_open_in_open_vowels(opened_corpus):
    lips = opened_corpus.lips
    seen = 0
    for name in opened_corpus.names[:6]:
        utterance = opened_corpus.utterance(name)
        config = Config()
        selection = select_units(opened_corpus, utterance, config, [name])
        pieces = align_units(opened_corpus, utterance, selection, config)
        trajectory = blend_units(opened_corpus, utterance, pieces, config)
        aperture = lip_aperture_mm(trajectory.values_mm, trajectory.names)
        for phone in utterance.phones:
            inside = (trajectory.times_s >= phone.start_s) & (trajectory.times_s <= phone.end_s)
            if phone.text in opened_corpus.phones.bilabials:
                assert aperture[inside].min() <= lips.target_mm + 0.15, (name, phone)
                seen += 1
            elif phone.text in {"AA", "AY", "AW", "AE"} and phone.duration_s > 0.06:  # shorter: undershoot
                assert aperture[inside].max() > 4.0, (name, phone)
    assert seen > 5


def test_a_corpus_without_bilabials_is_blended_and_left_unclosed(opened_corpus, utterance):
    config = Config()
    nothing = {"target_mm": float("nan"), "threshold_mm": float("nan")}
    on_teeth = dataclasses.replace(opened_corpus.lips.on_teeth, **nothing)
    mute = dataclasses.replace(opened_corpus.lips, on_teeth=on_teeth, **nothing)
    without = dataclasses.replace(opened_corpus, lips=mute)
    unclosed = blended(opened_corpus, utterance, config_with(config, closure__project=False))
    np.testing.assert_array_equal(blended(without, utterance, config).values_mm, unclosed.values_mm)


def test_the_whole_is_its_stages_one_after_the_other_and_again_the_same(opened_corpus, utterance):
    config = Config()
    head = prepare_head(opened_corpus, "base", config)
    whole = synthesise(opened_corpus, utterance, config, head, [HELD_OUT])
    trajectory = blended(opened_corpus, utterance, config)
    np.testing.assert_array_equal(whole.trajectory.values_mm, trajectory.values_mm)
    animation = animate(head, trajectory)
    np.testing.assert_array_equal(whole.animation.targets_mm, animation.targets_mm)
    np.testing.assert_array_equal(whole.vertices_mm, vertex_frames(head, animation))
    assert whole.selection == select_units(opened_corpus, utterance, config, [HELD_OUT])
    stages = {k: v for k, v in whole.timings_ms.items() if k != "total"}
    assert list(stages) == ["select", "align", "blend", "retarget", "deform"]
    assert whole.timings_ms["total"] == pytest.approx(sum(stages.values()))
    assert min(stages.values()) > 0
