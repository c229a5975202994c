"""A corpus over an existing folder: finding, loading, and making one without touching anything else."""

from __future__ import annotations

import hashlib
import os

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from corpus_tools.core import (
    Audio,
    Capture,
    CorpusError,
    InputError,
    Interval,
    LabelError,
    Labels,
    OutputError,
    Tier,
)
from corpus_tools.io import (
    CORPUS_FILE,
    CorpusDescription,
    find_recordings,
    init_corpus,
    load_audio,
    load_capture,
    load_labels,
    read_description,
    write_markers_npz,
    write_textgrid,
    write_wav,
)

CAPTURE = Capture(np.arange(12.0).reshape(2, 2, 3), 25.0, ("lip_in0", "head0"))
LABELS = Labels((Tier("phones", (Interval(0, 1, "AH"),)),), 0.0, 1.0)


@pytest.fixture
def data(tmp_path, monkeypatch):
    """Return a folder with three motions, two sounds and one TextGrid, which is the working directory."""
    for name in ("b1", "a1", "c1"):
        (tmp_path / "m").mkdir(exist_ok=True)
        write_markers_npz(tmp_path / f"m/{name}.npz", CAPTURE)
    for name in ("a1", "b1"):
        write_wav(tmp_path / f"s/{name}.wav", Audio(np.zeros(1280), 16000))
    write_textgrid(tmp_path / "t/a1.TextGrid", LABELS)
    (tmp_path / "m" / ".hidden.npz").touch()
    (tmp_path / "m" / "notes.txt").touch()
    (tmp_path / "m" / "folder.npz").mkdir()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def state(folder):
    return {p: hashlib.sha256(p.read_bytes()).hexdigest() for p in sorted(folder.rglob("*")) if p.is_file()}


def init(folder="work", **changes):
    return init_corpus(folder, **{"motion": "m/{id}.npz"} | changes)


def test_recordings_are_found_in_order_and_missing_files_are_none(data):
    found = find_recordings(init(audio="s/{id}.wav", labels="t/{id}.TextGrid"))
    assert [r.id for r in found] == ["a1", "b1", "c1"]
    assert [r.audio is not None for r in found] == [True, True, False]
    assert [r.labels is not None for r in found] == [True, False, False]
    assert found == find_recordings(read_description(data / "work"))


@pytest.mark.parametrize(
    ("pattern", "files", "ids"),
    [
        ("d/{id}/xyz.npz", ["d/s1/xyz.npz", "d/s2/xyz.npz", "d/s2/other.npz"], ["s1", "s2"]),
        ("d/{id}/{id}.npz", ["d/s1/s1.npz", "d/s1/s2.npz"], ["s1"]),
        ("d/take_{id}_v2.npz", ["d/take_7_v2.npz", "d/take_7_v1.npz"], ["7"]),
        ("d[1]/{id}.npz", ["d[1]/a.npz", "d1/b.npz"], ["a"]),
        ("d/a*{id}.npz", ["d/a*1.npz", "d/ab2.npz"], ["1"]),
        ("d/a?{id}.npz", ["d/a?1.npz", "d/ab2.npz"], ["1"]),
        ("d/**/{id}.npz", ["d/**/a.npz", "d/deep/b.npz"], ["a"]),
        ("d/x**{id}.npz", ["d/x**1.npz"], ["1"]),
        ("d/{id}.v1.npz", ["d/a.b.v1.npz", "d/a.npz"], ["a.b"]),
        ("{id}.npz", ["é ʃ.npz"], ["é ʃ"]),
        ("{id}[1].npz", ["a[1].npz", "b1.npz"], ["a"]),
    ],
)
def test_a_pattern_matches_names_and_nothing_else(tmp_path, pattern, files, ids):
    for file in files:
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / file).touch()
    found = find_recordings(CorpusDescription(folder=tmp_path, motion=pattern))
    assert [r.id for r in found] == ids
    assert [r.motion for r in found] == [tmp_path / pattern.replace("{id}", i) for i in ids]


@given(
    ids=st.sets(st.text("ab1_-*?[]{}.é ", min_size=1, max_size=6).filter(lambda t: t[0] != "."), min_size=1)
)
def test_any_file_name_is_an_id_that_leads_back_to_its_file(tmp_path_factory, ids):
    folder = tmp_path_factory.mktemp("ids")
    for name in ids:
        (folder / f"{name}.npz").touch()
    found = find_recordings(
        CorpusDescription(folder=folder, motion="{id}.npz", audio=str(folder / "{id}.npz"))
    )
    assert [r.id for r in found] == sorted(ids)
    assert all(r.motion == r.audio == folder / f"{r.id}.npz" for r in found)


def test_nothing_found_says_what_was_looked_for_where(tmp_path):
    description = CorpusDescription(folder=tmp_path, motion="gone/{id}.npz")
    with pytest.raises(CorpusError, match="matches nothing") as caught:
        find_recordings(description)
    assert str(tmp_path / "gone/{id}.npz") in str(caught.value)
    assert str(tmp_path / CORPUS_FILE) in str(caught.value)


@pytest.mark.parametrize(("unit", "factor"), [("mm", 1), ("cm", 10), ("m", 1000), ("inch", 25.4)])
@pytest.mark.parametrize(("frame_time", "half"), [("start", 0.0), ("centre", 0.02)])
def test_motion_is_loaded_in_mm_on_the_clock_of_its_audio(data, unit, factor, frame_time, half):
    settings = {"marker_units": unit, "frame_time": frame_time, "audio_offset_s": "-0.25"}
    description = init(audio="s/{id}.wav", settings=settings)
    first, _, third = find_recordings(description)
    capture = load_capture(description, first)
    np.testing.assert_allclose(capture.positions_mm, CAPTURE.positions_mm * factor)
    np.testing.assert_allclose(capture.times_s, half - 0.25 + np.array([0.0, 0.04]))
    assert capture.audio is not None
    assert capture.audio.duration_s == load_audio(first).duration_s == 0.08
    assert load_capture(description, third).audio is None
    assert load_audio(third) is None


def test_labels_that_are_not_there_are_named(data):
    description = init(labels="t/{id}.TextGrid")
    first, second, _ = find_recordings(description)
    assert load_labels(description, first) == LABELS
    with pytest.raises(LabelError, match="'b1' has no labels") as caught:
        load_labels(description, second)
    assert str(data / "t/b1.TextGrid") in str(caught.value)
    unlabelled = init("other")
    with pytest.raises(LabelError, match="no pattern 'labels'"):
        load_labels(unlabelled, find_recordings(unlabelled)[0])


def test_init_writes_one_file_and_leaves_the_recordings_alone(data):
    before = state(data)
    init("new/work", audio="s/{id}.wav", settings={"head_scale": "true", "name": "s1", "language": "en-GB"})
    after = state(data)
    assert set(after) - set(before) == {data / "new/work" / CORPUS_FILE}
    assert all(after[p] == before[p] for p in before)
    description = read_description("new/work")
    assert (description.head_scale, description.name, description.language) == (True, "s1", "en-GB")


@pytest.mark.parametrize(
    ("folder", "given_as", "kept"),
    [
        (".", "m/{id}.npz", "m/{id}.npz"),
        ("work", "m/{id}.npz", "{data}/m/{id}.npz"),
        ("work", "work/../m/{id}.npz", "{data}/m/{id}.npz"),
        ("m", "m/../m/{id}.npz", "{id}.npz"),
        ("work", "{data}/m/{id}.npz", "{data}/m/{id}.npz"),
    ],
)
def test_patterns_are_kept_relative_below_the_corpus_and_absolute_elsewhere(data, folder, given_as, kept):
    given_as, kept = given_as.replace("{data}", str(data)), kept.replace("{data}", str(data))
    assert init(folder, motion=given_as).motion == kept
    os.chdir("/")
    assert len(find_recordings(read_description(data / folder))) == 3


WRONG = {
    "no file matches": ({"motion": "mm/{id}.npz"}, "mm/{id}.npz", "matches no file"),
    "no id": ({"motion": "m/*.npz"}, "motion", "{id}"),
    "no motion": ({"motion": ""}, "motion", "markers/{id}.npz"),
    "labels without id": ({"labels": "t/a1.TextGrid"}, "labels", "{id}"),
    "misspelt key": ({"settings": {"fraem_time": "centre"}}, "fraem_time", "did you mean 'frame_time'?"),
    "unknown key": ({"settings": {"zzz": "1"}}, "zzz", "known: frame_time"),
    "a key with its own option": ({"settings": {"motion": "x/{id}"}}, "motion", "unknown key"),
    "bad choice": ({"settings": {"frame_time": "center"}}, "frame_time", "did you mean 'centre'?"),
    "bad switch": ({"settings": {"head_scale": "yes"}}, "head_scale", "true or false"),
    "bad number": ({"settings": {"audio_offset_s": "late"}}, "audio_offset_s", "seconds"),
    "nan": ({"settings": {"audio_offset_s": "nan"}}, "audio_offset_s", "finite"),
    "bad unit": ({"settings": {"marker_units": "feet"}}, "marker_units", "mm, cm"),
    "no axes": ({"settings": {"marker_axes": "x,y"}}, "marker_axes", "x,z,-y"),
    "an axis twice": ({"settings": {"marker_axes": "x,y,y"}}, "marker_axes", "each axis once"),
    "a mirror": ({"settings": {"marker_axes": "x,z,y"}}, "marker_axes", "mirrors"),
    "bad rate": ({"settings": {"rate_hz": "fast"}}, "rate_hz", "Hz"),
    "rate below nought": ({"settings": {"rate_hz": "-1"}}, "rate_hz", "no frame rate"),
    "bad multiple": ({"settings": {"marker_units": "0 mm"}}, "marker_units", "250 mm"),
    "empty phones": ({"settings": {"phones": ""}}, "phones", "arpabet"),
}


@pytest.mark.parametrize("what", WRONG)
def test_a_mistake_makes_no_corpus(data, what):
    changes, key, words = WRONG[what]
    before = state(data)
    with pytest.raises(CorpusError) as caught:
        init(**changes)
    assert key in str(caught.value)
    assert words in str(caught.value)
    assert state(data) == before
    assert not (data / "work").exists()


def test_a_corpus_is_replaced_only_when_told(data):
    init(settings={"name": "first"})
    with pytest.raises(CorpusError, match="there already") as caught:
        init(settings={"name": "second"})
    assert CORPUS_FILE in str(caught.value)
    assert read_description("work").name == "first"
    init(settings={"name": "second"}, force=True)
    assert read_description("work").name == "second"


@pytest.mark.parametrize("place", ["m/notes.txt", "m/notes.txt/below"])
def test_a_file_in_the_way_is_named(data, place):
    with pytest.raises((OutputError, InputError), match=r"notes\.txt"):
        init(place)
    assert (data / "m/notes.txt").read_bytes() == b""


def test_unit_rate_and_axes_of_the_corpus_reach_every_format(tmp_path):
    rows = ["Frame,a_x,a_y,a_z", "1,1,2,3", "2,4,5,6"]
    (tmp_path / "a.CSV").write_text("\n".join(rows) + "\n")
    settings = {"marker_units": "2 cm", "rate_hz": "50", "marker_axes": "y, z, x"}
    description = init_corpus(tmp_path / "w", motion=str(tmp_path / "{id}.CSV"), settings=settings)
    assert description == read_description(tmp_path / "w")
    (files,) = find_recordings(description)
    capture = load_capture(description, files)
    np.testing.assert_allclose(capture.positions_mm[:, 0], [[40, 60, 20], [100, 120, 80]])
    assert capture.rate_hz == 50.0


def test_links_to_recordings_are_followed(data):
    (data / "linked").symlink_to(data / "m")
    (data / "one").mkdir()
    (data / "one" / "x.npz").symlink_to(data / "m" / "a1.npz")
    (data / "one" / "gone.npz").symlink_to(data / "nowhere.npz")
    assert [r.id for r in find_recordings(init("w1", motion="linked/{id}.npz"))] == ["a1", "b1", "c1"]
    assert [r.id for r in find_recordings(init("w2", motion="one/{id}.npz"))] == ["x"]
