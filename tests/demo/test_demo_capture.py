"""The simulated capture: every disturbance is there, as large as asked for, where the record of it says."""

import dataclasses

import numpy as np
import pytest

from corpus_tools.demo import (
    DIMENSIONS,
    UNDISTURBED,
    Disturbances,
    articulate,
    disturb,
    marker_names,
    time_phones,
    true_markers,
)
from corpus_tools.demo.cover import all_sentences

RATE_HZ = 120.0


def only(**changes):
    return dataclasses.replace(UNDISTURBED, **changes)


@pytest.fixture(scope="module")
def face():
    """Six seconds of a face at rest, (720, 66, 3) mm."""
    return true_markers(np.zeros((720, len(DIMENSIONS))))


@pytest.fixture(scope="module")
def talking():
    """A face that says something, mm."""
    phones, _ = time_phones(all_sentences()[3], np.random.default_rng(0))
    return true_markers(articulate(phones, RATE_HZ, np.random.default_rng(0)))


def see(face, seed, **changes):
    return disturb(face, RATE_HZ, np.random.default_rng(seed), only(**changes))


def share_between(motion, low_hz, high_hz):
    """Return the share of the power of (n_frames, ...) motion that lies in a band."""
    power = np.abs(np.fft.rfft(motion - motion.mean(axis=0), axis=0)) ** 2
    hz = np.fft.rfftfreq(len(motion), 1 / RATE_HZ)
    return power[(hz >= low_hz) & (hz <= high_hz)].sum() / power.sum()


def test_nothing_asked_for_changes_nothing(talking):
    seen = see(talking, 0)
    np.testing.assert_allclose(seen.positions_mm[:, :66], talking, atol=1e-9)
    assert np.ptp(seen.positions_mm[:, 66:], axis=0).max() < 1e-9
    assert not (seen.spiked | seen.swapped | seen.occluded).any()
    assert np.isnan(seen.slip_s)


def test_the_record_explains_all_but_noise_spikes_swaps_and_gaps(talking):
    how = dataclasses.replace(Disturbances(), slip_chance=1.0, swap_chance=1.0)
    seen = disturb(talking, RATE_HZ, np.random.default_rng(1), how)
    still = np.concatenate([talking + seen.skin_mm, seen.jig_mm], axis=1)
    made = np.einsum("fij,fmj->fmi", seen.rotation, still) + seen.translation_mm[:, None]
    left = np.linalg.norm(seen.positions_mm - made, axis=2)
    assert seen.swapped.any()
    assert np.nanmin(np.where(seen.swapped, left, np.nan)) > 3.0
    assert (np.isnan(left) == seen.occluded).all()
    plain = left[~(seen.spiked | seen.swapped | seen.occluded)]
    assert np.sqrt(np.mean(plain**2) / 3) == pytest.approx(how.sensor_mm, rel=0.02)
    assert plain.max() < 7 * how.sensor_mm


def test_each_disturbance_is_the_same_whether_others_are_there_or_not(talking):
    every = disturb(talking, RATE_HZ, np.random.default_rng(2))
    alone = disturb(talking, RATE_HZ, np.random.default_rng(2), only(skin_mm=(0.15, 0.3), n_gaps=2.0))
    np.testing.assert_array_equal(alone.skin_mm, every.skin_mm)
    assert (alone.occluded <= every.occluded).all()


@pytest.mark.parametrize("sd_mm", [0.05, 0.3])
def test_sensor_noise_is_white_and_as_loud_as_asked(face, sd_mm):
    noise = see(face, 1, sensor_mm=sd_mm).positions_mm[:, :66] - face
    assert noise.std() == pytest.approx(sd_mm, rel=0.02)
    assert share_between(noise, 0, 30) == pytest.approx(0.5, abs=0.03)


def test_skin_motion_is_private_to_each_marker_0_15_to_0_3_mm_and_1_to_8_hz(face):
    assert Disturbances().skin_mm == (0.15, 0.3)
    seen = see(face, 2, skin_mm=(0.15, 0.3))
    moved = seen.positions_mm[:, :66] - face
    np.testing.assert_allclose(moved, seen.skin_mm, atol=1e-9)
    size_mm = np.sqrt((moved**2).sum(axis=2).mean(axis=0))
    assert 0.15 <= size_mm.min() < 0.17
    assert 0.28 < size_mm.max() <= 0.3
    again = see(face, 3, skin_mm=(0.15, 0.3)).skin_mm
    np.testing.assert_allclose(np.sqrt((again**2).sum(axis=2).mean(axis=0)), size_mm)
    assert np.ptp(seen.jig_mm, axis=0).max() < 1e-12, "the jig has no skin"
    assert share_between(moved, 1, 8) > 0.999
    between = np.corrcoef(moved[..., 1].T)
    assert np.abs(between[np.triu_indices(66, 1)]).mean() < 0.2


def test_the_head_moves_rigidly_slowly_and_no_farther_than_asked(face):
    seen = see(face, 3, rotation_deg=4.0, translation_mm=15.0)
    jig = seen.positions_mm[:, 66:]
    distances = np.linalg.norm(jig[:, :, None] - jig[:, None], axis=3)
    np.testing.assert_allclose(distances, np.broadcast_to(distances[0], distances.shape), atol=1e-9)
    sway = jig.mean(axis=1)
    assert 2.0 < np.abs(sway - sway.mean(axis=0)).max() < 3 * 15.0
    assert share_between(sway, 0, 1.5) > 0.95


def test_a_slipping_jig_moves_1_5_mm_against_the_skull_and_stays_there(face):
    assert Disturbances().slip_mm == 1.5
    assert 0.0 < Disturbances().slip_chance < 0.5
    seen = see(face, 4, slip_chance=1.0, slip_mm=1.5)
    np.testing.assert_allclose(seen.positions_mm[:, :66], face, atol=1e-9)
    moved = np.linalg.norm(seen.positions_mm[:, 66:] - seen.positions_mm[0, 66:], axis=2)
    times = np.arange(len(face)) / RATE_HZ
    assert moved[times <= seen.slip_s].max() == 0.0
    assert 0.25 * times[-1] < seen.slip_s < 0.75 * times[-1]
    after = moved[times > seen.slip_s + 0.1]
    assert after.mean() == pytest.approx(1.5, abs=0.1)
    assert np.ptp(after, axis=0).max() == 0.0


def test_spikes_are_rare_short_and_where_the_record_says(face):
    seen = see(face, 5, spike_share=5e-3, spike_mm=(2.0, 8.0))
    away = np.linalg.norm(seen.positions_mm[:, :66] - face, axis=2)
    assert ((away > 1e-6) == seen.spiked[:, :66]).all()
    assert seen.spiked.mean() == pytest.approx(5e-3, rel=0.2)
    sizes = away[away > 1e-6]
    assert 2.0 <= sizes.min() < 3.0 < 7.0 < sizes.max() <= 8.0
    runs = np.diff(np.flatnonzero(np.diff(np.r_[0, seen.spiked.T.ravel(), 0])))[::2]
    assert {1, 2} <= set(runs)
    assert np.mean(runs <= 2) > 0.98


def test_a_swap_exchanges_two_neighbours_of_one_region_for_a_while(talking):
    regions = set()
    for seed in range(12):
        seen = see(talking, seed, swap_chance=1.0)
        one, other = np.flatnonzero(seen.swapped.any(axis=0))
        frames = np.flatnonzero(seen.swapped.any(axis=1))
        assert 4 <= len(frames) == np.ptp(frames) + 1 <= 16
        kinds = {marker_names()[i].rstrip("0123456789") for i in (one, other)}
        assert len(kinds) == 1
        regions |= kinds
        undone = np.array(seen.positions_mm[:, :66])
        undone[frames[:, None], [one, other]] = undone[frames[:, None], [other, one]]
        np.testing.assert_allclose(undone, talking, atol=1e-9)
    assert len(regions) >= 4


def test_occlusions_are_short_and_long_single_and_together_and_sometimes_of_the_jig():
    face = true_markers(np.zeros((400, len(DIMENSIONS))))
    lengths, together, jig = [], [], 0
    for seed in range(60):
        seen = disturb(face, RATE_HZ, np.random.default_rng(seed))
        missing = np.isnan(seen.positions_mm)
        assert (missing.any(axis=2) == missing.all(axis=2)).all()
        assert (missing.any(axis=2) == seen.occluded).all()
        lengths += [int(n) for n in seen.occluded.sum(axis=0) if n]
        together.append(int(seen.occluded[:, :66].sum(axis=1).max()))
        jig += bool(seen.occluded[:, 66:].any())
    assert min(lengths) >= 3
    assert np.mean(np.array(lengths) <= 12) > 0.5
    assert max(lengths) >= 48
    assert 1 in together
    assert max(together) >= 4
    assert 0 < jig < 20
    assert 0 in together, "some recordings have no gap"


def test_the_same_generator_gives_the_same_capture(talking):
    one, two = (disturb(talking, RATE_HZ, np.random.default_rng(5)) for _ in range(2))
    np.testing.assert_array_equal(one.positions_mm, two.positions_mm)
    other = disturb(talking, RATE_HZ, np.random.default_rng(6))
    assert np.nanmax(np.abs(one.positions_mm - other.positions_mm)) > 0.1
