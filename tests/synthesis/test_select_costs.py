import math
from dataclasses import replace

import numpy as np
import pytest

from corpus_tools.core import InputError, Interval, LabelError, NoUnitError, Recording, Tier, UnitRef
from corpus_tools.fragments import build_inventory
from corpus_tools.synthesis import prepare_selection, select_greedy, select_viterbi
from corpus_tools.synthesis.costs import join_costs, join_matrix, span_costs
from corpus_tools.synthesis.target import JOIN_TERMS, TARGET_TERMS, prepare_target
from tests.strategies.inventories import (
    SmallPhoneSet,
    capture,
    recording,
    simulated_recordings,
    utterance,
    with_sounds,
)

SEARCHES = [select_greedy, select_viterbi]


def model_of(*recordings):
    return prepare_selection(build_inventory(recordings), SmallPhoneSet(), n_components=4)


def costs_of(search, model, target, **keywords):
    (chosen,) = search(model, target, **keywords).chosen
    return dict(chosen.costs.target)


@pytest.mark.parametrize("search", SEARCHES)
def test_timing_is_the_log_ratio_of_both_phones_of_every_diphone_without_silence(search):
    model = model_of(recording("a", ["SIL", "P", "A", "SIL"], [0.5, 0.1, 0.2, 0.5]))
    target = utterance("t", ["SIL", "P", "A", "SIL"], [0.1, 0.2, 0.1, 2.0])
    assert costs_of(search, model, target)["timing"] == pytest.approx(4 * math.log(2))
    assert costs_of(search, model, target, duration=0.5)["timing"] == pytest.approx(2 * math.log(2))


@pytest.mark.parametrize(("neighbour", "cost"), [("T", 0.0), ("D", 0.5), ("O", 1.0), ("SIL", 1.0)])
def test_context_is_nothing_half_or_whole_on_each_side(neighbour, cost):
    model = model_of(recording("a", ["SIL", neighbour, "P", "A", neighbour, "SIL"]))
    target = utterance("t", ["SIL", "T", "P", "A", "T", "SIL"])
    terms = span_costs(model, prepare_target(model, target, context=1.0), 2, np.array([2]))
    assert dict(zip(TARGET_TERMS, terms[0], strict=True))["context"] == pytest.approx(2 * cost)


def test_context_beyond_the_ends_is_silence():
    model = model_of(recording("a", ["T", "P", "A", "T"]), recording("b", ["P", "A"]))
    (chosen,) = select_greedy(model, utterance("t", ["P", "A"])).chosen
    assert chosen.unit == UnitRef("b", 0, 1)
    assert dict(chosen.costs.target)["context"] == 0.0
    assert dict(chosen.rejected[0].costs.target)["context"] == pytest.approx(0.3 * 2)


def test_a_phone_of_the_same_class_costs_the_weight_and_any_other_twice_that():
    target = utterance("t", ["SIL", "P", "SIL"])
    alike = costs_of(select_viterbi, model_of(recording("a", ["SIL", "B", "SIL"])), target)
    assert alike["backoff"] == pytest.approx(2.0)
    other = costs_of(select_viterbi, model_of(recording("a", ["SIL", "A", "SIL"])), target, backoff=1.0)
    assert other["backoff"] == pytest.approx(2.0)


@pytest.mark.parametrize("search", SEARCHES)
def test_backoff_goes_from_the_nearest_phones_to_the_farthest(search):
    steps = {
        "exact": ["SIL", "P", "A", "SIL"],
        "one by class": ["SIL", "B", "A", "SIL"],
        "both by class": ["SIL", "B", "O", "SIL"],
        "one free": ["SIL", "T", "A", "SIL"],
        "one by class, one free": ["SIL", "T", "O", "SIL"],
    }
    target = utterance("t", ["P", "A"])
    left = {name: recording(name, phones) for name, phones in steps.items()}
    for nearest in steps:
        (chosen,) = search(model_of(*left.values()), target).chosen
        assert chosen.unit.recording == nearest
        del left[nearest]


@pytest.mark.parametrize("search", SEARCHES)
def test_where_nothing_stands_in_all_missing_diphones_are_named(search):
    model = model_of(recording("a", ["SIL", "P", "SIL"]))
    with pytest.raises(NoUnitError, match="T-A, A-T, not even by viseme class") as error:
        search(model, utterance("t", ["SIL", "P", "SIL", "T", "A", "T", "SIL"]))
    assert error.value.diphones == (("T", "A"), ("A", "T"))
    assert str(error.value).endswith("record a sentence that holds it, or choose words without it.")
    with pytest.raises(NoUnitError, match="allow backoff to viseme classes"):
        search(model, utterance("t", ["SIL", "T", "SIL"]), allow_backoff=False)


@pytest.mark.parametrize("search", SEARCHES)
def test_what_is_banned_or_held_out_is_not_called_missing(search):
    model = model_of(recording("a", ["SIL", "P", "A", "SIL"]), recording("b", ["SIL", "P", "SIL"]))
    target = utterance("t", ["SIL", "P", "A", "SIL"])
    for backoff, other in ((True, ""), (False, ", or allow backoff to viseme classes")):
        every = [UnitRef("a", 0, 3), "b"]
        with pytest.raises(NoUnitError, match=rf"those that could are banned; lift a ban{other}\.$"):
            search(model, target, bans=every, allow_backoff=backoff)
        with pytest.raises(
            NoUnitError, match=rf"are held out; .*let the held-out recording be used{other}\.$"
        ):
            search(model, target, exclude=["a", "b"], allow_backoff=backoff)
    with pytest.raises(NoUnitError, match="record a sentence that holds it"):
        search(model, utterance("t", ["SIL", "T", "SIL"]), bans=["a"], allow_backoff=False)


def test_a_sentence_names_the_first_missing_diphones_and_counts_the_others():
    error = NoUnitError([("P", str(k)) for k in range(20)])
    assert "P-7 and 12 more diphones, not even" in str(error)
    assert len(error.diphones) == 20


def test_filled_frames_inside_a_unit_cost_by_their_share_and_are_avoided():
    phones, durations = ["SIL", "P", "A", "SIL"], [0.11] * 4
    spoken = utterance("a", phones, durations)
    first_diphone_and_half_of_the_last = [(6, 16), (28, 32)]  # centres at 0.055, 0.165, 0.275 and 0.385 s
    flawed = capture(spoken, np.random.default_rng(1), filled=first_diphone_and_half_of_the_last)
    filled, clean = Recording(spoken, flawed), recording("b", phones, durations)
    target = utterance("t", phones, durations)
    alone = costs_of(select_greedy, model_of(filled), target, flagged=2.0)
    assert alone["flagged"] == pytest.approx(2.0 * (1 + 5 / 11))
    (chosen,) = select_greedy(model_of(filled, clean), target).chosen
    assert chosen.unit.recording == "b"


def test_a_join_costs_the_distance_of_postures_and_velocities_at_the_shared_phone():
    model = model_of(recording("a", ["SIL", "P", "A", "SIL"]), recording("b", ["SIL", "T", "A", "P", "SIL"]))
    target = utterance("t", ["SIL", "P", "A", "P", "SIL"])
    first, second = select_greedy(model, target, join=2.0, velocity=0.5, per_join=0.25).chosen
    left = model.inventory.rows(first.unit)[1]
    right = model.inventory.rows(second.unit)[0]
    joins = model.joins
    assert dict(second.costs.join) == pytest.approx(
        {
            "position": 2.0 * np.linalg.norm(joins.position[left] - joins.position[right]),
            "velocity": 2.0 * 0.5 * np.linalg.norm(joins.velocity[left] - joins.velocity[right]),
            "each": 0.25,
        }
    )
    assert first.costs.join == ()


def test_alternatives_that_speak_less_than_the_span_speak_its_beginning():
    model = model_of(
        recording("a", ["SIL", "P", "A", "T", "SIL"]), recording("b", ["SIL", "P", "A", "D", "SIL"])
    )
    (chosen,) = select_greedy(model, utterance("t", ["SIL", "P", "A", "T", "SIL"])).chosen
    assert chosen.unit == UnitRef("a", 0, 4)
    assert [r.unit for r in chosen.rejected] == [UnitRef("b", 0, 2)]


def test_equals_are_decided_by_name_then_place():
    same = [["SIL", "P", "A", "P", "A", "SIL"]] * 2
    b, a = (Recording(s, capture(s, np.random.default_rng(3))) for s in map(utterance, ["b", "a"], same))
    for search in SEARCHES:
        (chosen,) = search(model_of(b, a), utterance("t", ["P", "A"]), context=0.0).chosen
        assert chosen.unit == UnitRef("a", 1, 2)


def pin_error(pins, **keywords):
    model = model_of(recording("a", ["SIL", "P", "A", "SIL"]))
    with pytest.raises(InputError) as error:
        select_viterbi(model, utterance("t", ["SIL", "P", "A", "SIL"]), pins=pins, **keywords)
    return str(error.value)


def test_pins_and_bans_that_do_not_fit_are_refused():
    assert "equally long" in pin_error([(0, 2, UnitRef("a", 0, 1))])
    assert "equally long" in pin_error([(3, 4, UnitRef("a", 0, 1))])
    assert "no run of at least two phones" in pin_error([(0, 1, UnitRef("a", 3, 4))])
    assert "Two pins speak target phones 1 and 2" in pin_error(
        [(0, 2, UnitRef("a", 0, 2)), (1, 2, UnitRef("a", 1, 2))]
    )
    assert "held out" in pin_error([(0, 1, UnitRef("a", 0, 1))], exclude=["a"])
    assert "'aa'" in pin_error([], bans=["aa"])
    assert "The ban 'a:2-2'" in pin_error([], bans=[UnitRef("a", 2, 2)])


@pytest.mark.parametrize("search", SEARCHES)
def test_a_pin_covers_what_nothing_else_covers(search):
    model = model_of(recording("a", ["SIL", "P", "A", "SIL"]))
    target = utterance("t", ["SIL", "T", "A", "SIL"])
    pins = [(0, 3, UnitRef("a", 0, 3))]
    (chosen,) = search(model, target, pins=pins, allow_backoff=False).chosen
    assert chosen.backoff == ((1, "T", "P"),)


def test_bad_targets_and_weights_are_refused():
    model = model_of(recording("a", ["SIL", "P", "SIL"]))
    with pytest.raises(InputError, match="at least two"):
        select_greedy(model, utterance("t", ["SIL"]))
    with pytest.raises(InputError, match="'join' is -1"):
        select_viterbi(model, utterance("t", ["SIL", "P"]), join=-1)
    with pytest.raises(InputError, match="'prune' is 0"):
        select_viterbi(model, utterance("t", ["SIL", "P"]), prune=0)
    with pytest.raises(LabelError, match="'XX'"):
        select_viterbi(model, utterance("t", ["SIL", "XX"]))


def test_settings_are_kept_with_the_selection():
    model = model_of(*simulated_recordings(6, 2))
    selection = select_viterbi(model, model.inventory.recordings[0].utterance, prune=7, context=0.6)
    settings = dict(selection.settings)
    assert (settings["prune"], settings["context"], settings["allow_backoff"]) == (7, 0.6, True)
    assert selection.method == "viterbi"


WORDS = Tier("words", (Interval(0.1, 0.3, "pa"), Interval(0.3, 0.5, "ta")))


def spoken_as(name, words=None, stress=None):
    made = recording(name, ["SIL", "P", "A", "T", "A", "SIL"], words=words)
    return Recording(replace(made.utterance, stress=stress), made.capture)


@pytest.mark.parametrize("search", SEARCHES)
def test_a_fragment_from_the_same_place_in_its_word_is_taken(search):
    one_word = Tier("words", (Interval(0.1, 0.5, "pata"),))
    model = model_of(spoken_as("a", one_word), spoken_as("b", WORDS))
    target = utterance("t", ["SIL", "P", "A", "T", "A", "SIL"], words=WORDS)
    (chosen,) = search(model, target, position=1.0).chosen
    assert chosen.unit.recording == "b"
    assert dict(chosen.costs.target)["place"] == 0
    assert "place" not in dict(search(model, target).chosen[0].costs.target)
    (other,) = [r for r in chosen.rejected if r.unit.recording == "a"]
    # the inner A and the inner T each differ at one edge of their word; a phone counts in both its diphones
    assert dict(other.costs.target)["place"] == pytest.approx(4 * 0.5 / 3)


@pytest.mark.parametrize("search", SEARCHES)
def test_a_fragment_with_the_same_stress_is_taken_and_unknown_stress_matches_all(search):
    iamb, trochee = (-1, -1, 0, -1, 1, -1), (-1, -1, 1, -1, 0, -1)
    model = model_of(spoken_as("a", stress=trochee), spoken_as("b", stress=iamb), spoken_as("c"))
    target = replace(utterance("t", ["SIL", "P", "A", "T", "A", "SIL"]), stress=iamb)
    (chosen,) = search(model, target, stress=0.5).chosen
    assert chosen.unit.recording == "b"
    costs = {r.unit.recording: dict(r.costs.target)["stress"] for r in chosen.rejected}
    assert costs == {"a": pytest.approx(0.5 * 4), "c": 0.0}


def test_a_join_costs_the_distance_of_acceleration_and_lip_aperture_where_asked_for():
    model = model_of(recording("a", ["SIL", "P", "A", "SIL"]), recording("b", ["SIL", "T", "A", "P", "SIL"]))
    target = utterance("t", ["SIL", "P", "A", "P", "SIL"])
    first, second = select_greedy(model, target, join=2.0, acceleration=0.5, aperture=0.25).chosen
    left, right = model.inventory.rows(first.unit)[1], model.inventory.rows(second.unit)[0]
    joins, costs = model.joins, dict(second.costs.join)
    assert costs["acceleration"] == pytest.approx(
        2.0 * 0.5 * np.linalg.norm(joins.acceleration[left] - joins.acceleration[right])
    )
    assert costs["aperture"] == pytest.approx(2.0 * 0.25 * abs(joins.aperture[left] - joins.aperture[right]))
    assert min(costs["acceleration"], costs["aperture"]) > 0


def test_join_features_are_in_units_of_their_spread():
    joins = model_of(*simulated_recordings(8, 1)).joins
    assert (joins.acceleration**2).sum(axis=1).mean() == pytest.approx(1.0)
    assert (joins.aperture.mean(), joins.aperture.std()) == (
        pytest.approx(0.0, abs=1e-12),
        pytest.approx(1.0),
    )


@pytest.mark.parametrize("search", SEARCHES)
def test_terms_that_are_not_asked_for_are_not_listed(search):
    model = model_of(recording("a", ["SIL", "P", "A", "SIL"]), recording("b", ["SIL", "A", "T", "SIL"]))
    target = utterance("t", ["SIL", "P", "A", "T", "SIL"])
    terms = ("position", "stress", "acceleration", "aperture", "sound", "per_join")
    plain = search(model, target, **dict.fromkeys(terms, 0)).chosen[1].costs
    assert tuple(dict(plain.target)) == ("timing", "context", "backoff", "flagged")
    assert tuple(dict(plain.join)) == ("position", "velocity")
    asked = search(model, target, **dict.fromkeys(terms, 1)).chosen[1].costs
    assert (tuple(dict(asked.target)), tuple(dict(asked.join))) == (TARGET_TERMS, JOIN_TERMS)


def test_the_matrix_of_joins_is_the_costs_of_its_pairs():
    model = model_of(*with_sounds(simulated_recordings(8, 1)))
    weights = dict(join=2.0, velocity=0.5, acceleration=0.25, aperture=0.75, sound=0.4, per_join=0.1)
    target = prepare_target(model, model.inventory.recordings[0].utterance, **weights)
    left, right = np.arange(3, 9), np.arange(20, 31)
    pairs = join_costs(model, target, np.repeat(left, len(right)), np.tile(right, len(left))).sum(axis=1)
    assert join_matrix(model, target, left, right).ravel() == pytest.approx(pairs)
