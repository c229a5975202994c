"""Sound files: read by soundfile, mixed to mono; written as 16-bit PCM WAV."""

from __future__ import annotations

import re
import wave
from pathlib import Path

import numpy as np
import soundfile

from corpus_tools.core import Audio, InputError, atomic_file
from corpus_tools.io.formats import AUDIO_READERS, LARGEST_SOUND_BYTES

__all__ = ["read_sound", "write_wav"]

_BEGINNINGS = (b"RIFF", b"RIFX", b"RF64", b"riff", b"fLaC", b"FORM", b"OggS", b"NIST_1A", b".snd", b"caff")
_MP3_IN_WAV = re.compile(rb"fmt .{4}\x55\x00", re.DOTALL)
_HEAD_BYTES = 4096


@AUDIO_READERS.register(".wav")
@AUDIO_READERS.register(".flac")
@AUDIO_READERS.register(".aiff")
def read_sound(path: Path) -> Audio:
    """Read a sound file and mix its channels to mono.

    Raises
    ------
    InputError
        It is no sound file, holds no samples, or more than fit into memory; that is seen from its header.
    """
    try:
        with path.open("rb") as start:
            _refuse_mp3(path, start.read(_HEAD_BYTES))
        with soundfile.SoundFile(path) as sound:
            _check_size(path, sound)
            samples, rate = sound.read(dtype="float32", always_2d=True), sound.samplerate
    except (soundfile.SoundFileError, RuntimeError, OSError) as error:
        reason = str(error).splitlines()[0]
        raise InputError(f"'{path}' cannot be read as sound ({reason}); a WAV file was expected.") from None
    if not len(samples):
        raise InputError(f"The sound file '{path}' holds no samples.")
    if not np.isfinite(samples).all():
        raise InputError(f"The sound file '{path}' holds samples that are not numbers; export it again.")
    return Audio(samples.mean(axis=1), int(rate))


def _refuse_mp3(path: Path, head: bytes) -> None:
    """Refuse what begins as no sound file, and MP3 in a WAV file: its decoder writes to the terminal."""
    if not head.startswith(_BEGINNINGS) or _MP3_IN_WAV.search(head):
        raise InputError(
            f"'{path}' does not begin as a WAV, FLAC, AIFF or OGG file does, whatever it is called; save it "
            "as WAV."
        )


def _check_size(path: Path, sound: soundfile.SoundFile) -> None:
    size = 4 * sound.frames * sound.channels
    if size > LARGEST_SOUND_BYTES:
        raise InputError(
            f"The sound file '{path}' has by its header {sound.frames} samples in {sound.channels} channels, "
            f"{size / 2**30:.3g} GB, more than the {LARGEST_SOUND_BYTES / 2**30:.3g} GB that are read at "
            "once; cut it into recordings of one sentence each."
        )


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
