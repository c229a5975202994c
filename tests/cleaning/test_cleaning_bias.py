"""Laws of the constant posture of recordings: what is added is found, and nothing is made up."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.cleaning import PhoneHalves, holding, phone_halves, recording_bias

N_MARKERS = 4
CELLS = [(p, n, h) for p in "abcde" for n in "xy" for h in ("first", "second")]
SEEDS = st.integers(0, 2**31)


def corpus(seed, n=8, length=40, noise_mm=0.0):
    """Return recordings without bias, (halves, generator): poses by cell, and independent noise."""
    random = np.random.default_rng(seed)
    poses = random.normal(0, 5, (len(CELLS), N_MARKERS, 3))
    found = []
    for _ in range(n):
        said = random.integers(0, len(CELLS), length)
        means = poses[said] + random.normal(0, noise_mm, (length, N_MARKERS, 3)) if noise_mm else poses[said]
        frames = random.integers(1, 5, (length, 1)) * np.ones(N_MARKERS)
        found.append(PhoneHalves(tuple(CELLS[i] for i in said), means, frames))
    return found, random


def moved(halves, offsets):
    return [PhoneHalves(h.cells, h.means_mm + o, h.n_frames) for h, o in zip(halves, offsets, strict=True)]


def centred(offsets):
    return offsets - offsets.mean(axis=0)


@given(SEEDS)
def test_added_offsets_are_found_up_to_their_mean(seed):
    halves, random = corpus(seed)
    offsets = random.normal(0, 1, (8, N_MARKERS, 3))
    found = recording_bias(moved(halves, offsets))
    np.testing.assert_allclose(found.offsets_mm, centred(offsets), atol=1e-6)
    assert (found.trust > 0.999).all()


@given(SEEDS)
def test_added_offsets_are_found_to_the_noise(seed):
    halves, random = corpus(seed, n=12, length=80, noise_mm=0.5)
    offsets = random.normal(0, 1, (12, N_MARKERS, 3))
    error = recording_bias(moved(halves, offsets)).offsets_mm - centred(offsets)
    assert np.sqrt((error**2).mean()) < 0.15  # 0.5 / sqrt(80) = 0.06, unequal weights, cells and shrinkage


@given(SEEDS)
def test_what_is_not_there_is_not_found(seed):
    halves, _ = corpus(seed, n=12, length=80, noise_mm=0.5)
    plain = recording_bias(halves)
    assert np.sqrt((plain.offsets_mm**2).mean()) < 0.05
    assert plain.trust.mean() < 0.7


@given(SEEDS, st.floats(-20, 20))
def test_a_shift_of_all_recordings_changes_nothing(seed, shift_mm):
    halves, random = corpus(seed, noise_mm=0.5)
    offsets = random.normal(0, 1, (8, N_MARKERS, 3))
    before = recording_bias(moved(halves, offsets)).offsets_mm
    after = recording_bias(moved(halves, offsets + shift_mm)).offsets_mm
    np.testing.assert_allclose(after, before, atol=1e-6)
    np.testing.assert_allclose(before.sum(axis=0), 0, atol=1e-9)


@given(SEEDS)
def test_turned_recordings_have_turned_offsets(seed):
    halves, random = corpus(seed, noise_mm=0.5)
    halves = moved(halves, random.normal(0, 1, (8, N_MARKERS, 3)))
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    turned = [PhoneHalves(h.cells, h.means_mm @ turn, h.n_frames) for h in halves]
    np.testing.assert_allclose(
        recording_bias(turned).offsets_mm, recording_bias(halves).offsets_mm @ turn, atol=1e-6
    )


@given(SEEDS)
def test_order_does_not_matter(seed):
    halves, random = corpus(seed, noise_mm=0.5)
    halves = moved(halves, random.normal(0, 1, (8, N_MARKERS, 3)))
    order = random.permutation(8)
    np.testing.assert_allclose(
        recording_bias([halves[i] for i in order]).offsets_mm,
        recording_bias(halves).offsets_mm[order],
        atol=1e-8,
    )


@given(SEEDS)
def test_own_frames_do_not_inform_the_own_phone_means(seed):
    """The unshrunk offset is the mean residual to the others' cell means, freed of the others' offsets."""
    halves, random = corpus(seed, noise_mm=0.5)
    halves = moved(halves, random.normal(0, 1, (8, N_MARKERS, 3)))
    found = recording_bias(halves, rounds=0)
    raw = found.offsets_mm + 0.0
    assert (found.trust > 0.5).all()
    # undo centring and shrinkage: raw = trust * b - mean(trust * b), with the b summing to 0
    share = found.trust[:, :1, None]
    mean = -(raw / share).sum(axis=0) / (1 / share).sum(axis=0)
    b = (raw + mean) / share
    for r, own in enumerate(halves):
        total, weights = 0.0, 0.0
        for cell in set(own.cells):
            mine = [i for i, c in enumerate(own.cells) if c == cell]
            n_own = own.n_frames[mine, 0].sum()
            others = [
                (h.n_frames[i, 0], h.means_mm[i] - b[s])
                for s, h in enumerate(halves)
                for i, c in enumerate(h.cells)
                if c == cell and s != r
            ]
            if not others:
                continue
            n_others = sum(n for n, _ in others)
            mean_own = np.average(own.means_mm[mine], axis=0, weights=own.n_frames[mine, 0])
            share_of_others = n_own * n_others / (n_own + n_others)
            total += share_of_others * (mean_own - sum(n * y for n, y in others) / n_others)
            weights += share_of_others
        np.testing.assert_allclose(total / weights, b[r], atol=1e-6)


@given(SEEDS)
def test_one_recording_alone_has_no_offset(seed):
    halves, _ = corpus(seed, n=1, noise_mm=0.5)
    for rounds in (0, 2):
        assert np.abs(recording_bias(halves, rounds).offsets_mm).max() < 1e-9


@given(SEEDS)
def test_recordings_that_share_no_phone_have_no_offsets(seed):
    halves, _ = corpus(seed, n=2, noise_mm=0.5)
    other = tuple((p + "'", n, h) for p, n, h in halves[1].cells)
    apart = [halves[0], PhoneHalves(other, halves[1].means_mm + 3.0, halves[1].n_frames)]
    for rounds in (0, 2):
        assert np.abs(recording_bias(apart, rounds).offsets_mm).max() < 1e-3


def test_an_offset_of_half_a_recording_is_hardly_trusted():
    halves, random = corpus(3, n=12, length=80, noise_mm=0.3)
    offsets = np.zeros((12, 80, N_MARKERS, 3))
    offsets[:, :40] = random.normal(0, 2, (12, 1, N_MARKERS, 3))
    offsets[:, 40:] = random.normal(0, 2, (12, 1, N_MARKERS, 3))
    constant = np.repeat(random.normal(0, 2, (12, 1, N_MARKERS, 3)), 80, axis=1)
    assert recording_bias(moved(halves, offsets)).trust.mean() < 0.5
    assert recording_bias(moved(halves, constant)).trust.mean() > 0.95


def test_a_wrong_label_moves_an_offset_little():
    halves, random = corpus(4, n=12, length=40, noise_mm=0.3)
    offsets = centred(random.normal(0, 2, (12, N_MARKERS, 3)))
    halves = moved(halves, offsets)
    means = np.array(halves[0].means_mm)
    means[5] += 15.0
    spoiled = [PhoneHalves(halves[0].cells, means, halves[0].n_frames), *halves[1:]]
    robust, plain = (
        np.abs(recording_bias(spoiled, rounds=n).offsets_mm[0] - offsets[0]).mean() for n in (2, 0)
    )
    assert plain > 0.3
    assert robust < 0.4 * plain


@given(SEEDS)
def test_markers_that_are_not_seen_do_not_count(seed):
    halves, random = corpus(seed, n=10, length=80)
    offsets = random.normal(0, 1, (10, N_MARKERS, 3))
    hidden = []
    for h in moved(halves, offsets):
        unseen = random.random(h.n_frames.shape) < 0.3
        means = np.where(unseen[..., None], 1e3, h.means_mm)
        hidden.append(PhoneHalves(h.cells, means, np.where(unseen, 0.0, h.n_frames)))
    np.testing.assert_allclose(recording_bias(hidden).offsets_mm, centred(offsets), atol=1e-5)


def test_halves_are_cut_at_the_middle_of_a_phone_and_not_from_silence():
    times = np.arange(20) / 10.0
    positions = np.arange(20.0)[:, None, None] * np.ones((1, 2, 3))
    measured = np.ones((20, 2), dtype=bool)
    measured[5, 1] = False
    positions[5, 1] = np.nan
    phones = [(0.0, 0.45, "sil"), (0.45, 0.85, "p"), (0.85, 1.25, "a"), (1.25, 2.0, "sil")]
    halves = phone_halves(positions, times, measured, phones, "sil")
    assert halves.cells == (
        ("p", "sil", "first"),
        ("p", "a", "second"),
        ("a", "p", "first"),
        ("a", "sil", "second"),
    )
    np.testing.assert_array_equal(halves.n_frames, [[2, 1], [2, 2], [2, 2], [2, 2]])
    np.testing.assert_allclose(halves.means_mm[:, :, 0], [[5.5, 6], [7.5, 7.5], [9.5, 9.5], [11.5, 11.5]])


@given(SEEDS)
def test_what_is_held_stays_and_the_rest_is_the_nearest(seed):
    random = np.random.default_rng(seed)
    offsets, functionals = random.normal(size=(5, N_MARKERS, 3)), random.normal(size=(2, N_MARKERS, 3))
    held = holding(offsets, functionals)
    np.testing.assert_allclose(np.einsum("kmd,rmd->rk", functionals, held), 0, atol=1e-9)
    np.testing.assert_allclose(holding(held, functionals), held, atol=1e-9)
    taken = (offsets - held).reshape(5, -1)
    np.testing.assert_allclose(taken @ held.reshape(5, -1).T, 0, atol=1e-9)
    np.testing.assert_array_equal(holding(offsets, functionals[:0]), offsets)


def test_nothing_said_gives_no_offset():
    halves, _ = corpus(5, n=3)
    silent = phone_halves(
        np.zeros((4, N_MARKERS, 3)), np.arange(4) / 10, np.ones((4, N_MARKERS), bool), [], "s"
    )
    found = recording_bias([*halves, silent])
    assert found.trust[3].max() == 0
    assert found.offsets_mm[3] == pytest.approx(0, abs=1e-6)
