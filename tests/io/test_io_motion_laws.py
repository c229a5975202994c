"""What every motion format must keep, for each entry of the registries; and what none may do with damage."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from corpus_tools.core import Capture, InputError, MotionError, Trajectory
from corpus_tools.io import MOTION_READERS, MOTION_WRITERS, read_markers, reading_notes, write_motion_file
from corpus_tools.io.motion_parts import capture_of

SUFFIX = {"npz": ".npz", "c3d": ".c3d", "trc": ".trc", "csv": ".csv", "csv-long": ".csv"}
# relative to the size of a value (float32), or mm (six decimals, exact)
RELATIVE = {"npz": 6e-8, "c3d": 6e-8, "trc": 0.0, "csv": 0.0, "csv-long": 0.0}
ABSOLUTE_MM = {"npz": 1e-38, "c3d": 1e-38, "trc": 5.1e-7, "csv": 0.0, "csv-long": 0.0}
NAMES = st.text(
    st.characters(codec="utf-8", exclude_categories=("C", "Z")) | st.just(" "), min_size=1, max_size=12
).filter(lambda n: n == n.strip() and n.isprintable() and not n.startswith("*") and ":" not in n)
MOTION = st.tuples(st.integers(2, 6), st.integers(1, 4)).flatmap(
    lambda shape: st.tuples(
        arrays(np.float64, (*shape, 3), elements=st.floats(-2e3, 2e3, allow_subnormal=False)),
        arrays(np.bool_, shape),
        st.lists(NAMES, min_size=shape[1], max_size=shape[1], unique=True),
        st.sampled_from([24.0, 25.0, 30000 / 1001, 60.0, 100.0, 120.0, 333.25]) | st.floats(1, 1000),
    )
)


def written(folder, form, positions, names, rate_hz):
    path = folder / f"a{SUFFIX[form]}"
    MOTION_WRITERS[form](path, positions, names, rate_hz)
    return path


def refusal(path, **given_by_caller):
    with pytest.raises(InputError) as caught:
        read_markers(path, **given_by_caller)
    message = str(caught.value)
    assert str(path) in message
    assert "\n" not in message
    assert message.endswith(".")
    return message


def test_every_writer_is_here_and_has_a_reader():
    assert set(SUFFIX) == set(MOTION_WRITERS)
    assert set(SUFFIX.values()) <= set(MOTION_READERS)


@pytest.mark.parametrize("form", SUFFIX)
@given(motion=MOTION)
def test_positions_gaps_names_and_rate_survive_a_round_trip(tmp_path_factory, form, motion):
    positions, gaps, names, rate_hz = motion
    positions[gaps] = np.nan
    back = read_markers(written(tmp_path_factory.mktemp("law"), form, positions, names, rate_hz))
    np.testing.assert_allclose(
        back.positions_mm, positions, rtol=RELATIVE[form], atol=ABSOLUTE_MM[form], equal_nan=True
    )
    assert back.names == tuple(names)
    assert back.rate_hz == pytest.approx(rate_hz, rel=6e-8 if form == "c3d" else 2e-9)


@pytest.mark.parametrize("form", SUFFIX)
def test_equal_motion_gives_equal_bytes(tmp_path, form):
    positions = np.random.default_rng(0).normal(size=(20, 3, 3))
    for folder in ("a", "b"):
        written(tmp_path / folder, form, positions, ["a", "b", "c"], 120.0)
    first, second = (next((tmp_path / f).iterdir()).read_bytes() for f in ("a", "b"))
    assert first == second


@pytest.mark.parametrize("form", SUFFIX)
@pytest.mark.parametrize(
    ("names", "rate_hz", "words"),
    [
        (["a", "a"], 25.0, "doubled"),
        (["a", ""], 25.0, "blank"),
        (["a", "b\tc"], 25.0, "printed"),
        (["a", " b"], 25.0, "blanks at its ends"),
        (["a"], 25.0, "1 names"),
        (["a", "b"], 0.0, "frame rate"),
        (["a", "b"], 0.5, "frame rate"),
        (["a", "b"], 1e6, "frame rate"),
        (["a", "b"], float("nan"), "frame rate"),
    ],
)
def test_what_no_file_can_hold_is_not_written(tmp_path, form, names, rate_hz, words):
    with pytest.raises(MotionError, match=words) as caught:
        written(tmp_path, form, np.ones((4, 2, 3)), names, rate_hz)
    assert str(tmp_path) in str(caught.value)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("form", SUFFIX)
def test_infinite_positions_and_no_frames_are_not_written(tmp_path, form):
    with pytest.raises(MotionError, match="infinite"):
        written(tmp_path, form, np.full((2, 1, 3), np.inf), ["a"], 25.0)
    with pytest.raises(MotionError, match=r"\(0, 1, 3\)"):
        written(tmp_path, form, np.zeros((0, 1, 3)), ["a"], 25.0)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("form", SUFFIX)
def test_captures_and_trajectories_are_written_by_suffix_or_by_format(tmp_path, form):
    positions = np.arange(36.0).reshape(4, 3, 3)
    capture = Capture(positions, 120.0, ("a", "b", "c"))
    trajectory = Trajectory(np.arange(4) / 120.0, positions, ("a", "b", "c"))
    for name, motion in (("c", capture), ("t", trajectory)):
        path = tmp_path / f"{name}{SUFFIX[form].upper()}"
        write_motion_file(path, motion, None if form != "csv-long" else form)
        back = read_markers(path)
        np.testing.assert_allclose(back.positions_mm, positions, atol=1e-5)
        assert back.rate_hz == pytest.approx(120.0)
    with pytest.raises(InputError, match="c3d"):
        write_motion_file(tmp_path / "x.c3b", capture)


@pytest.mark.parametrize("form", SUFFIX)
def test_a_subject_that_all_markers_share_is_taken_off_and_told(tmp_path, form):
    positions = np.random.default_rng(0).normal(size=(4, 2, 3))
    path = written(tmp_path, form, positions, ["anna:lip", "anna:chin"], 50.0)
    back = read_markers(path)
    assert back.names == ("lip", "chin")
    assert dict(back.history[0].settings)["prefix"] == "anna:"
    assert read_markers(written(tmp_path, form, positions, ["anna:lip", "jig:a"], 50.0)).names == (
        "anna:lip",
        "jig:a",
    )


@pytest.mark.parametrize("form", SUFFIX)
def test_the_caller_stands_above_the_file_and_a_difference_is_told(tmp_path, form):
    positions = np.random.default_rng(0).normal(100, 10, size=(4, 2, 3))
    path = written(tmp_path, form, positions, ["a", "b"], 50.0)
    assert reading_notes(read_markers(path, rate_hz=50.0, units="mm")) == ()
    back = read_markers(path, rate_hz=25.0, units="cm")
    np.testing.assert_allclose(back.positions_mm, positions * 10, rtol=1e-6)
    assert back.rate_hz == 25.0
    rate, unit = reading_notes(back)
    assert "50 Hz" in rate + unit
    assert "mm; marker_units = cm" in rate + unit
    scaled = read_markers(path, units="2.5 mm")
    np.testing.assert_allclose(scaled.positions_mm, positions * 2.5, rtol=1e-6)
    assert "frame rate" in refusal(path, rate_hz=-1.0)
    assert "no unit" in refusal(path, units="feet")


@pytest.mark.parametrize("form", SUFFIX)
def test_positions_of_exactly_nought_are_told(tmp_path, form):
    positions = np.full((4, 2, 3), 7.0)
    positions[2, 1] = 0.0
    (note,) = reading_notes(read_markers(written(tmp_path, form, positions, ["a", "b"], 50.0), units="mm"))
    assert note.startswith("1 positions are exactly (0, 0, 0), first in frame 2")


@pytest.mark.parametrize("form", SUFFIX)
@given(data=st.data())
def test_damage_gives_motion_or_a_sentence(tmp_path_factory, form, data):
    folder = tmp_path_factory.mktemp("damage")
    path = written(folder, form, np.random.default_rng(0).normal(size=(5, 3, 3)), ["a", "b", "c"], 50.0)
    bad = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(0, 4))):
        bad[data.draw(st.integers(0, min(len(bad), 1400) - 1))] = data.draw(st.integers(0, 255))
    if data.draw(st.booleans()):
        del bad[data.draw(st.integers(1, len(bad) - 1)) :]
    path.write_bytes(bad)
    try:
        capture = read_markers(path)
    except InputError as error:
        assert str(path) in str(error)  # noqa: PT017  either outcome is right
        assert "\n" not in str(error)  # noqa: PT017
    else:
        assert capture.positions_mm.shape[2] == 3
        assert not np.isinf(capture.positions_mm).any()


@pytest.mark.parametrize("name", ["a\nb", "a\x00b", "\x1b[31m", "a\u202eb", "\ud800", "a\u2028b", "a\xa0b"])
def test_no_reader_gives_a_name_that_no_writer_takes(tmp_path, name):
    with pytest.raises(MotionError, match=r"here.*characters that cannot be printed"):
        capture_of(tmp_path / "here", np.zeros((2, 2, 3)), ["b", name], 50.0, format="any", notes=[])


@pytest.mark.parametrize("form", SUFFIX)
def test_a_control_character_in_a_file_costs_one_sentence(tmp_path, form):
    path = written(tmp_path, form, np.zeros((4, 1, 3)), ["QQ"], 50.0)
    if form == "npz":
        with np.load(path) as data:
            held = dict(data)
        np.savez(path, **held | {"names": np.array(["Q\x07"])})
    else:
        path.write_bytes(path.read_bytes().replace(b"QQ", b"Q\x07"))
    assert r"'Q\x07'" in refusal(path)


@pytest.mark.parametrize("bits", [0x7FA00001, 0xFFA00001, 0x7F800000, 0x7F7FFFFF])
@pytest.mark.parametrize("unit", ["mm", "m"])
def test_floats_that_are_none_print_nothing(tmp_path, bits, unit):
    path = written(tmp_path, "c3d", np.full((4, 1, 3), 7.25), ["a"], 50.0)
    path.write_bytes(path.read_bytes().replace(np.float32(7.25).tobytes(), np.uint32(bits).tobytes(), 2))
    huge = tmp_path / "huge.npz"
    np.savez(huge, xyz=np.full((4, 1, 3), 1e308), fps=25.0, names=np.array(["a"]))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            read_markers(path, units=unit)
        except MotionError as error:
            assert "infinitely" in str(error)  # noqa: PT017  either outcome is right
        if unit == "m":
            assert "infinitely" in refusal(huge, units=unit)


@pytest.mark.parametrize("suffix", MOTION_READERS)
def test_a_file_that_is_too_large_is_refused_unopened(tmp_path, suffix, monkeypatch):
    monkeypatch.setattr("corpus_tools.io.formats.LARGEST_BYTES", 1 << 30)
    path = tmp_path / f"big{suffix}"
    with path.open("wb") as stream:
        stream.truncate((1 << 30) + 1)
    assert "1.0 GB" in refusal(path)
