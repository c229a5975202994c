"""Sound files: read by soundfile, mixed to mono; written as 16-bit PCM WAV."""

from __future__ import annotations

import wave
from pathlib import Path

import numpy as np
import soundfile

from corpus_tools.core import Audio, InputError, atomic_file
from corpus_tools.io.formats import AUDIO_READERS

__all__ = ["read_sound", "write_wav"]


@AUDIO_READERS.register(".wav")
@AUDIO_READERS.register(".flac")
@AUDIO_READERS.register(".aiff")
def read_sound(path: Path) -> Audio:
    """Read a sound file and mix its channels to mono.

    Raises
    ------
    InputError
        It is no sound file, or holds no samples.
    """
    try:
        samples, rate = soundfile.read(path, dtype="float32", always_2d=True)
    except (soundfile.SoundFileError, RuntimeError, OSError) as error:
        reason = str(error).splitlines()[0]
        raise InputError(f"'{path}' cannot be read as sound ({reason}); a WAV file was expected.") from None
    if not len(samples):
        raise InputError(f"The sound file '{path}' holds no samples.")
    if not np.isfinite(samples).all():
        raise InputError(f"The sound file '{path}' holds samples that are not numbers; export it again.")
    return Audio(samples.mean(axis=1), int(rate))


def write_wav(path: str | Path, audio: Audio) -> None:
    """Write mono 16-bit PCM.

    Equal audio gives equal bytes, and 16-bit sound that was read comes out as it was. Samples
    outside [-1, 1 - 2**-15] are clipped.

    Parameters
    ----------
    path : path
    audio : Audio

    Raises
    ------
    InputError
        A sample is not a number.
    OutputError
        The file cannot be written.
    """
    if not np.isfinite(audio.samples).all():
        raise InputError(f"Cannot write '{path}': the sound holds samples that are not numbers.")
    pcm = np.clip(np.rint(audio.samples.astype(np.float64) * 32768.0), -32768, 32767).astype("<i2")
    with atomic_file(path) as temporary, wave.open(str(temporary), "wb") as stream:
        stream.setnchannels(1)
        stream.setsampwidth(2)
        stream.setframerate(audio.rate_hz)
        stream.writeframes(pcm.tobytes())
