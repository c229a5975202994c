"""TRC: gaps stay in their own column, and a header that lies is told with both numbers."""

from __future__ import annotations

import numpy as np
import pytest

from corpus_tools.core import MotionError
from corpus_tools.io import MOTION_WRITERS, read_markers

XYZ = np.random.default_rng(5).normal(0, 50, (6, 3, 3)).round(4)
NAMES = ["lip", "chin", "head1"]


@pytest.fixture
def lines(tmp_path):
    """Return the lines of a good file with a gap in its middle marker."""
    positions = XYZ.copy()
    positions[2:4, 1] = np.nan
    MOTION_WRITERS["trc"](tmp_path / "good.trc", positions, NAMES, 100.0)
    return (tmp_path / "good.trc").read_text().split("\n")


def saved(tmp_path, lines, end="\n"):
    path = tmp_path / "a.trc"
    path.write_bytes(end.join(lines).encode())
    return path


def refusal(path, **given_by_caller):
    with pytest.raises(MotionError) as caught:
        read_markers(path, **given_by_caller)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert str(caught.value).endswith(".")
    return str(caught.value)


def test_markers_after_a_gap_do_not_move(tmp_path, lines):
    assert "\t\t\t" in lines[8]
    for end in ("\n", "\r\n"):
        capture = read_markers(saved(tmp_path, lines, end))
        assert np.isnan(capture.positions_mm[2:4, 1]).all()
        np.testing.assert_allclose(capture.positions_mm[:, 2], XYZ[:, 2], atol=1e-6)
        assert np.isfinite(capture.positions_mm[:, [0, 2]]).all()


def test_trailing_tabs_blank_lines_and_decimal_commas_are_no_matter(tmp_path, lines):
    good = read_markers(saved(tmp_path, lines))
    loose = [line + "\t" if i > 5 and line else line for i, line in enumerate(lines)]
    comma = [line.replace(".", ",") if i > 5 else line for i, line in enumerate(lines)]
    for changed in (loose, [*lines[:5], *lines[6:]], [*lines, "", "\t\t"], comma):
        np.testing.assert_array_equal(read_markers(saved(tmp_path, changed)).positions_mm, good.positions_mm)


def test_units_and_rate_are_heard(tmp_path, lines):
    lines[2] = lines[2].replace("\tmm\t", "\tm\t")
    np.testing.assert_allclose(
        read_markers(saved(tmp_path, lines)).positions_mm[:, 0], XYZ[:, 0] * 1000, atol=1e-3
    )
    lines[2] = lines[2].replace("\tm\t", "\t\t")
    path = saved(tmp_path, lines)
    assert "in which unit" in refusal(path)
    np.testing.assert_allclose(read_markers(path, units="mm").positions_mm[:, 0], XYZ[:, 0], atol=1e-6)


def edit(line, old, new):
    def change(lines):
        assert old in lines[line]
        lines[line] = lines[line].replace(old, new, 1)
        return lines

    return change


WRONG = {
    "frames": (edit(2, "\t6\t", "\t652\t"), ["says 652 frames and 6 rows follow"]),
    "markers": (edit(2, "\t3\t", "\t5\t"), ["says 5 markers and names 3"]),
    "both": (edit(2, "\t6\t3\t", "\t7\t4\t"), ["7 frames and 6 rows", "4 markers and names 3"]),
    "rate": (edit(2, "100.0", "120.0"), ["DataRate is 120", "run at 100 Hz", "rate_hz"]),
    "no rate": (edit(1, "DataRate", "Rate"), ["no DataRate"]),
    "rate is a word": (edit(2, "100.0", "fast"), ["DataRate is 'fast'"]),
    "cut short": (lambda lines: lines[:9], ["6 frames and 3 rows"]),
    "cut in a row": (lambda lines: [*lines[:11], lines[11][:30]], ["line 12 has 4 cells"]),
    "commas": (lambda lines: [line.replace("\t", ",") for line in lines], ["separated by commas"]),
    "nothing between columns": (lambda lines: ["PathFileType", *["x"] * 6], ["no tabs in its first lines"]),
    "spaces": (lambda lines: [" ".join(line.split()) for line in lines], ["separated by spaces"]),
    "commas and lies": (
        lambda lines: [line.replace("\t", ",") for line in edit(2, "\t6\t", "\t652\t")(lines)],
        ["separated by commas", "says 652 frames and 6 rows follow"],
    ),
    "a name in the wrong column": (
        edit(3, "chin\t\t\t", "chin\t\t"),
        ["'head1' does not stand over an x column"],
    ),
    "an axis is gone": (edit(4, "\tZ2", ""), ["names 8 coordinates", "3 markers"]),
    "a name twice": (edit(3, "chin", "lip"), ["'lip' stands more than once"]),
    "a word for a number": (edit(8, "\t0.020000000", "\tsoon"), ["line 9: 'soon' is no number"]),
    "no times": (edit(8, "\t0.020000000", "\t"), ["line 9: there is no time"]),
    "only a start": (lambda lines: lines[:2], ["header is not whole"]),
    "another file": (lambda lines: ["hello", *lines], ["does not begin with 'PathFileType'"]),
    "no rows": (lambda lines: edit(2, "\t6\t", "\t0\t")(lines)[:5], ["no frames"]),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_wrong_costs_one_sentence(tmp_path, lines, what):
    change, words = WRONG[what]
    message = refusal(saved(tmp_path, change(lines)))
    assert all(word in message for word in words), message


def test_a_wrong_rate_can_be_overruled(tmp_path, lines):
    lines = edit(2, "100.0", "120.0")(lines)
    assert read_markers(saved(tmp_path, lines), rate_hz=100.0).rate_hz == 100.0
