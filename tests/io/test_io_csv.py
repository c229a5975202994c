"""Tables of positions as people have them: any order of columns, any locale, and every way to be wrong."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import InputError
from corpus_tools.io import read_markers, reading_notes

XYZ = np.random.default_rng(5).normal(0, 50, (6, 2, 3)).round(4)
HEADER = ["time_s", "lip_X", "lip_Y", "lip_Z", "chin_X", "chin_Y", "chin_Z"]


def rows(positions=XYZ, header=HEADER, rate_hz=50.0):
    out = [list(header)]
    for i, frame in enumerate(positions.reshape(len(positions), -1)):
        out.append([f"{i / rate_hz:.4f}", *("" if np.isnan(v) else f"{v:.4f}" for v in frame)])
    return out


def text(table, delimiter=",", end="\n"):
    return end.join(delimiter.join(row) for row in table) + end


def saved(tmp_path, content, name="a.csv", encoding="utf-8"):
    path = tmp_path / name
    path.write_bytes(content.encode(encoding))
    return path


def refusal(path, **given_by_caller):
    with pytest.raises(InputError) as caught:
        read_markers(path, **given_by_caller)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert str(caught.value).endswith(".")
    return str(caught.value)


def assert_same(capture, positions=XYZ, rate_hz=50.0):
    columns = [capture.names.index(n) for n in ("lip", "chin")]
    np.testing.assert_allclose(capture.positions_mm[:, columns], positions, atol=1e-9)
    assert capture.rate_hz == rate_hz


@given(order=st.permutations(range(7)))
def test_columns_are_found_by_name_in_any_order(tmp_path_factory, order):
    table = [[row[i] for i in order] for row in rows()]
    assert_same(read_markers(saved(tmp_path_factory.mktemp("order"), text(table))))


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize(
    ("delimiter", "comma"), [(",", False), (";", False), ("\t", False), (";", True), ("\t", True)]
)
def test_locales(tmp_path, end, encoding, delimiter, comma):
    table = rows()
    if comma:
        table = [table[0], *([c.replace(".", ",") for c in row] for row in table[1:])]
    assert_same(read_markers(saved(tmp_path, text(table, delimiter, end), encoding=encoding)))


@pytest.mark.parametrize(
    "style", ["{}_x", "{}.X", "{} y", "{}-Z", "{}:x", "{}_X (mm)", "{}_y_mm", "{} Z [mm]"]
)
def test_names_of_coordinates(tmp_path, style):
    letter = next(c for c in style if c in "xyzXYZ")
    swap = {a: (a.upper() if letter.isupper() else a) for a in "xyz"}
    header = [
        "Time (s)",
        *(
            style.format(n).replace(letter, swap[a], 1) if letter not in n else ""
            for n in ("lip", "chin")
            for a in "xyz"
        ),
    ]
    assert_same(read_markers(saved(tmp_path, text(rows(header=header)))))


def test_quoted_names_and_names_with_the_delimiter(tmp_path):
    table = rows(header=["time_s", *(f'"lip, ""upper""_{a}"' for a in "XYZ"), *(f"chin_{a}" for a in "XYZ")])
    capture = read_markers(saved(tmp_path, text(table)))
    assert capture.names == ('lip, "upper"', "chin")


def test_blank_rows_other_columns_and_missing_words(tmp_path):
    positions = XYZ.copy()
    positions[2, 1] = np.nan
    table = rows(positions)
    for row, word in zip(table[1:], ["a", "b", "", "d", "e", "f"], strict=True):
        row.append(word)
    table[0].append("Stimulus")
    table[3][4:7] = ["NA", "NaN", "null"]
    content = "\n" + text(table).replace("\n", "\n,,,\n\n", 1) + "\n\n"
    capture = read_markers(saved(tmp_path, content))
    assert_same(capture, positions)
    assert dict(capture.history[0].settings)["columns_left_out"] == "Stimulus"


@pytest.mark.parametrize(("unit", "factor"), [("mm", 1), ("m", 1000), ("cm", 10), ("(in)", 25.4)])
def test_a_row_of_units_is_heard(tmp_path, unit, factor):
    table = rows()
    table.insert(1, ["s", *[unit] * 6])
    capture = read_markers(saved(tmp_path, text(table)))
    assert_same(capture, XYZ * factor)
    assert reading_notes(capture) == ()


def test_no_unit_is_told_and_settled_by_the_caller(tmp_path):
    path = saved(tmp_path, text(rows()))
    (note,) = reading_notes(read_markers(path))
    assert "marker_units" in note
    assert reading_notes(read_markers(path, units="mm")) == ()
    small = saved(
        tmp_path,
        text(
            rows(np.concatenate([XYZ, XYZ[:, :1] + 1], axis=1) / 1000, [*HEADER, *(f"n_{a}" for a in "XYZ")])
        ),
        "s.csv",
    )
    assert "no face" in reading_notes(read_markers(small))[1]


def test_milliseconds_and_rounded_times_give_the_rate(tmp_path):
    table = rows(rate_hz=60.0)
    times = [i / 60 for i in range(6)]
    for header, cells in (
        ("time_ms", [f"{1000 * t:.1f}" for t in times]),
        ("t", [f"{t:.3f}" for t in times]),
    ):
        changed = [[header, *table[0][1:]], *([c, *row[1:]] for c, row in zip(cells, table[1:], strict=True))]
        assert read_markers(saved(tmp_path, text(changed))).rate_hz == 60.0


def test_video_rates_are_recognised(tmp_path):
    positions = np.tile(XYZ, (100, 1, 1))
    rate = 30000 / 1001
    assert read_markers(saved(tmp_path, text(rows(positions, rate_hz=rate)))).rate_hz == pytest.approx(
        rate, rel=1e-12
    )


def test_frames_that_are_left_out_are_gaps_and_told(tmp_path):
    table = rows()
    del table[3:5]
    capture = read_markers(saved(tmp_path, text(table)), units="mm")
    expected = XYZ.copy()
    expected[2:4] = np.nan
    assert_same(capture, expected)
    (note,) = reading_notes(capture)
    assert note.startswith("2 frames are not in the file, the first after frame 1")


def test_times_that_start_late_are_told(tmp_path):
    table = rows()
    for i, row in enumerate(table[1:]):
        row[0] = f"{2.5 + i / 50:.4f}"
    (note,) = reading_notes(read_markers(saved(tmp_path, text(table)), units="mm"))
    assert "audio_offset_s = 2.5" in note


def test_frame_numbers_need_a_rate(tmp_path):
    table = rows(header=["Frame", *HEADER[1:]])
    for i, row in enumerate(table[1:]):
        row[0] = str(100 + i + (i > 3))
    path = saved(tmp_path, text(table))
    assert "rate_hz" in refusal(path)
    expected = np.insert(XYZ, 4, np.nan, axis=0)
    assert_same(read_markers(path, rate_hz=50.0), expected)
    table[3][0] = table[2][0]
    assert "line 4: frame 101 follows frame 101" in refusal(saved(tmp_path, text(table)), rate_hz=50.0)
    table[3][0] = "101.5"
    assert "no frame number" in refusal(saved(tmp_path, text(table)), rate_hz=50.0)


def long_rows(skip=()):
    out = [["marker", "frame", "z_mm", "time_s", "x_mm", "y_mm"]]
    for (i, m), name in zip(itertools.product(range(6), range(2)), ["lip", "chin"] * 6, strict=True):
        if (i, name) not in skip:
            x, y, z = (repr(float(v)) for v in XYZ[i, m])
            out.append([name, str(i), z, repr(i / 50), x, y])
    return out


@given(seed=st.integers(0, 1000))
def test_long_tables_in_any_order_of_rows(tmp_path_factory, seed):
    header, *body = long_rows()
    np.random.default_rng(seed).shuffle(body)
    assert_same(read_markers(saved(tmp_path_factory.mktemp("long"), text([header, *body]))))


def test_a_marker_without_a_row_is_missing_and_two_rows_are_refused(tmp_path):
    expected = XYZ.copy()
    expected[2, 1] = np.nan
    assert_same(read_markers(saved(tmp_path, text(long_rows(skip={(2, "chin")})))), expected)
    table = long_rows()
    table.append(table[4])
    assert "line 14: marker 'chin' stands twice" in refusal(saved(tmp_path, text(table)))
    table[-1] = ["nose", "1", "0", "9.0", "1", "2"]
    assert "line 14: the time 9 s" in refusal(saved(tmp_path, text(table)))
    nothing = [[c for i, c in enumerate(row) if i not in (1, 3)] for row in long_rows()]
    assert "no times or frames" in refusal(saved(tmp_path, text(nothing)))


def replaced(line, cell, value):
    table = rows()
    table[line - 1][cell] = value
    return text(table)


def nexus(rate="100", units="mm", extra=""):
    names = ",,s:lip,,,s:chin,,,s:*7,,"
    axes = "Frame,Sub Frame," + ",".join("XYZ" * 3)
    body = [
        f"{i + 1},0," + ",".join(f"{v:.4f}" for v in frame.ravel()) + ",1,2,3" for i, frame in enumerate(XYZ)
    ]
    return "\n".join([extra + "Trajectories", rate, names, axes, ",," + ",".join([units] * 9), *body]) + "\n"


def test_vicon_exports_read_also_after_other_sections(tmp_path):
    before = "Devices\n2000\nFrame,Sub Frame,Fx\n,,N\n1,0,3.5\n\n"
    for content in (
        nexus(),
        nexus(extra=before),
        nexus() + "\nModel Outputs\n100\n",
        nexus().replace(",", ";").replace(".", ","),
    ):
        capture = read_markers(saved(tmp_path, content))
        assert capture.names == ("lip", "chin")
        assert_same(capture, rate_hz=100.0)
        assert dict(capture.history[0].settings)["left_out"].startswith("1 ")
    np.testing.assert_allclose(read_markers(saved(tmp_path, nexus(units="m"))).positions_mm, XYZ * 1000)


WRONG = {
    "not a number": (replaced(4, 2, "1.2.3"), "line 4: '1.2.3' is no number"),
    "underscores": (replaced(4, 2, "1_000"), "'1_000'"),
    "infinite": (replaced(4, 2, "inf"), "infinitely far"),
    "a column twice": (replaced(1, 4, "lip_x"), "two columns for x of 'lip'"),
    "no z": (replaced(1, 6, "chin_W"), "'chin' has no column for z"),
    "time runs back": (replaced(4, 0, "0.0200"), "line 4: 0.02 s does not come after"),
    "no time": (replaced(4, 0, ""), "line 4: there is no time"),
    "uneven times": (replaced(4, 0, "0.0500"), "line 4: the times are not uniform"),
    "far apart": (replaced(7, 0, "99.98"), "6 of 5000 frames"),
    "decimal commas between commas": (
        text(rows()[:1]) + text([[c.replace(".", ",") for c in r] for r in rows()[1:]]),
        "semicolons",
    ),
    "both marks": (text(rows(), ";").replace("0.0400;", "0,0400;"), "line 2: '0.0000' is no number"),
    "a short last row": (text(rows()).rstrip()[:-40], "cut short"),
    "only a header": (text(rows()[:1]), "no frames"),
    "header and units": (text([HEADER, ["s", *["mm"] * 6]]), "no frames"),
    "two units": (text([HEADER, ["s", *["mm"] * 5, "cm"], *rows()[1:]]), "several units"),
    "a unit nobody knows": (text([HEADER, ["s", *["ell"] * 6], *rows()[1:]]), "'ell'"),
    "no markers": ("time_s,f0,rms\n0,1,2\n", "its first row: time_s, f0, rms"),
    "blendshapes": ("Timecode,BlendShapeCount,JawOpen\n0,61,0.5\n", "blendshape coefficients"),
    "quotes that do not close": ('time_s,"lip_X,lip_Y\n' + "0,1,2\n" * 5, "quotes"),
    "blank": ("\n\n ,, \n", "nothing but blank lines"),
    "not UTF-8": (b"time_s,l\xe4p_X,l\xe4p_Y\n".decode("latin-1"), "no UTF-8 text"),
    "NUL": ("time_s,a_X\0,\n", "NUL"),
    "vicon without names": ("Trajectories\n100\n", "no whole Vicon export"),
    "vicon of its title alone": ("Trajectories\n", "no whole Vicon export"),
    "vicon that ends with its title": ("Devices\n2000\nTrajectories\n", "no whole Vicon export"),
    "faster than any camera": (
        text([HEADER, *[[f"{i * 1e-12:.13f}", *row[1:]] for i, row in enumerate(rows()[1:])]]),
        "1 to 100000 Hz was expected",
    ),
    "a name of two lines": (text(rows()).replace("chin_", "ch\x07in_"), r"name 'ch\x07in' holds characters"),
    "vicon without frames": ("\n".join(nexus().split("\n")[:5]) + "\n", "no frames"),
    "vicon with a bad rate": (nexus(rate="fast"), "'fast'"),
    "vicon without units": (nexus(units=""), "in which unit"),
    "vicon with a name twice": (nexus().replace("s:chin", "s:lip"), "'s:lip' stands twice"),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_wrong_costs_one_sentence_that_says_where(tmp_path, what):
    content, words = WRONG[what]
    encoding = "latin-1" if what == "not UTF-8" else "utf-8"
    assert words in refusal(saved(tmp_path, content, encoding=encoding))


@given(data=st.data())
def test_rows_that_are_cut_lost_or_doubled_give_motion_or_a_sentence(tmp_path_factory, data):
    content = data.draw(st.sampled_from([nexus(), nexus(extra="Devices\n2000\n1,0\n"), text(rows())]))
    lines = content.splitlines()
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(lines) - 1))
        change = data.draw(st.sampled_from(["end here", "lose", "double", "first cell alone"]))
        if change == "end here":
            lines = lines[: at + 1]
        elif change == "lose":
            lines[at] = ""
        elif change == "double":
            lines.insert(at, lines[at])
        else:
            lines[at] = lines[at].split(",")[0]
    path = saved(tmp_path_factory.mktemp("rows"), "\n".join(lines) + "\n")
    try:
        assert np.isfinite(read_markers(path).rate_hz)
    except InputError as error:
        assert str(path) in str(error)  # noqa: PT017  either outcome is right
        assert "\n" not in str(error)  # noqa: PT017
