"""Every reader refuses what is not there, empty or garbage, in one sentence that names the file."""

from __future__ import annotations

import numpy as np
import pytest

from corpus_tools.core import Audio, Capture, InputError, Interval, Labels, Tier
from corpus_tools.io import (
    AUDIO_READERS,
    LABEL_READERS,
    MOTION_READERS,
    read_audio,
    read_labels,
    read_markers,
)

READ = {"motion": (MOTION_READERS, read_markers), "label": (LABEL_READERS, read_labels)}
READ["sound"] = (AUDIO_READERS, read_audio)
ENTRIES = [(kind, suffix) for kind, (registry, _) in READ.items() for suffix in registry]
GARBAGE = {
    "noise": np.random.default_rng(1).integers(0, 256, 3000).astype(np.uint8).tobytes(),
    "text": b"These are not the recordings you are looking for.\n" * 20,
    "zeros": bytes(1000),
    "a start of a zip": b"PK\x03\x04" + bytes(200),
    "a start of a sound": b"RIFF\x24\x00\x00\x00WAVEfmt " + bytes(3),
    "open brace": b'{"xmin": 0, ',
}


def refusal(read, path):
    with pytest.raises(InputError) as caught:
        read(path)
    message = str(caught.value)
    assert f"'{path}'" in message
    assert "\n" not in message
    assert message.endswith(".")
    return message


def test_the_formats_that_are_promised_are_registered():
    assert {".npz"} <= set(MOTION_READERS)
    assert {".textgrid", ".json"} <= set(LABEL_READERS)
    assert {".wav"} <= set(AUDIO_READERS)


@pytest.mark.parametrize(("kind", "suffix"), ENTRIES)
@pytest.mark.parametrize("what", GARBAGE)
def test_garbage_is_refused(tmp_path, kind, suffix, what):
    path = tmp_path / f"garbage{suffix}"
    path.write_bytes(GARBAGE[what])
    refusal(READ[kind][1], path)
    assert path.read_bytes() == GARBAGE[what]


@pytest.mark.parametrize(("kind", "suffix"), ENTRIES)
def test_missing_empty_and_folder_are_refused(tmp_path, kind, suffix):
    read = READ[kind][1]
    assert "There is no" in refusal(read, tmp_path / f"nothere{suffix}")
    (tmp_path / f"nought{suffix}").touch()
    assert refusal(read, tmp_path / f"nought{suffix}").endswith("is empty.")
    (tmp_path / f"folder{suffix}").mkdir()
    assert "not a file" in refusal(read, tmp_path / f"folder{suffix}")


@pytest.mark.parametrize("kind", READ)
@pytest.mark.parametrize("name", ["a.xyz", "a", "a.npz.bak"])
def test_an_unknown_suffix_lists_the_known(tmp_path, kind, name):
    registry, read = READ[kind]
    (tmp_path / name).write_bytes(b"x")
    message = refusal(read, tmp_path / name)
    assert all(suffix in message for suffix in registry)


@pytest.mark.parametrize("kind", READ)
def test_the_case_of_a_suffix_does_not_matter(tmp_path, kind):
    from corpus_tools.io import write_markers_npz, write_textgrid, write_wav

    make = {
        "motion": ("A.NPZ", lambda p: write_markers_npz(p, Capture(np.ones((2, 1, 3)), 25.0, ("a",)))),
        "label": (
            "A.TEXTGRID",
            lambda p: write_textgrid(p, Labels((Tier("t", (Interval(0, 1, "a"),)),), 0, 1)),
        ),
        "sound": ("A.WAV", lambda p: write_wav(p, Audio(np.zeros(10), 8000))),
    }
    name, write = make[kind]
    write(tmp_path / name)
    assert READ[kind][1](str(tmp_path / name)) is not None
