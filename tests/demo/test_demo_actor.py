"""The simulated actor: noise, gaps and head motion are what was asked for; lips do not cross in the truth."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.demo import DIMENSIONS, Disturbances, disturb, true_markers
from corpus_tools.demo.actor import HEAD_MARKERS, marker_names
from corpus_tools.speech import lip_aperture_mm, lip_width_mm

RATE_HZ = 120.0
STILL = Disturbances(skin_mm=0.0, sensor_mm=0.0, n_gaps=0, rotation_deg=0.0, translation_mm=0.0)


def only(**changes):
    return dataclasses.replace(STILL, **changes)


@pytest.fixture(scope="module")
def face():
    """Six seconds of a face at rest, (720, 66, 3) mm."""
    return true_markers(np.zeros((720, len(DIMENSIONS))))


def posture(**articulators):
    row = np.zeros((1, len(DIMENSIONS)))
    for name, value in articulators.items():
        row[0, DIMENSIONS.index(name)] = value
    return true_markers(row)


def test_markers_are_named_as_a_capture_of_66_face_and_7_head_markers():
    names = marker_names()
    assert len(names) == len(set(names)) == 73
    assert names[66:] == HEAD_MARKERS
    assert {"lip_in0", "lip_in7", "lip_out11", "chin0", "brow0"} <= set(names[:66])


@given(st.lists(st.floats(0, 1), min_size=5, max_size=5))
def test_lips_never_cross_and_a_full_closure_closes_whatever_the_jaw_does(articulators):
    row = np.array([articulators])
    assert lip_aperture_mm(true_markers(row), marker_names()[:66])[0] >= -1e-9
    row[0, DIMENSIONS.index("close")] = 1.0
    assert abs(lip_aperture_mm(true_markers(row), marker_names()[:66])[0]) < 1e-9


def test_articulators_do_what_they_are_called():
    names = marker_names()[:66]
    rest = posture()
    assert lip_aperture_mm(posture(jaw=1.0), names)[0] > 8.0
    assert lip_width_mm(posture(round=1.0), names)[0] < lip_width_mm(rest, names)[0] - 3.0
    assert lip_width_mm(posture(spread=1.0), names)[0] > lip_width_mm(rest, names)[0] + 2.0
    lower = names.index("lip_in6")
    assert not np.allclose(posture(bite=1.0)[0, lower], rest[0, lower], atol=0.5)


def test_nothing_asked_for_changes_nothing(face):
    seen = disturb(face, RATE_HZ, np.random.default_rng(0), STILL)
    assert seen.shape == (720, 73, 3)
    np.testing.assert_allclose(seen[:, :66], face, atol=1e-12)
    assert np.ptp(seen[:, 66:], axis=0).max() < 1e-12


@pytest.mark.parametrize("sd_mm", [0.05, 0.3])
def test_sensor_noise_is_white_and_as_loud_as_asked(face, sd_mm):
    noise = disturb(face, RATE_HZ, np.random.default_rng(1), only(sensor_mm=sd_mm))[:, :66] - face
    assert noise.std() == pytest.approx(sd_mm, rel=0.02)
    power = (np.abs(np.fft.rfft(noise, axis=0)) ** 2).mean(axis=(1, 2))
    half = len(power) // 2
    assert power[1:half].mean() == pytest.approx(power[half:].mean(), rel=0.05)


@pytest.mark.parametrize("sd_mm", [0.12, 0.3])
def test_skin_motion_is_private_band_limited_and_as_large_as_asked(face, sd_mm):
    seen = disturb(face, RATE_HZ, np.random.default_rng(2), only(skin_mm=sd_mm))
    skin = seen[:, :66] - face
    assert skin.std() == pytest.approx(sd_mm, rel=0.02)
    assert np.ptp(seen[:, 66:], axis=0).max() < 1e-12, "the jig has no skin"
    power = (np.abs(np.fft.rfft(skin, axis=0)) ** 2).mean(axis=(1, 2))
    hz = np.fft.rfftfreq(len(skin), 1 / RATE_HZ)
    inside = (hz >= 1.0) & (hz <= 8.0)
    assert power[inside].sum() > 0.999 * power.sum()
    between = np.corrcoef(skin[..., 1].T)
    assert np.abs(between[np.triu_indices(66, 1)]).mean() < 0.2


def test_the_jig_moves_rigidly_and_no_farther_than_asked(face):
    how = only(rotation_deg=4.0, translation_mm=15.0)
    seen = disturb(face, RATE_HZ, np.random.default_rng(3), how)
    jig = seen[:, 66:]
    distances = np.linalg.norm(jig[:, :, None] - jig[:, None], axis=3)
    np.testing.assert_allclose(distances, np.broadcast_to(distances[0], distances.shape), atol=1e-9)
    sway = jig.mean(axis=1)
    assert 2.0 < np.abs(sway - sway.mean(axis=0)).max() < 3 * 15.0
    speed = np.abs(np.fft.rfft(sway - sway.mean(axis=0), axis=0)) ** 2
    hz = np.fft.rfftfreq(len(sway), 1 / RATE_HZ)
    assert speed[hz <= 1.5].sum() > 0.95 * speed.sum(), "slow: below 1.5 Hz"


def test_gaps_are_short_and_only_in_face_markers(face):
    seen = disturb(face, RATE_HZ, np.random.default_rng(4), only(n_gaps=9))
    missing = np.isnan(seen)
    assert (missing.any(axis=2) == missing.all(axis=2)).all()
    assert not missing[:, 66:].any()
    lengths = missing[..., 0].sum(axis=0)
    assert lengths[lengths > 0].min() >= 3
    assert 9 * 3 <= lengths.sum() <= 9 * 12


def test_the_same_generator_gives_the_same_capture(face):
    one, two = (disturb(face, RATE_HZ, np.random.default_rng(5)) for _ in range(2))
    np.testing.assert_array_equal(one, two)
    other = disturb(face, RATE_HZ, np.random.default_rng(6))
    assert np.nanmax(np.abs(one - other)) > 0.1
