"""Sound: mixed to mono, written as 16-bit PCM without losing a bit of 16-bit sound."""

from __future__ import annotations

import numpy as np
import pytest
import soundfile
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from corpus_tools.core import Audio, InputError
from corpus_tools.io import read_audio, write_wav


@given(pcm=arrays(np.int16, st.integers(1, 50)), rate_hz=st.sampled_from([8000, 16000, 44100]))
@example(pcm=np.array([-32768, -32767, -1, 0, 1, 32767], np.int16), rate_hz=16000)
def test_sixteen_bit_sound_passes_through_unchanged(tmp_path_factory, pcm, rate_hz):
    folder = tmp_path_factory.mktemp("wav")
    soundfile.write(folder / "a.wav", pcm, rate_hz, subtype="PCM_16")
    audio = read_audio(folder / "a.wav")
    write_wav(folder / "b.wav", audio)
    back, rate = soundfile.read(folder / "b.wav", dtype="int16")
    np.testing.assert_array_equal(back, pcm)
    assert (rate, audio.rate_hz, audio.samples.dtype) == (rate_hz, rate_hz, np.float32)
    assert soundfile.info(folder / "b.wav").subtype == "PCM_16"
    write_wav(folder / "c.wav", audio)
    assert (folder / "b.wav").read_bytes() == (folder / "c.wav").read_bytes()


@given(samples=arrays(np.float32, st.integers(1, 50), elements=st.floats(-1, 0.875, width=32)))
def test_other_sound_is_rounded_by_half_a_step_at_most(tmp_path_factory, samples):
    path = tmp_path_factory.mktemp("wav") / "a.wav"
    write_wav(path, Audio(samples, 16000))
    assert np.abs(read_audio(path).samples - samples).max() <= 0.5 / 32768 + 1e-9


def test_too_loud_is_clipped_and_never_wraps(tmp_path):
    write_wav(tmp_path / "a.wav", Audio(np.array([1.0, 3.0, -3.0]), 16000))
    np.testing.assert_array_equal(
        soundfile.read(tmp_path / "a.wav", dtype="int16")[0], [32767, 32767, -32768]
    )


def test_channels_are_mixed(tmp_path):
    soundfile.write(tmp_path / "a.wav", np.array([[0.5, 0.0], [0.25, -0.25]]), 16000)
    np.testing.assert_allclose(read_audio(tmp_path / "a.wav").samples, [0.25, 0.0], atol=1e-6)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_samples_that_are_not_numbers_are_refused(tmp_path, value):
    soundfile.write(tmp_path / "a.wav", np.array([0.0, value]), 16000, subtype="FLOAT")
    with pytest.raises(InputError, match=r"a\.wav.*not numbers"):
        read_audio(tmp_path / "a.wav")
    with pytest.raises(InputError, match=r"b\.wav.*not numbers"):
        write_wav(tmp_path / "b.wav", Audio(np.array([0.0, value]), 16000))
    assert [p.name for p in tmp_path.iterdir()] == ["a.wav"]


def test_a_sound_without_samples_is_refused(tmp_path):
    soundfile.write(tmp_path / "a.wav", np.zeros(0), 16000)
    with pytest.raises(InputError, match=r"a\.wav.*no samples"):
        read_audio(tmp_path / "a.wav")
