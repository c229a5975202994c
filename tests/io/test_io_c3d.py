"""C3D: read as ezc3d reads it, in each byte order and number format; damage never ends the process."""

from __future__ import annotations

import struct

import ezc3d
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import InputError, MotionError
from corpus_tools.io import MOTION_WRITERS, read_markers, reading_notes

RNG = np.random.default_rng(3)
POSITIONS = RNG.normal(0, 100, (7, 3, 3))
NAMES = ["lip", "chin", "head1"]


def parameter(group, name, kind, shape, raw, order):
    head = struct.pack("bb", len(name), group) + name.encode()
    body = struct.pack("bB", kind, len(shape)) + bytes(shape) + raw + b"\0"
    return head + struct.pack(f"{order}H", len(body) + 2) + body


def as_dec(values):
    """Return floats as a VAX keeps them: times four, halves swapped."""
    words = (np.asarray(values, "<f4") * np.float32(4)).view("<u2").reshape(-1, 2)
    return words[:, ::-1].tobytes()


class Made:
    """A C3D file put together by hand, every part of which a test may change."""

    processor = 84
    scale = -1.0
    units: str | None = "mm"
    labels = NAMES
    residuals: np.ndarray | None = None
    first, last = 1, 7
    rate_hz = 100.0
    n_points = 3
    n_analog = 2
    extra: tuple = ()

    def __init__(self, **changes):
        for key, value in changes.items():
            setattr(self, key, value)

    def floats(self, values):
        if self.processor == 85:
            return as_dec(values)
        return np.asarray(values, ">f4" if self.processor == 86 else "<f4").tobytes()

    def parameters(self):
        order = ">" if self.processor == 86 else "<"
        width = max((len(n) for n in self.labels), default=1)
        joined = "".join(n.ljust(width) for n in self.labels).encode()
        rows = [struct.pack("bb", 5, -1) + b"POINT" + struct.pack(f"{order}H", 3) + b"\0"]
        rows.append(parameter(1, "LABELS", -1, (width, len(self.labels)), joined, order))
        if self.units is not None:
            rows.append(parameter(1, "UNITS", -1, (len(self.units),), self.units.encode(), order))
        rows.append(parameter(1, "USED", 2, (), struct.pack(f"{order}h", self.n_points), order))
        rows.append(parameter(1, "SCALE", 4, (), self.floats([self.scale]), order))
        rows.append(parameter(1, "RATE", 4, (), self.floats([self.rate_hz]), order))
        rows += [parameter(1, *entry, order) for entry in self.extra]
        body = b"\1\x50\2" + bytes([self.processor]) + b"".join(rows) + b"\0\0"
        assert len(body) <= 1024
        return body.ljust(1024, b"\0")

    def frames(self):
        residual = np.zeros((7, 3)) if self.residuals is None else self.residuals
        values = np.concatenate([POSITIONS, residual[:, :, None]], axis=2)[:, : self.n_points]
        if self.scale > 0:
            values[:, :, :3] /= self.scale
        flat = np.hstack([values.reshape(7, -1), np.full((7, self.n_analog), 5.0)])
        if self.scale < 0:
            return self.floats(flat.ravel())
        return np.rint(flat).astype(">i2" if self.processor == 86 else "<i2").tobytes()

    def bytes(self):
        order = ">" if self.processor == 86 else "<"
        header = b"\2\x50" + struct.pack(
            f"{order}5H", self.n_points, self.n_analog, self.first, self.last, 10
        )
        header += self.floats([self.scale]) + struct.pack(f"{order}2H", 4, 1) + self.floats([self.rate_hz])
        return header.ljust(512, b"\0") + self.parameters() + self.frames()


def saved(tmp_path, made, name="a.c3d"):
    path = tmp_path / name
    path.write_bytes(made.bytes() if isinstance(made, Made) else made)
    return path


def refusal(path, **given_by_caller):
    with pytest.raises(MotionError) as caught:
        read_markers(path, **given_by_caller)
    assert str(path) in str(caught.value)
    assert str(caught.value).endswith(".")
    return str(caught.value)


@pytest.mark.parametrize("processor", [84, 85, 86])
@pytest.mark.parametrize("scale", [-1.0, 0.05])
@pytest.mark.parametrize("n_analog", [0, 6])
def test_each_byte_order_and_number_format_reads(tmp_path, processor, scale, n_analog):
    residuals = np.zeros((7, 3))
    residuals[2:4, 1] = -1
    path = saved(tmp_path, Made(processor=processor, scale=scale, residuals=residuals, n_analog=n_analog))
    capture = read_markers(path)
    expected = np.where(residuals[:, :, None] < 0, np.nan, POSITIONS)
    np.testing.assert_allclose(
        capture.positions_mm, expected, rtol=1e-6, atol=abs(scale) if scale > 0 else 1e-6
    )
    assert (capture.names, capture.rate_hz) == (tuple(NAMES), 100.0)
    if processor == 86 or n_analog:
        return  # ezc3d does not know the one, and wants a group ANALOG for the other
    oracle = ezc3d.c3d(str(path))["data"]["points"][:3].transpose(2, 1, 0)
    np.testing.assert_allclose(capture.positions_mm, oracle, atol=1e-5)


@pytest.mark.parametrize(
    ("units", "factor"), [("mm", 1), ("m", 1000), ("cm", 10), ("  Meters ", 1000), ("in", 25.4)]
)
def test_the_unit_of_the_file_is_heard(tmp_path, units, factor):
    capture = read_markers(saved(tmp_path, Made(units=units)))
    np.testing.assert_allclose(capture.positions_mm, POSITIONS * factor, rtol=1e-6)


@pytest.mark.parametrize(
    ("units", "words"), [(None, "in which unit"), ("", "in which unit"), ("ell", "'ell'")]
)
def test_no_unit_or_an_unknown_one_is_refused_until_the_corpus_says_it(tmp_path, units, words):
    path = saved(tmp_path, Made(units=units))
    message = refusal(path)
    assert words in message
    assert "marker_units" in message
    np.testing.assert_allclose(read_markers(path, units="cm").positions_mm, POSITIONS * 10, rtol=1e-6)


def test_points_without_a_label_are_left_out_and_counted(tmp_path):
    capture = read_markers(saved(tmp_path, Made(labels=["a:lip", "a:*12", "*3"])))
    assert capture.names == ("lip",)
    settings = dict(capture.history[0].settings)
    assert settings["left_out"] == "2 points without a label"
    capture = read_markers(saved(tmp_path, Made(labels=["lip"])))
    np.testing.assert_allclose(capture.positions_mm[:, 0], POSITIONS[:, 0], rtol=1e-6)
    assert "no marker that has a name" in refusal(saved(tmp_path, Made(labels=["*1", "*2", "*3"])))
    assert "'lip' stands more than once" in refusal(saved(tmp_path, Made(labels=["lip", "chin", "lip"])))


def test_angles_are_no_positions(tmp_path):
    made = Made(extra=(("ANGLES", -1, (5, 1), b"head1"),))
    capture = read_markers(saved(tmp_path, made))
    assert capture.names == ("lip", "chin")
    assert dict(capture.history[0].settings)["derived_left_out"].startswith("1 ")


def test_labels_go_on_in_a_second_list(tmp_path):
    made = Made(labels=["lip"], extra=(("LABELS2", -1, (5, 2), b"chin head1"),))
    assert read_markers(saved(tmp_path, made)).names == tuple(NAMES)


def test_the_axes_of_the_screen_are_kept_for_the_report(tmp_path):
    made = Made(extra=(("X_SCREEN", -1, (2,), b"+X"), ("Y_SCREEN", -1, (2,), b"+Z")))
    settings = dict(read_markers(saved(tmp_path, made)).history[0].settings)
    assert (settings["right"], settings["up"]) == ("x", "z")


def test_more_frames_than_a_header_can_count_are_read(tmp_path):
    fields = [(f"ACTUAL_{w}_FIELD", 2, (2,), struct.pack("<2H", n, 0)) for w, n in (("START", 1), ("END", 7))]
    made = Made(last=65535, extra=(("LONG_FRAMES", 4, (), np.float32(7).tobytes()),))
    assert read_markers(saved(tmp_path, made)).n_frames == 7
    trial = struct.pack("bb", 5, -2) + b"TRIAL" + struct.pack("<H", 3) + b"\0"
    data = bytearray(Made(last=65535).bytes())
    end = data.index(b"RATE") - 2
    block = trial + b"".join(parameter(2, *f, "<") for f in fields)
    data[end:end] = block
    at = 512 + 1024
    del data[at : at + len(block)]
    assert read_markers(saved(tmp_path, bytes(data))).n_frames == 7


def test_a_header_that_disagrees_is_told(tmp_path):
    made = Made(extra=(("FRAMES", 2, (), struct.pack("<h", 9)),))
    (note,) = reading_notes(read_markers(saved(tmp_path, made)))
    assert "7 frames" in note
    assert "says 9" in note


WRONG = {
    "text": (b"x, y, z\n" * 400, "does not begin"),
    "only a start": (b"\2\x50" + bytes(100), "cut short"),
    "parameters outside": (b"\x90\x50" + bytes(2000), "outside the file"),
    "unknown processor": (b"\2\x50" + bytes(2000), "processor 0"),
    "no points": (Made(n_points=0), "no points"),
    "no frames": (Made(first=1, last=0), "no frames"),
    "cut in the frames": (Made().bytes()[:-30], "7 frames and it holds 6"),
    "cut in the parameters": (Made().bytes()[:1024], "7 frames and it holds 0"),
    "no rate": (Made(rate_hz=0.0), "frame rate"),
    "a rate that is none": (Made(rate_hz=float("nan")), "frame rate"),
    "all of it zeros": (bytes(4096), "does not begin"),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_no_c3d_is_refused(tmp_path, what):
    made, words = WRONG[what]
    assert words in refusal(saved(tmp_path, made))


@given(data=st.data())
def test_flipped_bytes_never_crash_and_never_hang(tmp_path_factory, data):
    bad = bytearray(Made(extra=(("FRAMES", 2, (), struct.pack("<h", 7)),)).bytes())
    for _ in range(data.draw(st.integers(1, 6))):
        bad[data.draw(st.integers(0, 760))] = data.draw(st.integers(0, 255))
    path = tmp_path_factory.mktemp("c3d") / "a.c3d"
    path.write_bytes(bad)
    try:
        capture = read_markers(path)
    except InputError as error:
        assert str(path) in str(error)  # noqa: PT017  either outcome is right
    else:
        assert 1 <= capture.n_frames <= 1000


def test_ezc3d_reads_what_is_written(tmp_path):
    positions = POSITIONS.copy()
    positions[3, 1] = np.nan
    MOTION_WRITERS["c3d"](tmp_path / "a.c3d", positions, ["lip", "chin é", "head1"], 120.0)
    file = ezc3d.c3d(str(tmp_path / "a.c3d"))
    np.testing.assert_allclose(file["data"]["points"][:3].transpose(2, 1, 0), positions, rtol=1e-6)
    assert file["data"]["meta_points"]["residuals"][0, 1, 3] == -1
    point = file["parameters"]["POINT"]
    assert point["UNITS"]["value"] == ["mm"]
    assert point["RATE"]["value"] == [120.0]
    assert point["LABELS"]["value"][0] == "lip"


def test_names_that_cannot_stand_in_a_c3d_are_not_written(tmp_path):
    for name in ("*3", "x" * 200):
        with pytest.raises(MotionError, match="C3D file"):
            MOTION_WRITERS["c3d"](tmp_path / "a.c3d", POSITIONS[:, :1], [name], 120.0)
    assert not list(tmp_path.iterdir())


def test_more_markers_than_a_list_of_labels_holds(tmp_path):
    names = [f"m{i}" for i in range(300)]
    positions = RNG.normal(size=(3, 300, 3))
    MOTION_WRITERS["c3d"](tmp_path / "a.c3d", positions, names, 120.0)
    back = read_markers(tmp_path / "a.c3d")
    assert back.names == tuple(names)
    np.testing.assert_allclose(back.positions_mm, positions, rtol=1e-6)
