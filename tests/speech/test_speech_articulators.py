"""Lip aperture, width and jaw; the speaker's own closures; the offset at which lips and labels agree."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import Capture, Interval, Tier, Utterance
from corpus_tools.speech import (
    APERTURE_PAIRS,
    aperture_functional,
    bilabial_minima_mm,
    closure_offset,
    closure_threshold_mm,
    jaw_mm,
    lip_aperture_mm,
    lip_width_mm,
    phone_set,
)

PHONES = phone_set("arpabet")
INNER = tuple(f"lip_in{i}" for i in range(8))
OUTER = tuple(f"lip_out{i}" for i in range(12))
NAMES = (*OUTER, *INNER, "nose5", "chin3")
UPPER = ("lip_in1", "lip_in2", "lip_in3")


def mouth(aperture_mm, names=NAMES):
    """Return frames (F, M, 3) of a mouth of the given apertures: upper markers move up, others stay."""
    positions = np.random.default_rng(1).normal(size=(len(aperture_mm), len(names), 3))
    for upper, lower in APERTURE_PAIRS:
        lower_y = positions[:, names.index(lower), 1]
        positions[:, names.index(upper), 1] = lower_y + aperture_mm
    return positions


def test_aperture_is_the_mean_signed_height_between_the_inner_lips():
    wanted = np.array([0.0, 3.5, -0.7])
    assert lip_aperture_mm(mouth(wanted), NAMES) == pytest.approx(wanted)


def test_pairs_of_unlike_height_are_averaged():
    positions = np.zeros((1, len(NAMES), 3))
    for upper, height in zip(UPPER, (1.0, 2.0, 6.0), strict=True):
        positions[0, NAMES.index(upper), 1] = height
    assert lip_aperture_mm(positions, NAMES) == pytest.approx([3.0])


@given(st.tuples(*[st.floats(-50, 50)] * 3), st.floats(0.1, 5))
def test_aperture_ignores_place_and_follows_size(shift, size):
    positions = mouth(np.array([1.0, -2.0]))
    moved = size * positions + np.array(shift)
    assert lip_aperture_mm(moved, NAMES) == pytest.approx(size * np.array([1.0, -2.0]), abs=1e-9)


def test_without_inner_lips_the_outer_ones_are_measured():
    positions = np.zeros((1, len(OUTER), 3))
    for name in ("lip_out2", "lip_out3", "lip_out4"):
        positions[0, OUTER.index(name), 1] = 12.0
    assert lip_aperture_mm(positions, OUTER) == pytest.approx([12.0])
    assert not aperture_functional(["brow0", "chin0"]).any()


def test_a_frame_that_misses_any_marker_has_no_aperture():
    positions = mouth(np.array([1.0, 2.0, 3.0]))
    positions[1, NAMES.index("chin3")] = np.nan
    assert np.isnan(lip_aperture_mm(positions, NAMES)).tolist() == [False, True, False]
    assert not lip_aperture_mm(np.ones((2, 1, 3)), ["chin0"]).any()


def test_width_and_jaw_are_distances():
    positions = np.zeros((2, len(NAMES), 3))
    positions[:, NAMES.index("lip_out6")] = [3.0, 4.0, 0.0]
    positions[1, NAMES.index("chin3")] = [0.0, -60.0, 11.0]
    assert lip_width_mm(positions, NAMES) == pytest.approx([5.0, 5.0])
    assert jaw_mm(positions, NAMES) == pytest.approx([0.0, 61.0])


def speaking(closed_at_s, early_s=0.0, rate_hz=100.0, duration_s=4.0, depth_mm=0.5):
    """Return a capture whose lips close for M at the given times (moved by -early_s), and its utterance."""
    times = np.arange(round(duration_s * rate_hz)) / rate_hz
    aperture = np.full(len(times), 8.0)
    for centre in closed_at_s:
        aperture -= (8.0 - depth_mm) * np.exp(-(((times - centre + early_s) / 0.06) ** 2))
    rows, last = [], 0.0
    for centre in closed_at_s:
        rows += [Interval(last, centre - 0.04, "AA"), Interval(centre - 0.04, centre + 0.04, "M")]
        last = centre + 0.04
    utterance = Utterance("a", "", Tier("phones", (*rows, Interval(last, duration_s, "SIL"))))
    return Capture(mouth(aperture), rate_hz, NAMES), utterance


CENTRES = (0.5, 1.0, 1.5, 2.1, 2.8, 3.3)


def test_the_minimum_of_every_bilabial_is_found():
    capture, utterance = speaking(CENTRES)
    assert bilabial_minima_mm(capture, utterance, PHONES) == pytest.approx([0.5] * 6, abs=0.01)


def test_a_closure_that_the_labels_miss_by_little_is_found():
    capture, utterance = speaking(CENTRES, early_s=0.07)  # 30 ms before the phone begins
    assert bilabial_minima_mm(capture, utterance, PHONES) == pytest.approx([0.5] * 6, abs=0.01)
    capture, utterance = speaking(CENTRES, early_s=0.12)
    assert bilabial_minima_mm(capture, utterance, PHONES).min() > 2.0


def test_a_bilabial_outside_the_motion_has_no_minimum():
    capture, utterance = speaking(CENTRES)
    half = Capture(capture.positions_mm[:200], 100.0, NAMES)
    assert len(bilabial_minima_mm(half, utterance, PHONES)) == 3


def test_missing_frames_have_no_minimum():
    capture, utterance = speaking(CENTRES)
    positions = np.array(capture.positions_mm)
    positions[90:115] = np.nan
    assert len(bilabial_minima_mm(Capture(positions, 100.0, NAMES), utterance, PHONES)) == 5


def test_the_threshold_is_the_95th_percentile_of_the_speakers_own_closures():
    spoken = [speaking(CENTRES, depth_mm=d) for d in np.linspace(0.0, 2.0, 21)]
    found = closure_threshold_mm([c for c, _ in spoken], [u for _, u in spoken], PHONES)
    assert found == pytest.approx(1.9, abs=0.02)


def test_a_corpus_without_bilabials_has_no_threshold():
    capture, _ = speaking(CENTRES)
    mute = Utterance("a", "", Tier("phones", (Interval(0, 1, "AA"),)))
    assert np.isnan(closure_threshold_mm([capture], [mute], PHONES))
    assert np.isnan(closure_threshold_mm([], [], PHONES))
    assert closure_offset([capture], [mute], PHONES) is None


@given(st.floats(-0.06, 0.06))
def test_motion_that_comes_too_early_asks_for_a_later_start(early_s):
    capture, utterance = speaking(CENTRES, early_s)
    assert closure_offset([capture], [utterance], PHONES) == pytest.approx(early_s, abs=0.001)


def test_the_asked_offset_mends_the_corpus():
    capture, utterance = speaking(CENTRES, 0.033)
    offset = closure_offset([capture], [utterance], PHONES)
    mended = Capture(capture.positions_mm, capture.rate_hz, NAMES, start_s=offset)
    assert closure_offset([mended], [utterance], PHONES) == pytest.approx(0.0, abs=0.0005)


def test_lips_that_do_not_move_or_close_out_of_reach_say_nothing():
    capture, utterance = speaking(CENTRES)
    still = np.repeat(capture.positions_mm[:1], capture.n_frames, axis=0)
    for share in (0.0, 1e-4):
        barely = still + share * (capture.positions_mm - still)
        assert closure_offset([Capture(barely, 100.0, NAMES)], [utterance], PHONES) is None
    for early_s in (-0.13, 0.13):
        capture, utterance = speaking(CENTRES, early_s)
        assert closure_offset([capture], [utterance], PHONES) is None


def test_too_few_closures_say_nothing():
    capture, utterance = speaking(CENTRES[:4])
    assert closure_offset([capture], [utterance], PHONES) is None
