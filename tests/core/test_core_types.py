"""Laws of the types that flow."""

import dataclasses
import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from corpus_tools.core import (
    SPEECH_REGIONS,
    Audio,
    Capture,
    FrameFlag,
    InputError,
    Interval,
    LabelError,
    Labels,
    Mesh,
    MeshError,
    MotionError,
    Point,
    PointTier,
    Registry,
    Step,
    Tier,
    Trajectory,
    Utterance,
    frozen,
    region_columns,
    speech_span_s,
    step,
)
from corpus_tools.core.selection import ChosenUnit, Costs, Selection, UnitRef

ARRAYS = hnp.arrays(np.float64, hnp.array_shapes(max_dims=3, max_side=5), elements=st.floats(-1e6, 1e6))


@given(ARRAYS)
def test_frozen_never_shares_writable_memory(values):
    kept = frozen(values)
    np.testing.assert_array_equal(kept, values)
    assert not np.shares_memory(kept, values)
    assert frozen(kept) is kept
    with pytest.raises(ValueError, match="read-only"):
        kept[...] = 0


@given(st.floats(-10, 10), st.floats(1e-4, 10), st.text(max_size=5))
def test_intervals_are_values(start, length, text):
    one, two = Interval(start, start + length, text), Interval(start, start + length, text)
    assert one == two
    assert hash(one) == hash(two)
    assert one.start_s < one.centre_s < one.end_s


@pytest.mark.parametrize(("start", "end"), [(1.0, 1.0), (1.0, 0.5), (float("nan"), 1.0), (0.0, float("inf"))])
def test_impossible_intervals_are_refused(start, end):
    with pytest.raises(LabelError, match="AH"):
        Interval(start, end, "AH")


def test_tiers_refuse_overlap_and_name_the_place():
    with pytest.raises(LabelError, match=r"phones.*'B'.*0\.4"):
        Tier("phones", (Interval(0, 0.5, "A"), Interval(0.4, 0.9, "B")))


@given(st.lists(st.floats(0.01, 1.0), min_size=1, max_size=12), st.data())
def test_tier_at_finds_the_interval_that_holds_the_time(lengths, data):
    edges = np.cumsum([0.0, *lengths])
    tier = Tier("t", tuple(Interval(a, b, str(i)) for i, (a, b) in enumerate(itertools.pairwise(edges))))
    index = data.draw(st.integers(0, len(lengths) - 1))
    assert tier.at(float(edges[index])).text == str(index)
    assert tier.at(float(edges[-1])) is None


def test_labels_say_which_tiers_there_are():
    labels = Labels((Tier("words", ()), PointTier("pitch", (Point(1.0, "H"), Point(0.5, "L")))), 0.0, 1.0)
    assert [p.text for p in labels.tiers[1].points] == ["L", "H"]
    with pytest.raises(LabelError, match=r"'phones'.*'words', 'pitch'"):
        labels.tier("phones")


def test_capture_flags_follow_the_gaps():
    positions = np.zeros((4, 2, 3))
    positions[1, 0] = np.nan
    capture = Capture(positions, 25.0, ("lip_in0", "head3"), start_s=0.02)
    assert capture.regions == ("lip_in", "head")
    assert capture.flags.tolist() == [[1, 1], [FrameFlag.MISSING, 1], [1, 1], [1, 1]]
    np.testing.assert_allclose(capture.times_s, [0.02, 0.06, 0.10, 0.14])
    again = capture.with_step(step("nothing", b=2, a=1))
    assert again.history == (Step("nothing", (("a", 1), ("b", 2))),)
    assert capture.history == ()


def test_samples_are_measured_or_flagged_and_regions_have_columns():
    flags = np.array([[0, 1, 2, 4], [8, 1 | 4, 2 | 8, 1]], np.uint8)
    capture = Capture(np.zeros((2, 4, 3)), 25.0, ("lip_in0", "lip_out1", "chin", "brow0"), flags=flags)
    assert capture.measured.tolist() == [[False, True, False, False], [False, False, False, True]]
    assert capture.flagged.tolist() == [[False, False, True, True], [True, True, True, False]]
    assert region_columns(capture.regions, SPEECH_REGIONS).tolist() == [0, 1, 2]
    assert region_columns(capture.regions, ("cheek",)).tolist() == [0, 1, 2, 3]
    assert region_columns(capture.regions, None).tolist() == [0, 1, 2, 3]


def test_speech_reaches_from_the_first_spoken_phone_to_the_last():
    labels = ["SIL", "P", "SIL", "A", "SIL"]
    spoken = Utterance("u", "", Tier("phones", tuple(Interval(k, k + 1, p) for k, p in enumerate(labels))))
    assert speech_span_s(spoken, "SIL") == (1, 4)
    assert speech_span_s(spoken, "SIL", 0.5) == (0.5, 4.5)


@pytest.mark.parametrize(
    ("positions", "rate", "names", "word"),
    [
        (np.zeros((4, 2)), 25, ("a", "b"), "shape"),
        (np.zeros((4, 2, 3)), 25, ("a",), "2 markers"),
        (np.zeros((4, 2, 3)), 25, ("a", "a"), "'a'"),
        (np.zeros((4, 2, 3)), 0, ("a", "b"), "rate"),
    ],
)
def test_impossible_captures_are_refused(positions, rate, names, word):
    with pytest.raises(MotionError, match=word):
        Capture(positions, rate, names)


def test_unknown_marker_is_named():
    with pytest.raises(MotionError, match="'chin9'"):
        Capture(np.zeros((1, 1, 3)), 25, ("chin0",)).indices(["chin9"])


def test_types_cannot_be_assigned_to():
    for thing, name in [
        (Audio(np.zeros(4), 16000), "rate_hz"),
        (Trajectory(np.arange(3) / 120, np.zeros((3, 1, 3)), ("a",)), "names"),
        (UnitRef("r", 0, 1), "first"),
    ]:
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(thing, name, None)


def test_mesh_faces_must_be_triangles_of_its_vertices():
    with pytest.raises(MeshError, match="thing"):
        Mesh("thing", np.zeros((3, 3)), np.array([[0, 1, 3]]), np.zeros(3))
    mesh = Mesh("thing", np.zeros((3, 3)), np.array([[0, 1, 2]]), np.array([0, 1, 1]), ("skin", "eyes"))
    assert mesh.part_mask("eyes").tolist() == [False, True, True]


@given(st.lists(st.floats(0, 10), min_size=1, max_size=5), st.lists(st.floats(0, 10), max_size=5))
def test_costs_add_up(target, join):
    costs = Costs(
        tuple((f"t{i}", v) for i, v in enumerate(target)), tuple((f"j{i}", v) for i, v in enumerate(join))
    )
    assert costs.total == pytest.approx(sum(target) + sum(join))
    chosen = ChosenUnit(0, 1, UnitRef("r", 0, 1), costs)
    selection = Selection("u", "viterbi", (chosen, chosen))
    assert selection.total_cost == pytest.approx(2 * costs.total)
    assert selection.n_joins == 1


def test_registry_suggests_and_refuses_twice():
    registry: Registry[int] = Registry("weighting function")
    registry.add("linear", 1)
    with pytest.raises(InputError, match=r"no weighting function called 'linaer'; did you mean 'linear'"):
        registry["linaer"]
    with pytest.raises(ValueError, match="twice"):
        registry.add("linear", 2)
    assert list(registry) == ["linear"]
    assert "cosine" not in registry
