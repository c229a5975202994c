"""Joins of held-out sentences of GRID speaker s1: what the length of the overlap does to real fragments."""

import itertools

import numpy as np
import pytest

from corpus_tools.config import Config, config_with
from corpus_tools.io import init_corpus
from corpus_tools.pipeline import align_units, blend_units, open_corpus, select_units
from corpus_tools.synthesis import blend_pieces, fit_uniform_rbf, rms_acceleration

SENTENCES = slice(None, None, 8)


@pytest.fixture(scope="module")
def grid(corpora, tmp_path_factory):
    source, folder = corpora / "grid_s1", tmp_path_factory.mktemp("blend") / "work"
    init_corpus(
        folder,
        motion=str(source / "markers73" / "{id}.npz"),
        audio=str(source / "wav" / "{id}.wav"),
        labels=str(source / "textgrid" / "{id}.TextGrid"),
        settings={
            "frame_time": "centre",
            "head_scale": "true",
            "phones": "arpabet",
            "reference_markers": "head*",
        },
    )
    return open_corpus(folder)


@pytest.fixture(scope="module")
def aligned(grid):
    """Return the aligned pieces of held-out sentences, longest fragments first."""
    config = config_with(Config(), selection__method="greedy")
    made = []
    for name in grid.names[SENTENCES]:
        target = grid.utterance(name)
        selection = select_units(grid, target, config, exclude=(name,))
        made.append(align_units(grid, target, selection, config))
    return made


@pytest.fixture(scope="module")
def best(grid):
    """Return the aligned pieces of every sentence, held out, chosen by Viterbi."""
    made = []
    for name in grid.names:
        target = grid.utterance(name)
        selection = select_units(grid, target, Config(), exclude=(name,))
        made.append(align_units(grid, target, selection, Config()))
    return made


def join_peaks(grid, aligned, **blend):
    """Return the peak acceleration of every join, as a ratio to the natural 95th percentile."""
    found = []
    for pieces in aligned:
        trajectory = blend_pieces(pieces, **blend)
        lips_and_chin = np.asarray(trajectory.values_mm)[:, grid.natural.columns]
        acceleration = rms_acceleration(lips_and_chin, trajectory.rate_hz)
        for join in trajectory.joins:
            found.append(acceleration[np.abs(trajectory.times_s - join.time_s) <= 0.06].max())
    assert len(found) > 30
    return np.array(found) / grid.natural.frames_p95_mm_s2


def peaks(grid, aligned, **blend):
    """Return the mean of :func:`join_peaks`."""
    return join_peaks(grid, aligned, **blend).mean()


def test_longer_overlaps_calm_the_joins_until_the_phone_is_full(grid, aligned):
    """14.6, 9.0, 3.9, 2.4 and 2.4 were measured on another split of the same speaker."""
    seen = [peaks(grid, aligned, weighting="smoothstep", overlap_s=s) for s in (0, 0.017, 0.033, 0.08, 0.12)]
    assert all(short > long for short, long in itertools.pairwise(seen))
    assert 11 < seen[0] < 20
    assert 3 < seen[2] < 6
    assert 1.8 < seen[4] < 3.3
    assert seen[3] < 1.15 * seen[4]


def test_the_printed_rule_gives_overlaps_far_too_short_to_hide_a_join(grid, aligned):
    lengths = [j.overlap_s for pieces in aligned for j in blend_pieces(pieces, rule="paper").joins]
    assert np.median(lengths) == pytest.approx(0.015, abs=0.001)
    assert peaks(grid, aligned, rule="paper") > 3 * peaks(grid, aligned)


def test_joins_are_ranked_among_natural_speech(grid, aligned):
    natural = grid.natural
    assert 1800 < natural.frames_p95_mm_s2 < 3200  # 2350 mm/s2 was measured with another smoother
    blended = [blend_pieces(pieces, natural=natural) for pieces in aligned]
    cut = [blend_pieces(pieces, natural=natural, overlap_s=0.0) for pieces in aligned]
    ranks = [[j.natural_percentile for t in made for j in t.joins] for made in (blended, cut)]
    assert min(ranks[1]) > 95
    assert np.mean(ranks[0]) < np.mean(ranks[1])
    gaps = [j.gap_mm for t in blended for j in t.joins]
    assert 1 < np.mean(gaps) < 5


def test_inertial_joins_are_about_as_smooth_as_speech(grid, best):
    """1.16 of the natural p95 with Viterbi, .46 to .64 of the cross-fade, were measured on other splits.

    All sentences: where a phone of 140 ms speaks one of 30 ms, the acceleration (20 times the p95) is that of
    the hurried fragment, which no join can mend, and one such sentence decides the mean of a small sample.
    """
    ratios = {mode: join_peaks(grid, best, mode=mode) for mode in ("crossfade", "inertial")}
    assert np.mean(ratios["inertial"]) <= 1.25
    assert np.mean(ratios["inertial"]) <= 0.65 * np.mean(ratios["crossfade"])
    assert (ratios["inertial"] > 1).mean() <= 0.6 * (ratios["crossfade"] > 1).mean()


def test_inertial_joins_stay_near_the_recording_and_lips_close_after_them(grid, best):
    config = config_with(Config(), blend__mode="inertial")
    largest = []
    for pieces in best:
        trajectory = blend_units(grid, pieces.utterance, pieces, config)
        settings = {s.name: s.as_dict() for s in trajectory.history}
        largest.append(settings["blend"]["deviation_mm"])
        aperture = np.einsum("fmk,mk->f", trajectory.values_mm, grid.lips.functional)
        for phone in pieces.utterance.phones:
            if phone.text in grid.phones.bilabials:
                inside = (trajectory.times_s >= phone.start_s) & (trajectory.times_s <= phone.end_s)
                assert aperture[inside].min() <= grid.lips.target_mm + 0.05
    assert 0.3 < np.median(largest) < 2


def test_closing_the_lips_costs_no_accuracy(grid, best):
    """Success as natural or .98, at most .5 % more error; 1.00 and less error were measured."""
    found = {False: [], True: []}
    for pieces in best[::2]:
        capture = grid.recorded(pieces.utterance.name)
        phones = pieces.utterance.phones.intervals
        speech = (pieces.times_s > phones[0].end_s) & (pieces.times_s < phones[-1].start_s)
        curve = fit_uniform_rbf(capture.start_s, capture.rate_hz, capture.positions_mm)
        truth = curve(pieces.times_s[speech])[:, grid.natural.columns]
        for project, errors in found.items():
            config = config_with(Config(), blend__mode="inertial", closure__project=project)
            values = np.asarray(blend_units(grid, pieces.utterance, pieces, config).values_mm)
            errors.append(((values[speech][:, grid.natural.columns] - truth) ** 2).sum(axis=2).ravel())
    rmse = {project: np.sqrt(np.concatenate(errors).mean()) for project, errors in found.items()}
    assert rmse[True] <= 1.005 * rmse[False]


def test_nothing_doubtful_is_hidden_and_little_is_doubtful(aligned):
    doubtful = [(np.asarray(blend_pieces(p).flags) & 4 > 0).mean() for p in aligned]
    assert np.mean(doubtful) < 0.02
    assert max(piece.cond for p in aligned for piece in p.pieces) < 1e9


def test_a_recording_speaks_itself_as_it_was(grid):
    for name in grid.names[::40]:
        recording = grid.recording(name)
        target = recording.utterance
        selection = select_units(grid, target, Config())
        trajectory = blend_pieces(align_units(grid, target, selection, Config()))
        assert trajectory.joins == ()
        capture = recording.capture
        curve = fit_uniform_rbf(capture.start_s, capture.rate_hz, capture.positions_mm)
        phones = target.phones.intervals
        speech = (trajectory.times_s > phones[0].end_s) & (trajectory.times_s < phones[-1].start_s)
        difference = trajectory.values_mm[speech] - curve(trajectory.times_s[speech])
        assert np.sqrt((difference**2).mean()) < 0.02


def test_lips_close_in_every_bilabial_and_are_never_pressed_through_each_other(grid, aligned):
    functional, closed = grid.lips.functional, 0
    for pieces in aligned:
        plain = blend_pieces(pieces)
        trajectory = blend_units(grid, pieces.utterance, pieces, config_with(Config(), rest__ease_s=0.0))
        before, after = (np.einsum("fmk,mk->f", t.values_mm, functional) for t in (plain, trajectory))
        for phone in pieces.utterance.phones:
            if phone.text in grid.phones.bilabials:
                inside = (trajectory.times_s >= phone.start_s) & (trajectory.times_s <= phone.end_s)
                assert after[inside].min() <= grid.lips.target_mm + 0.05
                closed += 1
        moved = after != before
        assert (after <= before + 1e-9).all()
        assert (after[moved] >= np.minimum(before[moved], grid.lips.target_mm - 0.5) - 1e-9).all()
    assert closed > 20
