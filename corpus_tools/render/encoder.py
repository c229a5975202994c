"""H.264 and AAC by ffmpeg, which is only ever a child process: pictures go in through a pipe."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import numpy as np
import numpy.typing as npt

from corpus_tools.core import MissingExtraError, OutputError

__all__ = ["Encoder", "encoding", "ffmpeg_path"]

AUDIO_RATE_HZ = 48000
"""AAC in MP4 has no rate such as 25 kHz; every player has this one."""

QUALITY = ("-preset", "medium", "-crf", "17", "-tune", "animation")
COLOURS = ("-color_primaries", "bt709", "-color_trc", "bt709", "-colorspace", "bt709", "-color_range", "tv")
EXACT = ("-fflags", "+bitexact", "-flags:v", "+bitexact", "-flags:a", "+bitexact", "-map_metadata", "-1")


_CHOICE = "IMAGEIO_FFMPEG_EXE"
_WITHOUT = "(the export 'frames' works without)"
_SPACE = "free space there, choose another disk, or raise the limit on the size of files"
_FULL = ("No space left", "File too large", "Disk quota")


def ffmpeg_path() -> str:
    """Return the path of the ffmpeg program that comes with the extra ``video``.

    Raises
    ------
    MissingExtraError
        It is not installed, or the program is not where the extra says.
    """
    try:
        from imageio_ffmpeg import get_ffmpeg_exe
    except ImportError as error:
        raise MissingExtraError(
            "A film needs the extra 'video', which is not installed: "
            f"pip install 'visual-speech-workbench[video]' {_WITHOUT}."
        ) from error
    chosen = os.environ.get(_CHOICE)
    try:
        path = str(get_ffmpeg_exe())
    except RuntimeError:
        path = ""
    if path and shutil.which(path):
        return path
    if chosen:
        raise MissingExtraError(
            f"{_CHOICE} names '{chosen}', which is no program to be run; correct or unset it {_WITHOUT}."
        )
    raise MissingExtraError(
        "The extra 'video' is installed without the program ffmpeg: "
        f"pip install --force-reinstall imageio-ffmpeg {_WITHOUT}."
    )


def _command(path: Path, size: tuple[int, int], rate_hz: float, sound: Path, duration_s: float) -> list[str]:
    pictures = ("-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{size[0]}x{size[1]}", "-r", f"{rate_hz:.10g}")
    return [
        *(ffmpeg_path(), "-hide_banner", "-loglevel", "error", "-y", "-threads", "1"),
        *(*pictures, "-i", "pipe:0", "-i", str(sound), "-map", "0:v", "-map", "1:a"),
        *("-vf", "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p", "-c:v", "libx264", *QUALITY),
        *("-threads", "1", *COLOURS, "-c:a", "aac", "-b:a", "160k", "-ar", str(AUDIO_RATE_HZ)),
        *("-af", f"aresample={AUDIO_RATE_HZ},apad=whole_dur={duration_s:.9f},atrim=end={duration_s:.9f}"),
        *(*EXACT, "-movflags", "+faststart", "-f", "mp4", str(path)),
    ]


class Encoder:
    """A running ffmpeg; made by :func:`encoding`."""

    def __init__(self, child: subprocess.Popen[bytes], errors: IO[bytes]) -> None:
        self.child = child
        self.errors = errors

    def add(self, picture: npt.NDArray[np.uint8]) -> None:
        """Append a picture (height, width, 3)."""
        assert self.child.stdin is not None
        try:
            self.child.stdin.write(np.ascontiguousarray(picture).data)
        except OSError as error:
            self.child.wait()
            raise self.failure() from error

    def finish(self) -> None:
        """Wait until the film is whole."""
        assert self.child.stdin is not None
        with contextlib.suppress(OSError):
            self.child.stdin.close()
        if self.child.wait() != 0:
            raise self.failure()

    def failure(self) -> OutputError:
        """Return what ffmpeg said last, as an error."""
        self.errors.seek(0)
        said = [
            line.strip() for line in self.errors.read().decode(errors="replace").splitlines() if line.strip()
        ]
        full = next((line for line in said if any(sign in line for sign in _FULL)), "")
        code = self.child.returncode or 0
        if full or code == -getattr(signal, "SIGXFSZ", 0):
            reason = full.rstrip(".").rpartition(": ")[2] or "File too large"
            return OutputError(f"ffmpeg could not write the film: {reason}; {_SPACE}.")
        if code < 0:
            name = signal.Signals(-code).name if -code in set(signal.Signals) else f"signal {-code}"
            return OutputError(
                f"ffmpeg was ended by {name} before the film was whole; try again, with a smaller film.width "
                f"and film.height in a config if the memory is short {_WITHOUT}."
            )
        reason = said[-1].rstrip(".") if said else f"it ended with code {code}"
        return OutputError(f"ffmpeg could not write the film: {reason}; try again {_WITHOUT}.")


@contextlib.contextmanager
def encoding(
    path: Path, size: tuple[int, int], rate_hz: float, sound: Path, duration_s: float
) -> Iterator[Encoder]:
    """Yield an :class:`Encoder` that writes a film; the child is ended, whatever happens.

    Equal pictures and sound give equal bytes: one thread, no dates, no versions in the file.

    Parameters
    ----------
    path : Path
        The ``.mp4`` to be written.
    size : (int, int)
        Width and height, pixels, even.
    rate_hz : float
    sound : Path
        WAV; cut or filled up with silence to `duration_s`.
    duration_s : float

    Raises
    ------
    MissingExtraError
        The extra ``video`` is not installed.
    OutputError
        ffmpeg failed, such as on a full disk.
    """
    with tempfile.TemporaryFile() as errors:
        child = subprocess.Popen(
            _command(path, size, rate_hz, sound, duration_s),
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=errors,
            start_new_session=True,  # Ctrl-C is for us: we end the child and clean up
        )
        encoder = Encoder(child, errors)
        try:
            yield encoder
            encoder.finish()
        finally:
            if child.poll() is None:
                child.kill()
            child.wait()
            if child.stdin is not None:
                with contextlib.suppress(OSError):
                    child.stdin.close()
