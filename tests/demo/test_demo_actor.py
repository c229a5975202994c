"""The simulated actor: markers as a capture names them, articulators true to their names, lips that meet."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import InputError
from corpus_tools.demo import DIMENSIONS, HEAD_MARKERS, LAYOUTS, layout_columns, marker_names, true_markers
from corpus_tools.mesh import bundled_head
from corpus_tools.speech import lip_aperture_mm, lip_width_mm

NAMES = marker_names()[:66]
COUNTS = {"brow": 10, "eye": 8, "nose": 6, "cheek": 14, "lip_out": 12, "lip_in": 8, "chin": 8, "head": 7}
JAWS = (0.1, 0.3, 0.5)


def posture(**articulators):
    row = np.zeros((1, len(DIMENSIONS)))
    for name, value in articulators.items():
        row[0, DIMENSIONS.index(name)] = value
    return true_markers(row)


def test_markers_and_their_groups_are_those_of_a_capture_of_66_on_the_face_and_7_on_the_head():
    expected = tuple(f"{group}{i}" for group, n in COUNTS.items() for i in range(n))
    assert marker_names() == expected
    assert marker_names()[66:] == HEAD_MARKERS


@pytest.mark.parametrize("layout", list(LAYOUTS))
def test_a_layout_keeps_the_order_of_the_markers_and_the_whole_head(layout):
    columns = layout_columns(layout)
    assert columns == sorted(set(columns))
    assert set(range(66, 73)) <= set(columns)


def test_layouts_are_full_or_without_inner_lips():
    assert layout_columns("full") == list(range(73))
    left_out = {marker_names()[i] for i in set(range(73)) - set(layout_columns("outer-lips"))}
    assert left_out == {f"lip_in{i}" for i in range(8)}
    with pytest.raises(InputError, match="outer-lips"):
        layout_columns("outer")


@given(st.lists(st.floats(0, 1), min_size=5, max_size=5))
def test_lips_never_cross_and_a_full_closure_closes_whatever_the_jaw_does(articulators):
    row = np.array([articulators])
    assert lip_aperture_mm(true_markers(row), NAMES)[0] >= -1e-9
    row[0, DIMENSIONS.index("close")] = 1.0
    assert abs(lip_aperture_mm(true_markers(row), NAMES)[0]) < 1e-9


def test_articulators_do_what_they_are_called():
    rest = posture()
    assert lip_aperture_mm(posture(jaw=1.0), NAMES)[0] > 8.0
    assert lip_width_mm(posture(round=1.0), NAMES)[0] < lip_width_mm(rest, NAMES)[0] - 3.0
    assert lip_width_mm(posture(spread=1.0), NAMES)[0] > lip_width_mm(rest, NAMES)[0] + 2.0
    forward = posture(round=1.0)[0, NAMES.index("lip_out3"), 2] - rest[0, NAMES.index("lip_out3"), 2]
    assert forward > 4.0, "rounded lips protrude"


@pytest.mark.parametrize("jaw", JAWS)
def test_a_bite_brings_the_lower_lip_to_the_upper_teeth_while_the_upper_lip_stays_off(jaw):
    head = bundled_head()
    teeth = head.vertices_mm[head.part == head.part_names.index("upper_teeth")]
    edge = teeth[(np.abs(teeth[:, 0]) < 9) & (teeth[:, 2] > 140)]
    lower = NAMES.index("lip_in6")
    free, bitten = posture(jaw=jaw)[0], posture(jaw=jaw, bite=1.0)[0]
    assert edge[:, 1].min() < bitten[lower, 1] < edge[:, 1].max(), "as high as the teeth"
    assert bitten[lower, 2] - edge[:, 2].max() < 2.0, "the vertex is on the outside of a lip some mm thick"
    assert bitten[lower, 1] > free[lower, 1] + 2.0
    assert bitten[NAMES.index("lip_in2"), 1] > free[NAMES.index("lip_in2"), 1]
