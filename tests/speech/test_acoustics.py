import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import Audio
from corpus_tools.speech.acoustics import N_CEPSTRA, SOUND_FEATURES, sound_features

RATE = 16000
TIMES = np.arange(RATE) / RATE


def voice(hz, formants=(700.0, 1200.0)):
    """Return a simulated vowel: harmonics of a pitch under a spectrum with peaks."""
    total = np.zeros(RATE)
    for k in range(1, int(4000 / hz)):
        weight = sum(1.0 / (1.0 + ((k * hz - f) / 120.0) ** 2) for f in formants) + 0.01
        total += weight * np.sin(2 * np.pi * k * hz * TIMES)
    hiss = np.random.default_rng(0).normal(0, 1e-3, RATE)
    return 0.5 * total / np.abs(total).max() + hiss


def at(samples, seconds=0.5):
    return sound_features(Audio(np.asarray(samples, np.float32), RATE), [seconds])[0]


@given(st.floats(90, 350))
def test_pitch_is_found_in_octaves(hz):
    *_, voicing, octaves = at(voice(hz))
    assert voicing > 0.8
    assert octaves / voicing == pytest.approx(np.log2(hz / 70.0), abs=0.06)


@given(st.floats(0.05, 1.0))
def test_loudness_changes_the_energy_and_not_the_shape(gain):
    loud, quiet = at(voice(120)), at(gain * voice(120))
    np.testing.assert_allclose(quiet[:N_CEPSTRA], loud[:N_CEPSTRA], atol=0.3)
    assert loud[N_CEPSTRA] - quiet[N_CEPSTRA] == pytest.approx(-2 * np.log(gain), abs=0.1)


def test_another_vowel_is_farther_than_another_pitch():
    a, a_higher, i = at(voice(110)), at(voice(125)), at(voice(110, (300.0, 2300.0)))
    assert np.linalg.norm((i - a)[:N_CEPSTRA]) > 3 * np.linalg.norm((a_higher - a)[:N_CEPSTRA])


def test_noise_has_no_voice_and_silence_is_finite():
    noise = np.random.default_rng(0).normal(0, 0.1, RATE)
    assert at(noise)[-2] < 0.5
    silent = sound_features(Audio(np.zeros(RATE, np.float32), RATE), [-1.0, 0.0, 0.5, 1.0, 9.0])
    assert silent.shape == (5, SOUND_FEATURES)
    assert np.isfinite(silent).all()
    assert sound_features(Audio(np.zeros(0, np.float32), RATE), [0.1]).shape == (1, SOUND_FEATURES)
