"""The natural range of a signal: it holds what was recorded, on the clock of the target."""

import numpy as np
import pytest

from corpus_tools.fragments import natural_band
from corpus_tools.fragments.band import LEAST, POINTS


@pytest.fixture(scope="module")
def inventory(opened_corpus):
    return opened_corpus.inventory


def heights(inventory, of=lambda recording: np.asarray(recording.capture.positions_mm)[:, 0, 1]):
    return [of(r) for r in inventory.recordings]


def test_a_constant_signal_has_a_range_of_no_width(inventory):
    phones = inventory.recordings[0].utterance.phones
    ones = heights(inventory, lambda r: np.full(r.capture.n_frames, 3.0))
    times, low, high = natural_band(inventory, phones, ones)
    known = np.isfinite(low)
    assert known.any()
    assert np.allclose(low[known], 3.0)
    assert np.allclose(high[known], 3.0)
    assert (np.diff(times) >= 0).all()
    assert times[0] == phones.intervals[0].centre_s
    assert times[-1] == phones.intervals[-1].centre_s
    assert len(times) == (len(phones) - 1) * (POINTS + 1)


def test_the_whole_range_holds_every_recording(inventory):
    recording = inventory.recordings[2]
    signals = heights(inventory)
    times, low, high = natural_band(inventory, recording.utterance.phones, signals, percentiles=(0.0, 100.0))
    own = np.interp(times, recording.capture.times_s, signals[2])
    known = np.isfinite(low)
    assert (low[known] <= own[known] + 1e-9).all()
    assert (own[known] <= high[known] + 1e-9).all()


def test_too_few_instances_give_no_range(inventory):
    phones = inventory.recordings[0].utterance.phones
    others = [r.name for r in inventory.recordings[LEAST - 1 :]]
    _, low, _ = natural_band(inventory, phones, heights(inventory), exclude=others)
    assert np.isnan(low).any()
    everything = [r.name for r in inventory.recordings]
    assert np.isnan(natural_band(inventory, phones, heights(inventory), exclude=everything)[1]).all()
