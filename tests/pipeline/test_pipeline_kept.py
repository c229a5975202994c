"""Cleaned motion is kept by content: found again it is the same to the last bit, and never another's."""

import os
from dataclasses import replace

import numpy as np
import pytest

import corpus_tools.pipeline.reading as reading
from corpus_tools.config import Config, config_with
from corpus_tools.core import Capture, Step
from corpus_tools.demo import simulate_corpus
from corpus_tools.pipeline import code_hash, kept, open_corpus, read_corpus
from corpus_tools.pipeline.kept import keep, kept_folder, kept_name, read_kept


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.fixture(scope="module")
def few(tmp_path_factory):
    """Return a simulated corpus of a few sentences: cleaning them is quick."""
    folder = tmp_path_factory.mktemp("few") / "corpus"
    simulate_corpus(folder, n_sentences=3)
    return folder


@pytest.fixture
def counted(monkeypatch):
    """Return the list that every cleaning is entered in."""
    done, clean = [], reading.clean_corpus

    def counting(*args, **kwargs):
        done.append(args)
        return clean(*args, **kwargs)

    monkeypatch.setattr(reading, "clean_corpus", counting)
    return done


def capture(seed=0, **values):
    motion = np.random.default_rng(seed).normal(size=(6, 3, 3))
    motion[2, 1] = np.nan
    return Capture(motion, 100.0, ("a", "b", "c"), **values)


def test_a_corpus_that_was_cleaned_opens_the_same_without_cleaning(few, counted):
    first, second = open_corpus(few), open_corpus(few)
    assert len(counted) == 1
    assert first.scale_sd == second.scale_sd
    for one, two in zip(first.recordings, second.recordings, strict=True):
        np.testing.assert_array_equal(one.capture.positions_mm, two.capture.positions_mm)
        np.testing.assert_array_equal(one.capture.flags, two.capture.flags)
        assert one.capture.history == two.capture.history
        assert hash(one.capture.history) == hash(two.capture.history)
        assert one.capture.audio is not None


def test_other_settings_are_cleaned_anew_and_a_held_out_cleaning_is_never_kept(few, counted):
    open_corpus(few)
    open_corpus(few, config_with(Config(), cleaning__cutoff_hz=7.0))
    assert len(counted) == 2
    raw = read_corpus(few)
    for _ in range(2):
        reading.cleaned_recordings(raw, learn_from=raw.names[:2])
    assert len(counted) == 4
    assert len(list(kept_folder().iterdir())) == 2


@pytest.mark.parametrize(
    "change",
    [
        lambda c: replace(c, positions_mm=np.nextafter(c.positions_mm, 1e9), flags=None),
        lambda c: replace(c, flags=np.asarray(c.flags ^ 1)),
        lambda c: replace(c, rate_hz=120.0),
        lambda c: replace(c, start_s=0.005),
        lambda c: replace(c, names=("a", "b", "d")),
        lambda c: replace(c, regions=("lip_in", "chin", "head")),
    ],
)
def test_whatever_differs_in_the_motion_has_another_name(change):
    assert kept_name([capture()], 1) == kept_name([capture()], 1)
    assert kept_name([change(capture())], 1) != kept_name([capture()], 1)


def test_another_program_or_other_settings_have_another_name(monkeypatch):
    names = {kept_name([capture()], 1), kept_name([capture()], 2)}
    monkeypatch.setattr(kept, "code_hash", lambda: code_hash() + "x")
    names.add(kept_name([capture()], 1))
    monkeypatch.setattr(kept, "library_versions", dict)
    names.add(kept_name([capture()], 1))
    assert len(names) == 4


@pytest.mark.parametrize("spoil", [lambda b: b[: len(b) // 2], lambda b: b"", lambda b: b"PK" + b[9:]])
def test_a_file_that_cannot_be_read_counts_as_none(spoil):
    keep("x.npz", [capture()], [capture(1)], 0.0)
    assert read_kept("x.npz", [capture()]) is not None
    path = kept_folder() / "x.npz"
    path.write_bytes(spoil(path.read_bytes()))
    assert read_kept("x.npz", [capture()]) is None


def test_what_json_cannot_tell_and_what_is_too_large_is_not_kept(monkeypatch):
    odd = replace(capture(1), history=(Step("smooth", (("range", (1, 2)),)),))
    keep("odd.npz", [capture()], [odd], 0.0)
    monkeypatch.setattr(kept, "KEPT_BYTES", 100)
    keep("large.npz", [capture()], [capture(1)], 0.0)
    assert not kept_folder().exists()


def test_only_the_last_used_are_kept_and_nothing_is_left_half_written(monkeypatch):
    monkeypatch.setattr(kept, "KEPT_FILES", 2)
    for number, name in enumerate("abc"):
        keep(f"{name}.npz", [capture()], [capture(1)], 0.0)
        path = kept_folder() / f"{name}.npz"
        if path.exists():
            os.utime(path, (1000.0 + number, 1000.0 + number))
        if name == "b":
            read_kept("a.npz", [capture()])
    assert {p.name for p in kept_folder().iterdir()} == {"a.npz", "c.npz"}


def test_a_cache_that_cannot_be_written_costs_time_only(few, tmp_path, counted):
    (tmp_path / "cache").write_text("a file in the place of the folder")
    open_corpus(few)
    open_corpus(few)
    assert len(counted) == 2
