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


@pytest.mark.parametrize("rate_hz", [1, 999, 768_001, 2**31 - 1])
def test_a_sampling_rate_that_cannot_be_is_refused(tmp_path, rate_hz):
    soundfile.write(tmp_path / "a.wav", np.zeros(10), rate_hz)
    with pytest.raises(InputError, match=rf"a\.wav.* {rate_hz} samples per second; 1000 to 768000"):
        read_audio(tmp_path / "a.wav")
    soundfile.write(tmp_path / "b.wav", np.zeros(10), {1: 1000}.get(rate_hz, 768_000))
    assert len(read_audio(tmp_path / "b.wav").samples) == 10


@pytest.mark.parametrize("suffix", [".wav", ".flac", ".aiff"])
def test_sound_that_fills_the_memory_is_refused_by_its_header(tmp_path, monkeypatch, suffix):
    path = tmp_path / f"a{suffix}"
    soundfile.write(path, np.zeros((1000, 2)), 16000)
    monkeypatch.setattr("corpus_tools.io.wav.LARGEST_SOUND_BYTES", 8000)
    assert len(read_audio(path).samples) == 1000
    monkeypatch.setattr("corpus_tools.io.wav.LARGEST_SOUND_BYTES", 7999)
    monkeypatch.setattr("soundfile.SoundFile.read", lambda *args, **options: pytest.fail("it was read"))
    with pytest.raises(InputError, match="1000 samples in 2 channels"):
        read_audio(path)


@pytest.mark.parametrize(
    ("form", "subtype", "good"),
    [
        ("WAV", "PCM_16", True),
        ("WAVEX", "PCM_24", True),
        ("RF64", "PCM_16", True),
        ("W64", "PCM_16", True),
        ("NIST", "PCM_16", True),
        ("FLAC", "PCM_16", True),
        ("OGG", "VORBIS", True),
        ("AIFF", "PCM_16", True),
        ("AU", "PCM_16", True),
        ("CAF", "PCM_16", True),
        ("MP3", "MPEG_LAYER_III", False),
    ],
)
def test_what_a_sound_file_is_its_first_bytes_say_and_nothing_is_printed(
    tmp_path, capfd, form, subtype, good
):
    path = tmp_path / "a.wav"
    soundfile.write(path, np.zeros(16000), 16000, format=form, subtype=subtype)
    if not good:
        path.write_bytes(path.read_bytes()[:-300])
    if good:
        assert read_audio(path).rate_hz == 16000
    else:
        with pytest.raises(InputError, match=r"a\.wav' does not begin as"):
            read_audio(path)
        inside = b"RIFF\xff\x0f\0\0WAVEfmt \x10\0\0\0\x55\0\1\0" + path.read_bytes()
        (tmp_path / "inside.wav").write_bytes(inside)
        with pytest.raises(InputError, match=r"inside\.wav' does not begin as"):
            read_audio(tmp_path / "inside.wav")
    assert capfd.readouterr() == ("", "")
