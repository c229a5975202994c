"""A whole visit without a browser: open, pick a sentence, move g(u), export; and what must not happen."""

import time

import numpy as np
import pytest

from corpus_tools.config import load_config
from corpus_tools.core import ConfigError, InputError
from corpus_tools.synthesis import curve_through
from workbench.actions import export_config
from workbench.state import SETTINGS, Session, Stages, aperture_curves, fragment_details, joins_data, score
from workbench.views.controls import Controls
from workbench.views.export_box import ExportBox

BLEND = ("blend", "animate")


@pytest.fixture
def session(opened):
    made = Session()
    made.opened(opened)
    return made


@pytest.fixture
def stages():
    return Stages()


def test_an_empty_session_asks_for_nothing():
    session = Session()
    assert session.status == "empty"
    assert session.request() is None
    assert session.sentences == ()


def test_every_setting_reaches_the_config(opened):
    session = Session()
    values = {
        "method": "greedy",
        "mode": "inertial",
        "weighting": "linear",
        "shape": 0.25,
        "curve_weights": (0.0, 0.0, 1.0, 3.0, 0.0, 0.0),
        "overlap_s": 0.08,
        "inertial_s": 0.2,
        "rule": "paper",
        "mesh": "male",
        "deformer": "bid",
        "pins": ("0-2=time02:0-2",),
        "bans": ("time03", "time04:1-3"),
    }
    assert set(values) == set(SETTINGS)
    session.param.update(**values)
    config = session.config.values()
    for name, place in SETTINGS.items():
        part, _, key = place.partition("__")
        assert config[part][key] == (list(v) if isinstance(v := values[name], tuple) else v)
    other = Session()
    other.load_config(session.config)
    assert other.config == session.config


def test_g_of_u_changes_the_animation_and_runs_only_the_quick_stages(session, stages):
    first = stages.run(session.request())
    assert first.ran == ("select", "align", "blend", "head", "animate")
    session.weighting = "linear"
    second = stages.run(session.request())
    assert second.ran == BLEND
    assert second.selection is first.selection
    assert second.head is first.head
    assert not np.allclose(second.animation.targets_mm, first.animation.targets_mm, atol=1e-6)
    session.weighting = "smootherstep"
    again = stages.run(session.request())
    assert again.ran == ()
    assert again.animation is first.animation


@pytest.mark.parametrize(
    ("name", "value"), [("shape", 0.6), ("overlap_s", 0.04), ("rule", "paper"), ("mode", "inertial")]
)
def test_every_blend_setting_moves_the_mouth(session, stages, name, value):
    first = stages.run(session.request())
    assert len(first.selection.chosen) > 1
    setattr(session, name, value)
    second = stages.run(session.request())
    assert second.ran == BLEND
    assert not np.array_equal(second.trajectory.values_mm, first.trajectory.values_mm)


def test_a_curve_of_ones_own_moves_the_mouth_and_runs_only_the_quick_stages(session, stages):
    session.weighting = "user"
    first = stages.run(session.request())
    session.curve_weights = curve_through([(0.2, 0.3), (0.6, 0.1)])
    second = stages.run(session.request())
    assert second.ran == BLEND
    assert not np.array_equal(second.trajectory.values_mm, first.trajectory.values_mm)


def test_another_sentence_or_method_selects_again_but_keeps_the_head(session, stages):
    first = stages.run(session.request())
    session.step_sentence(1)
    second = stages.run(session.request())
    assert second.ran == ("select", "align", "blend", "animate")
    assert second.utterance.name != first.utterance.name
    session.method = "greedy"
    assert "select" in stages.run(session.request()).ran


def test_another_head_selects_nothing_again(session, stages):
    first = stages.run(session.request())
    session.mesh = "female"
    second = stages.run(session.request())
    assert second.ran == ("head", "animate")
    assert second.trajectory is first.trajectory


def test_the_spoken_recording_is_held_out(session, stages):
    for _ in range(3):
        result = stages.run(session.request())
        assert session.sentence not in {c.unit.recording for c in result.selection.chosen}
        session.step_sentence(1)
    session.held_out = False
    result = stages.run(session.request())
    assert session.sentence in {c.unit.recording for c in result.selection.chosen}


def test_an_older_result_never_replaces_a_newer_one(session, stages):
    old = stages.run(session.request())
    session.weighting = "linear"
    new = stages.run(session.request())
    assert session.accept(2, new)
    assert not session.accept(1, old)
    assert session.result is new
    assert not session.refuse(1, "an old error")
    assert session.message == ""


def test_a_result_of_another_sentence_is_not_shown(session, stages):
    result = stages.run(session.request())
    session.step_sentence(1)
    assert not session.accept(1, result)
    assert session.result is None


def test_a_wrong_setting_is_one_sentence(session):
    session.mesh = "nobody"
    with pytest.raises(InputError, match="nobody"):
        Stages().run(session.request())
    session.mesh = "base"
    session.overlap_s = 0.5
    with pytest.raises(ValueError, match="overlap_s"):
        session.overlap_s = 0.9


def test_sentences_step_inside_the_corpus(session):
    names = session.sentences
    session.step_sentence(-1)
    assert session.sentence == names[0]
    session.step_sentence(10_000)
    assert session.sentence == names[-1]


def test_lane_data_tells_what_the_selection_says(session, stages):
    result = stages.run(session.request())
    shown = score(result)
    phones = result.utterance.phones.intervals
    assert [p[2] for p in shown["phones"]] == [p.text for p in phones]
    assert shown["duration"] == phones[-1].end_s
    edges = [f["start"] for f in shown["fragments"]] + [shown["fragments"][-1]["end"]]
    assert edges[0] == 0.0
    assert edges[-1] == shown["duration"]
    assert edges[1:-1] == pytest.approx([phones[c.first].centre_s for c in result.selection.chosen[1:]])
    joins = joins_data(result)
    assert [j["time"] for j in joins] == [j.time_s for j in result.trajectory.joins]
    curves = aperture_curves(result)
    assert len(np.frombuffer(curves["blend"], np.float32)) == len(result.trajectory.times_s)
    assert curves["start"] == 0.0


def test_fragment_details_itemise_the_cost(session, stages):
    result = stages.run(session.request())
    for index, chosen in enumerate(result.selection.chosen):
        details = fragment_details(result, index)
        assert details.source == chosen.unit.recording
        assert sum(v for _, v in details.costs) == pytest.approx(details.total)
        assert (details.join is None) == (index == 0)
        assert details.last_s > details.first_s


def test_exported_config_equals_the_session(session, tmp_path):
    session.param.update(weighting="raised-cosine", shape=-0.4, overlap_s=0.075)
    path, written = export_config(session, tmp_path / "tuned")
    assert path.suffix == ".toml"
    assert load_config(path).values() == session.config.values() == written.values()
    other = Session()
    other.load_config(load_config(path))
    assert (other.weighting, other.shape, other.overlap_s) == ("raised-cosine", -0.4, 0.075)


def test_a_visit_from_opening_to_a_new_curve(desk_of, corpus_folder):
    desk, loop = desk_of()
    session, seen = desk.session, []
    session.param.watch(lambda e: seen.append(e.new), "fraction")
    desk.open(corpus_folder)
    loop.until(lambda: session.result is not None and not session.working)
    assert session.status == "ready"
    assert session.message == ""
    assert seen[-1] == 1.0
    before = session.result
    for shape in np.linspace(-0.5, 0.5, 11):
        session.shape = float(shape)
    loop.until(lambda: not session.working)
    assert session.result.request.config.blend.shape == 0.5
    assert session.result.selection is before.selection
    assert not np.array_equal(session.result.animation.targets_mm, before.animation.targets_mm)


def test_in_a_drag_the_head_goes_first_and_the_last_numbers_are_shown(desk_of, corpus_folder):
    desk, loop = desk_of()
    session, order = desk.session, []
    desk.open(corpus_folder)
    loop.until(lambda: session.result is not None and not session.working)
    waiting = []
    desk.after_head = lambda action: waiting.append(action)
    session.param.watch(lambda *events: order.extend(e.name for e in events), ["moving", "result"])
    session.shape = 0.3
    loop.until(lambda: order == ["moving"] and waiting and not desk.busy)
    assert session.working
    waiting[-1]()  # of those that wait, only the newest is run
    assert order[-1] == "result"
    assert session.result is session.moving
    assert not session.working


def test_a_check_is_told_from_its_begin_to_its_end(desk_of, corpus_folder):
    desk, loop = desk_of()
    desk.open(corpus_folder)
    loop.until(lambda: desk.session.corpus is not None)
    said = []
    desk.session.param.watch(lambda event: said.append(event.new), "check_doing")
    desk.check()
    loop.until(lambda: desk.session.facts is not None)
    assert said[0] == "reading"
    assert "lip closures" in said[-2]
    assert said[-1] == ""


def test_two_sessions_share_the_corpus_and_nothing_else(desk_of, corpus_folder):
    (one, loop_one), (two, loop_two) = desk_of(), desk_of()
    one.open(corpus_folder)
    two.open(corpus_folder)
    loop_one.until(lambda: one.session.result is not None and not one.session.working)
    loop_two.until(lambda: two.session.result is not None and not two.session.working)
    assert one.session.corpus is two.session.corpus
    kept = two.session.result
    one.session.weighting = "linear"
    one.session.step_sentence(1)
    loop_one.until(lambda: not one.session.working)
    assert two.session.result is kept
    assert two.session.weighting == "smootherstep"
    assert two.session.sentence != one.session.sentence


def test_a_folder_without_corpus_is_one_sentence_and_nothing_is_lost(desk_of, corpus_folder, tmp_path):
    desk, loop = desk_of()
    desk.open(tmp_path)
    loop.until(lambda: desk.session.status == "error")
    assert "corpus.toml" in desk.session.trouble
    desk.open(corpus_folder)
    loop.until(lambda: desk.session.status == "ready")
    corpus = desk.session.corpus
    desk.open(tmp_path / "nowhere")
    loop.until(lambda: desk.session.trouble != "")
    assert desk.session.corpus is corpus
    assert desk.session.status == "ready"


def test_opening_can_be_cancelled(desk_of, corpus_folder):
    desk, loop = desk_of()
    desk.open(corpus_folder)
    desk.cancel()
    assert desk.session.status == "empty"
    until = time.monotonic() + 60
    while desk._opening.busy:  # a job cancelled before its first report delivers nothing
        assert time.monotonic() < until
        time.sleep(0.01)
    while not loop.queue.empty():
        loop.queue.get()()
    assert desk.session.corpus is None


def test_an_unknown_sentence_is_named(desk_of, corpus_folder):
    desk, loop = desk_of()
    desk.open(corpus_folder, sentence="nobody")
    loop.until(lambda: desk.session.trouble != "")
    assert "nobody" in desk.session.trouble


def test_export_without_a_corpus_says_what_to_do(desk_of, tmp_path):
    desk, _ = desk_of()
    said = []
    desk.export(tmp_path / "x.toml", lambda kind, text, where: said.append((kind, text)))
    assert said[0][0] == "err"
    assert "open a corpus" in said[0][1]
    assert list(tmp_path.iterdir()) == []


def test_a_config_that_is_there_is_replaced_when_asked_again(desk_of, corpus_folder, tmp_path):
    desk, loop = desk_of()
    desk.open(corpus_folder)
    loop.until(lambda: desk.session.result is not None)
    path, told = tmp_path / "mine.toml", []

    def export(typed, replace, done):
        desk.export(typed, lambda *said: (done(*said), told.append(said[0])), tmp_path, replace)

    def press(typed="mine", expected="ok"):
        n = len(told)
        box.path.value = typed
        box.submit()
        loop.until(lambda: len(told) > n)
        assert told[-1] == expected
        return path.read_text()

    box = ExportBox(Controls(desk.session), export, desk.open_config)
    first = press()
    desk.session.overlap_s = 0.05
    assert press(expected="there") == first
    assert "mine.toml" in box.text
    assert press("another") == first  # the question was about another file
    assert press(expected="there") == first
    assert press() != first
    desk.session.overlap_s = 0.06
    press(expected="there")  # and anew


def test_a_value_out_of_range_is_refused_by_the_config(session, tmp_path):
    session.base = session.config.model_copy()
    with pytest.raises(ConfigError, match="overlap"):
        from corpus_tools.config import config_with

        config_with(session.config, blend__overlap_s=2.0)
