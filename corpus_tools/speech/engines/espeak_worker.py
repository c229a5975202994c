"""The child process that eSpeak NG lives in: one request on stdin, one answer on stdout, then it ends.

The library is under the GPL and is loaded here and nowhere else. It keeps traces of what it said before
(noise, pitch, phase), so that equal texts sound equal only from a fresh process: hence one utterance each.
This file is run by its path with ``python -I -S`` and imports nothing of ours: it has to be ready within a
few hundredths of a second.

A message is its length (4 bytes, big-endian) and its bytes. Request: JSON. Answer: JSON, and a second message
with 16-bit samples in the byte order of the machine.
"""

from __future__ import annotations

import ctypes
import json
import os
import signal
import struct
import sys
from collections.abc import Mapping
from typing import IO, Any

__all__ = ["answer", "main", "read_message", "write_message"]

END_OF_EVENTS, WORD, PHONEME = 0, 1, 7
RETRIEVAL, UTF8, PHONEMES_IN_BRACKETS = 1, 1, 0x100
PHONEME_EVENTS, DO_NOT_EXIT = 0x0001, 0x8000
RATE, CHARACTERS = 1, 1
SEPARATED_BY_UNDERSCORE = ord("_") << 8
MOST_BYTES = 1 << 28


class _Id(ctypes.Union):
    _fields_ = [("number", ctypes.c_int), ("name", ctypes.c_char_p), ("string", ctypes.c_char * 8)]


class _Event(ctypes.Structure):
    _fields_ = [
        ("type", ctypes.c_int),
        ("unique_identifier", ctypes.c_uint),
        ("text_position", ctypes.c_int),
        ("length", ctypes.c_int),
        ("audio_position", ctypes.c_int),
        ("sample", ctypes.c_int),
        ("user_data", ctypes.c_void_p),
        ("id", _Id),
    ]


class _Voice(ctypes.Structure):
    _fields_ = [
        ("name", ctypes.c_char_p),
        ("languages", ctypes.c_void_p),
        ("identifier", ctypes.c_char_p),
        ("gender", ctypes.c_ubyte),
        ("age", ctypes.c_ubyte),
        ("variant", ctypes.c_ubyte),
        ("xx1", ctypes.c_ubyte),
        ("score", ctypes.c_int),
        ("spare", ctypes.c_void_p),
    ]


_CALLBACK = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.POINTER(ctypes.c_short), ctypes.c_int, ctypes.POINTER(_Event)
)


def read_message(stream: IO[bytes]) -> bytes:
    """Return the next message.

    Raises
    ------
    EOFError
        The other side is gone, or what it sends is no message.
    """
    head = stream.read(4)
    if len(head) < 4:
        raise EOFError("no message")
    (size,) = struct.unpack(">I", head)
    if size > MOST_BYTES:
        raise EOFError("no message of ours")
    data = stream.read(size)
    if len(data) < size:
        raise EOFError("half a message")
    return data


def write_message(stream: IO[bytes], data: bytes) -> None:
    """Send a message."""
    stream.write(struct.pack(">I", len(data)) + data)
    stream.flush()


def _library() -> tuple[Any, int]:
    """Load and start the library; returns it and the sampling rate, Hz."""
    import espeakng_loader

    library = ctypes.CDLL(espeakng_loader.get_library_path())
    library.espeak_Info.restype = ctypes.c_char_p
    library.espeak_ListVoices.restype = ctypes.POINTER(ctypes.POINTER(_Voice))
    library.espeak_TextToPhonemes.restype = ctypes.c_char_p
    data = espeakng_loader.get_data_path().encode()
    rate_hz = library.espeak_Initialize(2, 0, data, PHONEME_EVENTS | DO_NOT_EXIT)
    if rate_hz <= 0:
        raise RuntimeError(f"eSpeak NG does not start with the data in {data.decode()!r}")
    library.espeak_ng_SetRandSeed(ctypes.c_long(1))  # it took the time of day: breathy voices differed
    return library, rate_hz


def _languages(library: Any) -> dict[str, str]:
    """Return the languages that there are and the voice that speaks each best.

    Each voice lists (priority byte, name, NUL)..., NUL; the least priority is the best.
    """
    voices = library.espeak_ListVoices(None)
    found: dict[str, tuple[int, str]] = {}
    index = 0
    while voices[index]:
        voice = voices[index].contents
        place = voice.languages
        while ctypes.string_at(place, 1) != b"\0":
            priority, name = ctypes.string_at(place, 1)[0], ctypes.string_at(place + 1)
            found_here = (priority, voice.identifier.decode("utf-8", "replace"))
            key = name.decode("utf-8", "replace").lower()
            found[key] = min(found_here, found.get(key, found_here))
            place += len(name) + 2
        index += 1
    return {name: identifier for name, (_, identifier) in sorted(found.items())}


def _variants() -> list[str]:
    import espeakng_loader

    return sorted(os.listdir(os.path.join(espeakng_loader.get_data_path(), "voices", "!v")))  # noqa: PTH118, PTH208


class _UnknownError(Exception):
    """A language or a voice that eSpeak NG does not have, and those that it has."""

    def __init__(self, what: str, known: list[str]) -> None:
        super().__init__(what)
        self.known = known


def _set_voice(library: Any, language: str, variant: str) -> None:
    languages = _languages(library)
    if language.lower() not in languages:
        raise _UnknownError("language", list(languages))
    if variant and variant not in _variants():
        raise _UnknownError("voice", _variants())
    name = languages[language.lower()] + (f"+{variant}" if variant else "")
    if library.espeak_SetVoiceByName(name.encode()) != 0:
        raise RuntimeError(f"eSpeak NG does not take its own voice '{name}'")


def _events(pointer: Any) -> list[list[Any]]:
    """Return the events of one call: [sample, "word", position, length] or [sample, "phone", name]."""
    rows: list[list[Any]] = []
    index = 0
    while pointer[index].type != END_OF_EVENTS:
        event = pointer[index]
        if event.type == WORD:
            rows.append([event.sample, "word", event.text_position - 1, event.length])
        elif event.type == PHONEME:
            name = bytes(event.id)[:8].split(b"\0")[0].decode("utf-8", "replace")
            rows.append([event.sample, "phone", name])
        index += 1
    return rows


def _phone_counts(library: Any, words: list[str]) -> list[int]:
    """Return how many phones each word has when it stands alone."""
    counts = []
    for word in words:
        text = ctypes.create_string_buffer(word.encode())
        place = ctypes.c_void_p(ctypes.addressof(text))
        found = b""
        while place.value:
            found += b"_" + library.espeak_TextToPhonemes(
                ctypes.byref(place), CHARACTERS, SEPARATED_BY_UNDERSCORE
            )
        counts.append(len([p for p in found.decode("utf-8", "replace").replace(" ", "_").split("_") if p]))
    return counts


def _speak(library: Any, request: Mapping[str, Any]) -> tuple[list[list[Any]], bytes]:
    events: list[list[Any]] = []
    sound: list[bytes] = []

    def heard(wave: Any, n: int, pointer: Any) -> int:
        events.extend(_events(pointer))
        if wave and n > 0:
            sound.append(ctypes.string_at(wave, 2 * n))
        return 0

    callback = _CALLBACK(heard)
    library.espeak_SetSynthCallback(callback)
    _set_voice(library, request["language"], request["voice"])
    library.espeak_SetParameter(RATE, int(request["words_per_minute"]), 0)
    text = request["text"].encode()
    flags = UTF8 | PHONEMES_IN_BRACKETS
    failed = library.espeak_Synth(text, len(text) + 1, 0, CHARACTERS, 0, flags, None, None)
    if failed:
        raise RuntimeError(f"eSpeak NG could not speak (code {failed})")
    return events, b"".join(sound)


def answer(library: Any, rate_hz: int, request: Mapping[str, Any]) -> tuple[dict[str, Any], bytes]:
    """Return the answer to a request, and the samples."""
    events, sound = _speak(library, request)
    head = {
        "version": library.espeak_Info(None).decode(),
        "rate_hz": rate_hz,
        "events": events,
        "word_phones": _phone_counts(library, request["words"]),
    }
    return head, sound


def _private_stdout() -> IO[bytes]:
    """Return the pipe to the parent, and lead away whatever the library prints."""
    pipe = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    return pipe


def _answered(request: Mapping[str, Any], started: tuple[Any, int]) -> tuple[dict[str, Any], bytes]:
    try:
        return answer(*started, request)
    except _UnknownError as error:
        return {"unknown": str(error), "known": error.known}, b""
    except Exception as error:
        return {"error": f"{type(error).__name__}: {error}"}, b""


def main() -> None:
    """Start the library, answer one request, end."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is answered by the parent, which closes the pipe
    sys.path.append(sys.argv[1])
    reading, writing = sys.stdin.buffer, _private_stdout()
    started: tuple[Any, int] | None = None
    problem = ""
    try:
        started = _library()
    except Exception as error:
        problem = f"{type(error).__name__}: {error}"
    try:
        request = json.loads(read_message(reading))
    except EOFError:
        return
    head, sound = _answered(request, started) if started else ({"broken": problem}, b"")
    write_message(writing, json.dumps(head).encode())
    write_message(writing, sound)


if __name__ == "__main__":
    main()
