"""Pins, bans, other units, undo, two settings to compare: without a browser."""

import numpy as np
import pytest

from corpus_tools import synthesis
from corpus_tools.core import NoUnitError
from workbench.actions import ban_unit, heard, is_tried, options_shown, swap_to, swap_unit, toggle_pin, unban
from workbench.state import (
    EDITABLE,
    OVERLAPS_S,
    Session,
    Stages,
    aperture_curves,
    band_data,
    compute_effects,
    effect_data,
    fragment_details,
    marker_signal,
    score,
    signal_data,
    signals_of,
    stand_ins,
)
from workbench.views.board_texts import lower_text, missing_text
from workbench.views.controls import Controls
from workbench.views.work_board import BlendBoard


class Visit:
    """A session whose results are computed at once."""

    def __init__(self, opened):
        self.session, self.stages, self.number = Session(), Stages(keep=8), 0
        self.session.opened(opened)
        self.run()

    def run(self):
        self.number += 1
        assert self.session.accept(self.number, self.stages.run(self.session.request()))
        return self.session.result

    @property
    def spoken(self):
        return [c.unit.key for c in self.session.result.selection.chosen]


@pytest.fixture
def visit(opened):
    made = Visit(opened)
    made.session.sentence = opened.names[4]
    made.run()
    return made


def place_with_options(visit):
    result = visit.session.result
    index = next(i for i, c in enumerate(result.selection.chosen) if len(c.rejected) > 1)
    visit.session.select(index)
    return options_shown(visit.session)


def test_another_unit_speaks_the_place_and_undo_brings_the_first_back(visit):
    options, before = place_with_options(visit), visit.spoken
    assert swap_unit(visit.session, 1)
    visit.run()
    wanted = options.options[1]
    assert any(
        c.unit.recording == wanted.unit.recording and c.first <= wanted.first and wanted.last <= c.last
        for c in visit.session.result.selection.chosen
    )
    chosen = visit.session.result.selection.chosen[visit.session.selected]
    assert chosen.first <= wanted.first < chosen.last
    assert visit.session.undo()
    visit.run()
    assert visit.spoken == before
    assert visit.session.redo()
    visit.run()
    assert visit.session.pins == (wanted.pin,)


def test_going_through_the_options_meets_each_once_and_comes_round(visit):
    options = place_with_options(visit)
    met = []
    for _ in options.options:
        swap_unit(visit.session, 1)
        visit.run()
        shown = options_shown(visit.session)
        assert [o.unit for o in shown.options] == [o.unit for o in options.options]
        met.append(shown.at)
    assert sorted(met) == list(range(len(options.options)))
    assert met[-1] == 0
    assert not swap_to(visit.session, 99)


def test_a_pin_holds_its_place_and_comes_off_again(visit):
    place_with_options(visit)
    toggle_pin(visit.session)
    (pin,) = visit.session.pins
    visit.session.method = "greedy"
    visit.run()
    assert score(visit.session.result)["fragments"][visit.session.selected]["pinned"]
    unit = visit.session.result.selection.chosen[visit.session.selected].unit
    assert unit.recording == pin.split("=")[1].split(":")[0]
    toggle_pin(visit.session)
    assert visit.session.pins == ()


def test_what_a_swap_tries_is_kept_by_the_same_key_that_lets_it_go(visit):
    options = place_with_options(visit)
    swap_unit(visit.session, 1)
    visit.run()
    assert is_tried(visit.session)
    assert toggle_pin(visit.session)
    assert visit.session.pins == (options.options[1].pin,)
    assert not is_tried(visit.session)
    assert [o.unit for o in options_shown(visit.session).options] == [o.unit for o in options.options]
    swap_unit(visit.session, 1)
    assert is_tried(visit.session)
    toggle_pin(visit.session)
    toggle_pin(visit.session)
    assert visit.session.pins == ()


def test_a_banned_unit_is_gone_until_it_is_allowed(visit):
    place_with_options(visit)
    banned = visit.spoken[visit.session.selected]
    assert ban_unit(visit.session)
    visit.run()
    assert banned not in visit.spoken
    assert unban(visit.session, banned)
    assert not unban(visit.session, banned)
    visit.run()
    assert banned in visit.spoken


def test_pins_belong_to_their_sentence_and_come_back_with_it(visit):
    session = visit.session
    place_with_options(visit)
    toggle_pin(session)
    pins, here = session.pins, session.sentence
    session.step_sentence(1)
    assert session.pins == ()
    visit.run()
    session.sentence = here
    assert session.pins == pins
    session.undo()
    session.undo()
    assert (session.sentence, session.pins) == (here, pins)


def test_every_edit_can_be_undone(visit):
    session = visit.session
    start = session.values
    place_with_options(visit)
    for act in (lambda: swap_unit(session, 1), lambda: ban_unit(session), lambda: session.step_sentence(1)):
        act()
        visit.run()
    session.param.update(shape=0.5, mesh="female", held_out=False)
    while session.undo():
        pass
    assert session.values["pins"] == ()
    assert set(start) == set(EDITABLE)
    assert session.sentence == session.sentences[0]
    while session.redo():
        pass
    assert (session.shape, session.mesh, session.held_out) == (0.5, "female", False)


def test_setting_a_and_b_are_swapped_and_their_difference_is_told(visit):
    session = visit.session
    assert session.difference == ""
    assert not session.swap_sides()
    session.param.update(weighting="linear", overlap_s=0.04)
    assert session.difference == "g(u) smootherstep → linear, overlap 120 ms → 40 ms"
    assert session.swap_sides()
    assert (session.side, session.weighting, session.overlap_s) == ("A", "smootherstep", 0.12)
    told = session.difference
    assert session.swap_sides()
    assert (session.side, session.weighting, session.overlap_s) == ("B", "linear", 0.04)
    assert session.difference == told
    assert session.undo()
    assert session.weighting == "smootherstep"
    session.redo()
    session.keep_as_a()
    assert session.difference == ""


@pytest.mark.parametrize("words", ["the time is two", ""])
def test_another_unit_is_compared_with_the_search_in_any_target(visit, words):
    """Setting A was kept for the first sentence; a text, or another recording, has no pins in it."""
    session = visit.session
    if words:
        session.param.update(target_kind="text", text=words)
    else:
        session.step_sentence(1)
    visit.run()
    place_with_options(visit)
    first = visit.spoken
    assert session.difference == ""
    swap_unit(session, 1)
    visit.run()
    (pin,), second = session.pins, visit.spoken
    unit = pin.split("=")[1]
    told = session.difference
    assert told.startswith("pin ")
    assert told.endswith(f"→ {unit}")
    for side, pins, spoken in (("A", (), first), ("B", (pin,), second)):
        assert session.swap_sides()
        visit.run()
        assert (session.side, session.pins, visit.spoken) == (side, pins, spoken)
        assert session.difference == told


def test_a_pin_is_told_by_its_phones_and_its_unit(visit):
    session = visit.session
    options = place_with_options(visit)
    first, last = options.options[0].first, options.options[0].last
    session.pins = (options.options[0].pin,)
    phones = session.result.utterance.labels
    unit = options.options[0].pin.partition("=")[2]
    assert session.history.entries[-1].what == f"pin {phones[first]}–{phones[last]} → {unit}"
    session.bans = ("time03",)
    assert session.history.entries[-1].what == "ban time03"
    session.param.update(pins=(), bans=())
    assert session.history.entries[-1].what == f"unpin {phones[first]}–{phones[last]} ({unit}), allow time03"


@pytest.mark.parametrize("side", ["A", "B"])
def test_what_is_shown_is_solid_and_the_other_dashed_in_both_states(visit, side):
    session, stages = visit.session, visit.stages
    session.weighting = "linear"
    visit.run()
    if side == "A":
        session.swap_sides()
        visit.run()
    other = stages.run(session.request_of_a())
    drawn = effect_data(None, session.result, other, 0, session.side)
    names = {"A": "smootherstep", "B": "linear"}
    assert drawn["side"] == side
    assert drawn["now"]["name"] == names[side]
    assert drawn["other"]["name"] == names["B" if side == "A" else "A"]
    board = BlendBoard(session, Controls(session), "clock", lambda: None)
    session.other = other
    assert board.plot.effect["side"] == side
    assert board.plot.effect["now"]["name"] == names[side]
    assert board.lane.curves["blend"] == aperture_curves(session.result)["blend"]
    assert board.lane.curves["other"] == aperture_curves(other)["blend"]


def test_nothing_lower_is_offered_where_a_join_is_natural(visit):
    told, helped = [], []
    for overlap_s in (OVERLAPS_S[0], OVERLAPS_S[3], 0.12):
        visit.session.overlap_s = overlap_s
        effects = compute_effects(visit.run())
        for join, ratio in enumerate(visit.session.result.ratios):
            if effects.best(join)[2] < 0.95 * ratio:
                helped.append(ratio <= 1.0)
                told.append(bool(lower_text(effects, visit.session.result, join)))
    assert set(helped) == {True, False}
    assert told == [not natural for natural in helped]


def test_an_edit_of_a_becomes_b(visit):
    session = visit.session
    session.weighting = "linear"
    session.swap_sides()
    session.shape = 0.3
    assert (session.side, session.weighting) == ("B", "smootherstep")
    assert session.undo()
    assert session.weighting == "linear"


def test_the_history_tells_what_each_state_does(visit):
    visit.session.overlap_s = 0.02
    visit.run()
    effects = [e.effect for e in visit.session.history.entries]
    assert effects[-1] == max(visit.session.result.ratios)
    assert effects[-1] > effects[-2]


def test_every_curve_is_measured_at_every_overlap_as_the_blend_itself_is(visit):
    session = visit.session
    session.overlap_s = OVERLAPS_S[3]
    effects = compute_effects(visit.run())
    curve = next(c for c in effects.curves if c.weighting == session.weighting)
    assert curve.ratios[3] == pytest.approx(session.result.ratios)
    name, overlap_s, ratio = effects.best(0)
    assert ratio == min(c.ratios[:, 0].min() for c in effects.curves)
    session.param.update(weighting=name, overlap_s=overlap_s)
    result = visit.run()
    assert effects.fits(result)
    assert result.ratios[0] == pytest.approx(ratio)
    session.rule = "paper"
    assert not effects.fits(visit.run())


def test_a_fragment_is_heard_from_its_own_recording(visit):
    options = place_with_options(visit)
    for at, option in enumerate(options.options):
        sound = heard(visit.session, at)
        phones = visit.session.corpus.utterance(option.unit.recording).phones.intervals
        spoken = phones[option.unit.last].end_s - phones[option.unit.first].start_s
        assert spoken <= sound.duration_s + 0.01 <= spoken + 0.12


def test_curves_hold_the_pieces_the_other_setting_and_the_natural_range(visit):
    session, other = visit.session, visit.session.result
    session.overlap_s = 0.02
    curves = aperture_curves(visit.run(), other)
    assert len(curves["pieces"]) == len(session.result.selection.chosen)
    assert len(curves["other"]) == len(curves["blend"])
    assert curves["other"] != curves["blend"]
    band = band_data(compute_effects(session.result))
    assert len(band["times"]) == len(band["low"]) == len(band["high"]) > 0


def test_the_recording_moves_the_same_head_and_a_text_has_none(visit):
    session, result = visit.session, visit.session.result
    recorded = visit.stages.recorded(result)
    capture = session.corpus.recording(session.sentence).capture
    assert recorded.head is result.head
    assert recorded.animation.targets_mm.shape == (capture.n_frames, len(result.head.names), 3)
    assert recorded.trajectory.times_s[0] == capture.times_s[0]
    session.param.update(target_kind="text", text="the time is two")
    assert visit.stages.recorded(visit.run()) is None


def test_what_stood_in_is_told_as_the_command_line_does(visit):
    session = visit.session
    session.param.update(target_kind="text", text="boys enjoy joyful noise")
    result = visit.run()
    found = synthesis.stand_ins(result.selection, result.utterance, session.corpus.phones)
    most, told = stand_ins(result)
    assert found
    assert set(told) == {s.sentence for s in found}
    n = len(result.utterance.labels) - 1
    assert most.startswith(f"{len(found)} of {n} diphones have no unit: ") == (2 * len(found) > n)
    assert missing_text(result).startswith(most or told[0])
    every = tuple(n for n in session.sentences if n != session.sentence)
    session.param.update(target_kind="recording", bans=every)
    with pytest.raises(NoUnitError):
        visit.stages.run(session.request())


def test_inertial_joins_are_measured_by_their_duration(visit):
    session = visit.session
    session.param.update(mode="inertial", inertial_s=0.06)
    result = visit.run()
    effects = compute_effects(result)
    (curve,) = effects.curves
    data = effect_data(effects, result, None, 0)
    at = OVERLAPS_S.index(0.06)
    assert data["axis"].startswith("inertial duration")
    assert data["now"]["overlap"] == 0.06
    assert data["now"]["ratio"] == pytest.approx(curve.ratios[at, 0])
    assert np.ptp(curve.ratios[:, 0]) > 0.01  # no flat line
    session.inertial_s = 0.2
    assert effects.fits(visit.run())
    join = fragment_details(session.result, 1).join
    assert join["inertial"] == 0.2


def test_trajectories_hold_the_blend_and_what_each_fragment_goes_on_with(visit):
    result = visit.session.result
    joins = result.trajectory.joins
    for signal in (*signals_of(result.trajectory.names), marker_signal("chin3", 1)):
        data = signal_data(result, signal, speed=False)
        assert len(data["now"][1]) == len(result.trajectory.times_s)
        assert sum(len(lines) for lines in data["beyond"]) == 2 * len(joins)
        assert np.allclose(data["spans"][1] - data["spans"][0], [j.overlap_s for j in joins])
    assert (signal_data(result, signal, speed=True)["now"][1] != data["now"][1]).any()
