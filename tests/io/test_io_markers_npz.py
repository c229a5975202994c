"""Marker archives: what comes back, and every way in which one can be wrong."""

from __future__ import annotations

import io
import time
import zipfile

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from corpus_tools.core import Capture, FrameFlag, InputError, MotionError
from corpus_tools.io import read_markers, write_markers_npz

XYZ = np.arange(18, dtype=np.float32).reshape(3, 2, 3)
NAMES = np.array(["lip_in0", "head1"])


@given(
    xyz=arrays(
        np.float32,
        st.tuples(st.integers(1, 4), st.just(2), st.just(3)),
        elements=st.floats(-1e3, 1e3, width=32),
    ),
    rate_hz=st.floats(1, 1000),
    gap=st.booleans(),
)
def test_what_is_written_is_read(tmp_path_factory, xyz, rate_hz, gap):
    path = tmp_path_factory.mktemp("npz") / "a.npz"
    if gap:
        xyz[0, 1] = np.nan
    write_markers_npz(path, Capture(xyz, rate_hz, ("lip_in0", "head1")))
    back = read_markers(path)
    np.testing.assert_array_equal(back.positions_mm, xyz.astype(np.float64))
    assert (back.rate_hz, back.names, back.regions) == (rate_hz, ("lip_in0", "head1"), ("lip_in", "head"))
    expected = np.full((len(xyz), 2), FrameFlag.MEASURED)
    expected[0, 1] = FrameFlag.MISSING if gap else FrameFlag.MEASURED
    np.testing.assert_array_equal(back.flags, expected)


def test_positions_are_kept_to_a_ten_thousandth_of_a_mm(tmp_path):
    xyz = np.random.default_rng(0).uniform(-1000, 1000, (20, 2, 3))
    write_markers_npz(tmp_path / "a.npz", Capture(xyz, 25.0, ("a", "b")))
    assert np.abs(read_markers(tmp_path / "a.npz").positions_mm - xyz).max() < 1e-4


def test_equal_captures_give_equal_bytes_at_any_time(tmp_path, monkeypatch):
    capture = Capture(XYZ, 25.0, ("a", "b"))
    write_markers_npz(tmp_path / "a.npz", capture)
    later = time.localtime(time.time() + 7 * 86400)
    monkeypatch.setattr(time, "localtime", lambda *a: later)
    write_markers_npz(tmp_path / "b.npz", capture)
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


WRONG = {
    "no fps": ({"xyz": XYZ, "names": NAMES}, "fps"),
    "nothing known": ({"a": XYZ}, "xyz"),
    "two axes": ({"xyz": XYZ[0], "fps": 25.0, "names": NAMES}, "(2, 3)"),
    "four coordinates": ({"xyz": np.ones((3, 2, 4)), "fps": 25.0, "names": NAMES}, "(3, 2, 4)"),
    "more names": (
        {"xyz": XYZ, "fps": 25.0, "names": np.array(["a", "b", "c"])},
        "2 markers and 3 marker names",
    ),
    "a name twice": ({"xyz": XYZ, "fps": 25.0, "names": np.array(["a", "a"])}, "'a' stands more than once"),
    "names in rows": ({"xyz": XYZ, "fps": 25.0, "names": NAMES[None]}, "(1, 2)"),
    "names as bytes": ({"xyz": XYZ, "fps": 25.0, "names": NAMES.astype("S")}, "names"),
    "names as objects": ({"xyz": XYZ, "fps": 25.0, "names": NAMES.astype(object)}, "allow_pickle"),
    "positions as objects": ({"xyz": XYZ.astype(object), "fps": 25.0, "names": NAMES}, "allow_pickle"),
    "complex positions": ({"xyz": XYZ + 1j, "fps": 25.0, "names": NAMES}, "complex"),
    "rate is not a number": ({"xyz": XYZ, "fps": np.nan, "names": NAMES}, "frame rate is nan"),
    "rate is infinite": ({"xyz": XYZ, "fps": np.inf, "names": NAMES}, "frame rate is inf"),
    "rate is zero": ({"xyz": XYZ, "fps": 0, "names": NAMES}, "frame rate is 0"),
    "rate is negative": ({"xyz": XYZ, "fps": -25.0, "names": NAMES}, "frame rate is -25"),
    "rate is a period": ({"xyz": XYZ, "fps": 0.04, "names": NAMES}, "1 to 100000 Hz was expected"),
    "rate of a damaged file": ({"xyz": XYZ, "fps": 1e300, "names": NAMES}, "1 to 100000 Hz was expected"),
    "larger than any number": (
        {"xyz": np.full((1, 2, 3), 1e308), "fps": 25.0, "names": NAMES, "units": "m"},
        "infinitely far",
    ),
    "a name with a line feed": (
        {"xyz": XYZ, "fps": 25.0, "names": np.array(["a\nb", "c"])},
        r"name 'a\nb' holds characters that cannot be printed",
    ),
    "a name with an escape": ({"xyz": XYZ, "fps": 25.0, "names": np.array(["a", "\x1b[31m"])}, "'\\x1b[31m'"),
    "two rates": ({"xyz": XYZ, "fps": np.array([25.0, 30.0]), "names": NAMES}, "fps of float64 (2,)"),
    "rate is a text": ({"xyz": XYZ, "fps": np.array("25"), "names": NAMES}, "fps of <U2"),
    "no frames": ({"xyz": XYZ[:0], "fps": 25.0, "names": NAMES}, "no frames"),
    "no markers": ({"xyz": XYZ[:, :0], "fps": 25.0, "names": NAMES[:0]}, "no markers"),
    "infinite": (
        {"xyz": np.where(XYZ == 10, np.inf, XYZ), "fps": 25.0, "names": NAMES},
        "'head1' is infinitely",
    ),
}


@pytest.mark.parametrize("what", WRONG)
def test_arrays_that_are_no_motion_are_refused(tmp_path, what):
    held, words = WRONG[what]
    path = tmp_path / "a.npz"
    np.savez(path, **held)
    with pytest.raises(MotionError) as caught:
        read_markers(path)
    assert str(path) in str(caught.value)
    assert words in str(caught.value)


def test_an_archive_that_holds_too_much_is_refused_before_it_is_unpacked(tmp_path, monkeypatch):
    np.savez_compressed(tmp_path / "a.npz", xyz=np.zeros((100, 50, 3)), fps=25.0, names=np.array(["a"] * 50))
    np.savez_compressed(tmp_path / "b.npz", xyz=np.zeros((100, 50, 3), np.int8), fps=25.0, names=NAMES)
    np.savez_compressed(tmp_path / "c.npz", xyz=XYZ, fps=25.0, names=NAMES, other=np.zeros(20_000))
    monkeypatch.setattr("corpus_tools.io.formats.LARGEST_UNPACKED_BYTES", 100_000)
    for name in "ab":  # b: 15 KB that become 120 KB as numbers
        with pytest.raises(MotionError, match=rf"{name}\.npz' holds .* when it is unpacked"):
            read_markers(tmp_path / f"{name}.npz")
    assert read_markers(tmp_path / "c.npz").n_frames == len(XYZ)  # what is not read does not matter
    monkeypatch.setattr("numpy.load", lambda *args, **options: pytest.fail("it was opened"))
    with pytest.raises(MotionError, match="when it is unpacked"):
        read_markers(tmp_path / "a.npz")


def test_an_object_array_is_never_unpickled(tmp_path):
    class Trap:
        def __reduce__(self):
            return (open, (str(tmp_path / "sprung"), "w"))

    np.savez(tmp_path / "a.npz", xyz=np.array([Trap()], dtype=object), fps=25.0, names=NAMES)
    with pytest.raises(MotionError):
        read_markers(tmp_path / "a.npz")
    assert not (tmp_path / "sprung").exists()


def test_one_array_file_or_any_zip_under_the_name_is_refused(tmp_path):
    with (tmp_path / "a.npz").open("wb") as stream:
        np.save(stream, XYZ)
    with zipfile.ZipFile(tmp_path / "b.npz", "w") as archive:
        for name in ("xyz", "fps", "names"):
            archive.writestr(f"{name}.npy", b"junk")
    for name in ("a.npz", "b.npz"):
        with pytest.raises(MotionError, match=name):
            read_markers(tmp_path / name)


@given(data=st.data())
def test_a_cut_or_flipped_archive_gives_motion_or_a_sentence(tmp_path_factory, data):
    buffer = io.BytesIO()
    np.savez_compressed(buffer, xyz=XYZ, fps=25.0, names=NAMES)
    bad = bytearray(buffer.getvalue())
    if data.draw(st.booleans()):
        bad = bad[: data.draw(st.integers(1, len(bad) - 1))]
    else:
        bad[data.draw(st.integers(0, len(bad) - 1))] ^= 1 << data.draw(st.integers(0, 7))
    path = tmp_path_factory.mktemp("bad") / "a.npz"
    path.write_bytes(bad)
    try:
        capture = read_markers(path)
    except InputError as error:
        assert str(path) in str(error)  # noqa: PT017  either outcome is right
    else:
        assert capture.positions_mm.shape[2] == 3
