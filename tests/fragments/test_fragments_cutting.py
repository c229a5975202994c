import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import Capture, FrameFlag, InputError, MotionError, Recording, UnitRef
from corpus_tools.fragments import build_inventory, cut_fragment
from tests.strategies.inventories import MARKERS, capture, corpora, recording, utterance


@given(corpora(), st.data())
def test_a_fragment_is_the_motion_from_centre_to_centre_with_context(recordings, data):
    inventory = build_inventory(recordings)
    item = data.draw(st.sampled_from(recordings))
    last = data.draw(st.integers(1, len(item.utterance.labels) - 1))
    first = data.draw(st.integers(0, last - 1))
    context_s = data.draw(st.floats(0.03, 0.5))
    fragment = cut_fragment(inventory, UnitRef(item.name, first, last), context_s)
    intervals = item.utterance.phones.intervals[first : last + 1]
    assert fragment.phones == item.utterance.labels[first : last + 1]
    np.testing.assert_allclose(fragment.centres_s, [i.centre_s for i in intervals])
    times = item.capture.times_s
    inside = (times >= fragment.centres_s[0] - context_s - 1e-9) & (
        times <= fragment.centres_s[-1] + context_s + 1e-9
    )
    np.testing.assert_array_equal(fragment.times_s, times[inside])
    np.testing.assert_array_equal(fragment.motion_mm, item.capture.positions_mm[inside])


def test_flags_go_with_the_frames():
    spoken = utterance("a", ["SIL", "P", "A", "SIL"])
    moved = capture(spoken, np.random.default_rng(0), filled=[(12, 14)])
    inventory = build_inventory([Recording(spoken, moved)])
    fragment = cut_fragment(inventory, UnitRef("a", 0, 1), 0.0)
    filled = (fragment.flags & FrameFlag.FILLED).all(axis=1)
    np.testing.assert_allclose(fragment.times_s[filled], [0.12, 0.13, 0.14])
    assert not (cut_fragment(inventory, UnitRef("a", 1, 2), 0.0).flags & FrameFlag.FILLED).any()


def test_a_late_start_of_the_capture_is_respected():
    spoken = utterance("a", ["SIL", "P", "A", "SIL"])
    moved = Capture(np.zeros((40, len(MARKERS), 3)), 100.0, MARKERS, start_s=0.02)
    fragment = cut_fragment(build_inventory([Recording(spoken, moved)]), UnitRef("a", 0, 1), 0.25)
    assert fragment.times_s[0] == pytest.approx(0.02)


@pytest.mark.parametrize(("first", "last"), [(2, 2), (3, 1), (-1, 2), (0, 9)])
def test_phones_that_are_not_there_are_refused(first, last):
    inventory = build_inventory([recording("a", ["SIL", "P", "A", "SIL"])])
    with pytest.raises(InputError, match=r"phones 0 to 3 are there"):
        cut_fragment(inventory, UnitRef("a", first, last))


def test_an_unknown_recording_is_named():
    with pytest.raises(InputError, match="'bb'"):
        cut_fragment(build_inventory([recording("a", ["SIL", "P", "SIL"])]), UnitRef("bb", 0, 1))


def test_a_capture_that_ends_too_early_is_named():
    spoken = utterance("a", ["SIL", "P", "A", "SIL"])
    short = Capture(np.zeros((5, len(MARKERS), 3)), 100.0, MARKERS)
    with pytest.raises(MotionError, match="capture of 'a' has 0 frames"):
        cut_fragment(build_inventory([Recording(spoken, short)]), UnitRef("a", 2, 3), 0.02)
