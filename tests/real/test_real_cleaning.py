"""203 recorded sentences cleaned: scale, posture, closures and timing as they were first measured."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from corpus_tools.cleaning import clean_captures, gaps, neutral_pose
from corpus_tools.core import FrameFlag
from corpus_tools.io import read_labels, read_markers
from corpus_tools.speech import (
    APERTURE_PAIRS,
    closure_offset,
    closure_threshold_mm,
    lip_aperture_mm,
    phone_set,
    recorded_utterance,
)

PHONES = phone_set("arpabet")
STABLE = ("nose0", "nose1", "eye0", "eye2", "eye4", "eye6")


@pytest.fixture(scope="module")
def captures(corpora):
    files = sorted((corpora / "grid_s1" / "markers73").glob("*.npz"))
    read = {file.stem: read_markers(file) for file in files}
    return {name: replace(c, start_s=0.5 / c.rate_hz) for name, c in read.items()}


@pytest.fixture(scope="module")
def utterances(corpora, captures):
    labels = {name: read_labels(corpora / "grid_s1" / "textgrid" / f"{name}.TextGrid") for name in captures}
    return [recorded_utterance(name, labels[name], None, PHONES) for name in captures]


@pytest.fixture(scope="module")
def columns(captures):
    names = next(iter(captures.values())).names
    return [i for i, n in enumerate(names) if n.startswith("head") or n in STABLE]


@pytest.fixture(scope="module")
def similar(captures, columns):
    return clean_captures(list(captures.values()), columns, allow_scale=True, head_support=False)


@pytest.fixture(scope="module")
def rigid(captures, columns):
    return clean_captures(list(captures.values()), columns, allow_scale=False, head_support=False)


def posture_sd_mm(cleaned, utterances):
    """Return how much the face before speech differs between recordings, mm: 3-D, lips and chin."""
    speech = [i for i, r in enumerate(cleaned[0].regions) if r in ("lip_out", "lip_in", "chin")]
    before = []
    for capture, utterance in zip(cleaned, utterances, strict=True):
        n = max(2, int((utterance.phones.intervals[0].end_s - 0.1) * capture.rate_hz))
        before.append(capture.positions_mm[:n, speech].mean(axis=0))
    return np.sqrt(np.var(before, axis=0).sum(axis=-1).mean())


def test_the_distance_to_the_camera_varies(similar):
    assert 0.022 < similar.scale_sd < 0.034
    by_recording = [np.median(m.scale) for m in similar.head_motion]
    assert np.std(by_recording) > 4 * np.mean([m.scale.std() for m in similar.head_motion])


def test_scale_brings_the_recordings_together(rigid, similar, utterances):
    assert posture_sd_mm(rigid.captures, utterances) == pytest.approx(3.04, abs=0.1)
    assert posture_sd_mm(similar.captures, utterances) == pytest.approx(1.82, abs=0.05)


def test_head_markers_alone_hold_the_face_less_well(captures, similar, utterances):
    """Alone 2.4 mm, with markers named by hand 1.8 mm, with those found to be steady 1.67 mm."""
    only_head = list(range(66, 73))
    assert {n[:4] for n in next(iter(captures.values())).names[66:]} == {"head"}
    alone, supported = (
        posture_sd_mm(
            clean_captures(list(captures.values()), only_head, allow_scale=True, head_support=on).captures,
            utterances,
        )
        for on in (False, True)
    )
    by_hand = posture_sd_mm(similar.captures, utterances)
    assert alone > by_hand + 0.4
    assert supported < by_hand - 0.1


def unsigned_aperture_mm(capture):
    where = {n: i for i, n in enumerate(capture.names)}
    p = capture.positions_mm
    return np.mean([np.linalg.norm(p[:, where[a]] - p[:, where[b]], axis=1) for a, b in APERTURE_PAIRS], 0)


def test_lips_close_when_a_frame_stands_for_its_middle(similar, utterances):
    """The lips at bilabial centres are 1.44 mm apart with frame i at i/25 s, and 0.88 mm at its middle."""
    found = {-0.02: [], 0.0: [], 0.02: []}
    for capture, utterance in zip(similar.captures, utterances, strict=True):
        curve = CubicSpline(capture.times_s, unsigned_aperture_mm(capture))
        for phone in utterance.phones:
            if phone.text in PHONES.bilabials and phone.start_s > 0.15:
                for shift, values in found.items():
                    values.append(curve(phone.centre_s - shift))
    assert [np.mean(v) for v in found.values()] == pytest.approx([1.44, 0.88, 0.93], abs=0.03)


def test_the_closure_offset_says_that_the_frames_are_centred(similar, utterances):
    centred = closure_offset(similar.captures, utterances, PHONES)
    assert abs(centred) < 0.5 / 25
    at_the_start = [replace(c, start_s=0.0) for c in similar.captures]
    assert closure_offset(at_the_start, utterances, PHONES) == pytest.approx(centred + 0.02, abs=0.002)


def test_the_speakers_own_threshold_of_closure(similar, utterances):
    """0.88 mm was measured on another split with the unsigned distance; the signed height is smaller."""
    unsigned = []
    for capture, utterance in zip(similar.captures, utterances, strict=True):
        aperture, times = unsigned_aperture_mm(capture), capture.times_s
        for phone in utterance.phones:
            if phone.text in PHONES.bilabials:
                near = (times >= phone.start_s - 0.04) & (times <= phone.end_s + 0.04)
                unsigned.append(aperture[near].min())
    assert np.percentile(unsigned, 95) == pytest.approx(0.88, abs=0.05)
    assert closure_threshold_mm(similar.captures, utterances, PHONES) == pytest.approx(0.38, abs=0.05)


def test_the_two_gaps_are_found_and_filled_with_doubt(captures, similar):
    holes = {name: gaps(c) for name, c in captures.items() if gaps(c)}
    assert holes == {"lgbf8n": [(0, 11)], "pbwx1s": [(0, 11)]}
    cleaned = dict(zip(captures, similar.captures, strict=True))
    for name, capture in cleaned.items():
        assert np.isfinite(capture.positions_mm).all()
        doubtful = (capture.flags & int(FrameFlag.DOUBTFUL)) > 0
        assert doubtful[:12].all() == (name in holes)
        assert not doubtful[12:].any()


def test_smoothing_takes_out_noise_and_not_speech(captures, similar):
    raw = [
        m.stabilise(c.positions_mm)[12:] for c, m in zip(captures.values(), similar.head_motion, strict=True)
    ]
    clean = [c.positions_mm[12:] for c in similar.captures]
    mouth = slice(38, 66)
    removed = np.concatenate([(a - b)[:, mouth] for a, b in zip(raw, clean, strict=True)])
    assert 0.1 < np.sqrt((removed**2).sum(axis=2).mean()) < 0.3
    names = similar.captures[0].names
    before = np.concatenate([lip_aperture_mm(a, names) for a in raw])
    after = np.concatenate([lip_aperture_mm(a, names) for a in clean])
    assert np.corrcoef(before, after)[0, 1] > 0.995


def test_the_neutral_mouth_is_closed(similar, utterances):
    quiet = []
    for capture, utterance in zip(similar.captures, utterances, strict=True):
        aperture = lip_aperture_mm(capture.positions_mm, capture.names)
        silent = capture.times_s < utterance.phones.intervals[0].end_s - 0.1
        quiet.append(silent & (aperture < 0.4))
    neutral = neutral_pose(similar.captures, quiet)
    assert neutral.shape == (73, 3)
    assert -0.5 < lip_aperture_mm(neutral[None], similar.captures[0].names)[0] < 0.4
    names = list(similar.captures[0].names)
    assert neutral[names.index("brow0"), 1] > neutral[names.index("lip_in2"), 1]
