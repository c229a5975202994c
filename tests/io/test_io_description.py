"""corpus.toml: what is written is read; every mistake is named with its file, its key and a way out."""

from __future__ import annotations

import dataclasses
import os
import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import CorpusError
from corpus_tools.io import CORPUS_FILE, CorpusDescription, read_description, write_description

PATTERN = "m/{id}.npz"
WORDS = st.text(st.characters(exclude_categories=("Cs", "Cc")), min_size=1, max_size=8).filter(str.strip)


def put(folder, text):
    folder.mkdir(exist_ok=True)
    data = text if isinstance(text, bytes) else text.encode()
    (folder / CORPUS_FILE).write_bytes(data)
    return folder


@given(
    name=WORDS,
    language=WORDS,
    tier=WORDS,
    offset=st.floats(-1, 1),
    scale=st.booleans(),
    frame_time=st.sampled_from(["start", "centre"]),
    units=st.sampled_from(["mm", "cm", "m", "inch"]),
    exclude=st.lists(WORDS, max_size=3),
)
def test_what_is_written_is_read(
    tmp_path_factory, name, language, tier, offset, scale, frame_time, units, exclude
):
    description = CorpusDescription(
        folder=tmp_path_factory.mktemp("corpus"),
        motion=PATTERN,
        audio="/elsewhere/{id}.wav",
        name=name.strip(),
        language=language,
        phone_tier=tier,
        audio_offset_s=offset,
        head_scale=scale,
        frame_time=frame_time,
        marker_units=units,
        exclude=tuple(exclude),
    )
    write_description(description)
    assert read_description(description.folder) == description


def test_the_file_explains_itself_and_spells_out_every_key(tmp_path):
    write_description(CorpusDescription(folder=tmp_path, motion=PATTERN, name="c"))
    text = (tmp_path / CORPUS_FILE).read_text()
    assert text.startswith("#")
    assert "{id}" in text.splitlines()[1]
    keys = {f.name for f in dataclasses.fields(CorpusDescription)} - {"folder"}
    assert set(tomllib.loads(text)) == keys
    assert [p.name for p in tmp_path.iterdir()] == [CORPUS_FILE]


def test_defaults_and_the_name_of_the_folder(tmp_path):
    description = read_description(put(tmp_path / "grid", f'motion = "{PATTERN}"'))
    assert description == CorpusDescription(folder=tmp_path / "grid", motion=PATTERN, name="grid")
    assert description.file == tmp_path / "grid" / CORPUS_FILE


def test_a_byte_order_mark_and_whole_seconds_are_read(tmp_path):
    put(tmp_path / "a", b'\xef\xbb\xbfmotion = "m/{id}.npz"\naudio_offset_s = 1\n')
    assert read_description(tmp_path / "a").audio_offset_s == 1.0


M = f'motion = "{PATTERN}"\n'
WRONG = {
    "misspelt": (M + 'fraem_time = "centre"', "fraem_time", "did you mean 'frame_time'?"),
    "unknown": (M + "zzz = 1", "zzz", "known: motion"),
    "table": (M + "[head]\nscale = true", "head", ""),
    "no motion": ("", "motion", "markers/{id}.npz"),
    "motion is a number": ("motion = 3", "motion", "text in quotes"),
    "motion is empty": ('motion = ""', "motion", "empty"),
    "motion without id": ('motion = "m/*.npz"', "motion", "has no {id}"),
    "audio without id": (M + 'audio = "a.wav"', "audio", "has no {id}"),
    "labels without id": (M + 'labels = " "', "labels", "has no {id}"),
    "motion with NUL": ('motion = "m\\u0000/{id}.npz"', "motion", "no path"),
    "head_scale": (M + 'head_scale = "yes"', "head_scale", "true or false"),
    "head_scale as a number": (M + "head_scale = 1", "head_scale", "true or false"),
    "frame_time": (M + 'frame_time = "center"', "frame_time", "did you mean 'centre'?"),
    "units": (M + 'marker_units = "feet"', "marker_units", "mm, cm, m, inch"),
    "offset": (M + 'audio_offset_s = "0.1"', "audio_offset_s", "a number"),
    "offset is a switch": (M + "audio_offset_s = true", "audio_offset_s", "a number"),
    "offset is nan": (M + "audio_offset_s = nan", "audio_offset_s", "finite"),
    "offset beyond an hour": (M + "audio_offset_s = -1e300", "audio_offset_s", "an hour"),
    "rate below 0": (M + "rate_hz = -1", "rate_hz", "positive"),
    "rate beyond reason": (M + "rate_hz = 1e308", "rate_hz", "no frame rate"),
    "exclude": (M + 'exclude = "a"', "exclude", "a list of names"),
    "exclude numbers": (M + "exclude = [1]", "exclude", "a list of names"),
    "phones": (M + 'phones = ""', "phones", "arpabet"),
    "tier": (M + 'phone_tier = " "', "phone_tier", "phones"),
    "newer": (M + "schema = 2", "schema", "update"),
    "schema 0": (M + "schema = 0", "schema", ""),
    "no TOML": ("motion =", "TOML", ""),
    "key twice": (M + M, "TOML", ""),
    "a number of 5000 digits": (M + "schema = " + "9" * 5000, "TOML", "a number in it is too long"),
    "brackets in brackets": (M + "name = " + "[" * 100_000, "read", "too deep"),
    "UTF-16": (b"\xff\xfem\x00", "read", ""),
}


@pytest.mark.parametrize("what", WRONG)
def test_a_mistake_is_named_with_file_key_and_way_out(tmp_path, what):
    text, key, words = WRONG[what]
    folder = put(tmp_path / "c", text)
    with pytest.raises(CorpusError) as caught:
        read_description(folder)
    message = str(caught.value)
    assert f"'{folder / CORPUS_FILE}'" in message
    assert key in message
    assert words in message
    assert "\n" not in message


def test_what_is_no_corpus_says_how_to_make_one(tmp_path):
    (tmp_path / "file").touch()
    (tmp_path / "empty").mkdir()
    for name in ("nowhere", "file", "empty"):
        with pytest.raises(CorpusError, match="corpus-tools init") as caught:
            read_description(tmp_path / name)
        assert str(tmp_path / name) in str(caught.value)


def test_a_folder_in_the_place_of_the_file_is_refused(tmp_path):
    (tmp_path / CORPUS_FILE).mkdir()
    with pytest.raises(CorpusError, match=CORPUS_FILE):
        read_description(tmp_path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
@pytest.mark.parametrize("through", [False, True])
def test_a_pipe_or_a_device_is_refused_and_not_waited_for(tmp_path, through):
    os.mkfifo(tmp_path / ("pipe" if through else CORPUS_FILE))
    if through:
        (tmp_path / CORPUS_FILE).symlink_to("pipe")
    with pytest.raises(CorpusError, match=f"{CORPUS_FILE}' cannot be read: it is no regular file"):
        read_description(tmp_path)


def test_a_link_to_a_file_is_followed_and_a_huge_one_is_refused(tmp_path):
    (tmp_path / "real.toml").write_text(M)
    (tmp_path / CORPUS_FILE).symlink_to("real.toml")
    assert read_description(tmp_path).motion == PATTERN
    with (tmp_path / "real.toml").open("r+b") as stream:
        stream.truncate(1 << 30)
    with pytest.raises(CorpusError, match="more than 16 MB"):
        read_description(tmp_path)
