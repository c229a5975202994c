"""Freeing recordings of their posture does the simulated corpus no harm and finds one that is there."""

import dataclasses

import numpy as np
import pytest

from corpus_tools.config import Config, config_with
from corpus_tools.core import InputError
from corpus_tools.fragments.posture import as_recorded, posture_offsets_mm, without_bias
from corpus_tools.pipeline import open_corpus
from corpus_tools.speech import lip_aperture_mm


@pytest.fixture(scope="module")
def kept(small_corpus):
    """Return the small corpus with its postures left in."""
    return open_corpus(small_corpus, config_with(Config(), cleaning__remove_bias=False))


@pytest.fixture(scope="module")
def freed(small_corpus):
    return open_corpus(small_corpus)


def test_switched_off_nothing_is_taken_out(kept):
    assert kept.offsets_mm == {}
    assert kept.bias_mm == {}
    assert not any(s.name == "remove_bias" for r in kept.recordings for s in r.capture.history)
    for recording in kept.recordings:
        assert kept.recorded(recording.name) is recording.capture


def test_what_was_taken_out_is_told_and_can_be_put_back(kept, freed):
    assert set(freed.offsets_mm) == set(freed.bias_mm) == set(freed.names)
    for before, after in zip(kept.recordings, freed.recordings, strict=True):
        assert after.capture.history[-1].name == "remove_bias"
        told = dict(after.capture.history[-1].settings)["offset_rms_mm"]
        assert told == pytest.approx(freed.bias_mm[after.name], abs=1e-4)
        moved = before.capture.positions_mm - after.capture.positions_mm
        np.testing.assert_allclose(
            moved, np.broadcast_to(freed.offsets_mm[after.name], moved.shape), atol=1e-9
        )
        np.testing.assert_array_equal(after.capture.flags, before.capture.flags)
        again = freed.recorded(after.name)
        np.testing.assert_allclose(again.positions_mm, before.capture.positions_mm, atol=1e-9)
        assert again.history == before.capture.history
    np.testing.assert_allclose(sum(freed.offsets_mm.values()), 0, atol=1e-9)
    with pytest.raises(InputError, match="time99"):
        freed.recorded("time99")


def test_lips_are_as_far_apart_as_before(kept, freed):
    for before, after in zip(kept.recordings, freed.recordings, strict=True):
        np.testing.assert_allclose(
            *(lip_aperture_mm(r.capture.positions_mm, r.capture.names) for r in (before, after)), atol=1e-9
        )


def test_a_posture_that_was_added_is_found_and_little_else(kept):
    """Four short sentences: what is there by itself is below 0.3 mm, an added 2 mm are found to a fifth."""
    silence = kept.phones.silence
    own = posture_offsets_mm([(r.capture, r.utterance) for r in kept.recordings], silence)
    assert max(np.sqrt((o**2).sum(axis=1).mean()) for o in own.values()) < 0.3
    added = np.zeros((len(kept.markers), 3))
    added[:, 2] = 2.0
    first, *others = kept.recordings
    leaning = dataclasses.replace(first, capture=as_recorded(first.capture, added))
    _, offsets = without_bias([leaning, *others], silence)
    found = offsets[first.name] - np.mean([offsets[r.name] for r in others], axis=0)
    assert np.sqrt(((found - added) ** 2).sum(axis=1).mean()) < 0.4
