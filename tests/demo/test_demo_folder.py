"""The starter corpus of a first start: made once, whole, replaced when it is not what would be made now."""

import hashlib
import shutil

import pytest

from corpus_tools.core import OutputError
from corpus_tools.demo import VERSION, VOICES, demo_folder, folder
from corpus_tools.demo.corpus import simulate_corpus

N = 3


def contents(place):
    return {
        p.relative_to(place).as_posix(): hashlib.sha256(p.read_bytes()).hexdigest()
        for p in place.rglob("*")
        if p.is_file()
    }


class StoppedError(Exception):
    """Raised by a progress callback."""


def never(done, what):
    """Refuse all work."""
    raise StoppedError


@pytest.fixture(autouse=True)
def small(monkeypatch):
    """Three sentences instead of 55."""
    monkeypatch.setattr(folder, "N_SENTENCES", N)
    monkeypatch.setattr(
        folder, "simulate_corpus", lambda place, progress: simulate_corpus(place, N, progress=progress)
    )


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A starter corpus, made once for this module."""
    place = tmp_path_factory.mktemp("starter") / "corpus"
    simulate_corpus(place, N)
    return place


@pytest.fixture
def place(made, tmp_path):
    """A copy of it where a user keeps it."""
    target = tmp_path / "cache" / "starter-corpus"
    shutil.copytree(made, target)
    return target


def alone(place):
    """Return whether nothing else lies beside the corpus."""
    return [p.name for p in place.parent.iterdir()] == [place.name]


def test_it_is_made_on_first_use_with_progress(tmp_path, made):
    reports = []
    place = tmp_path / "cache" / "starter-corpus"
    assert demo_folder(place, lambda f, w: reports.append(f)) == place
    assert reports == sorted(reports)
    assert reports[-1] == 1.0
    assert contents(place) == contents(made)
    assert alone(place)


def test_the_second_time_costs_no_work(place):
    assert demo_folder(place, never) == place


def test_a_copy_of_another_version_is_replaced_whole(place, made):
    readme = place / "README.txt"
    readme.write_text(readme.read_text().replace(f"Version {VERSION} ", "Version 0 "))
    (place / "markers" / "time99.npz").write_bytes(b"left over")
    demo_folder(place)
    assert contents(place) == contents(made)
    assert alone(place)


@pytest.mark.parametrize(
    "name", ["markers/time02.npz", "wav/time01.wav", "textgrid/time03.TextGrid", "corpus.toml"]
)
def test_a_copy_with_files_missing_is_made_anew(place, made, name):
    (place / name).unlink()
    demo_folder(place)
    assert contents(place) == contents(made)


def test_a_copy_that_another_voice_spoke_is_made_anew(place, monkeypatch):
    monkeypatch.setattr(folder, "usual_voice", lambda: VOICES["formants"])
    with pytest.raises(StoppedError):
        demo_folder(place, never)


def test_the_old_copy_stays_when_the_new_one_is_not_finished(place):
    (place / "wav" / "time01.wav").unlink()
    before = contents(place)
    with pytest.raises(StoppedError):
        demo_folder(place, lambda done, what: never(done, what) if done > 0.5 else None)
    assert contents(place) == before
    assert alone(place)


def test_of_two_that_make_it_at_once_the_first_wins(tmp_path, made):
    place = tmp_path / "starter-corpus"

    def meanwhile(done, what):
        if done == 1.0:
            shutil.copytree(made, place)
            (place / "mark").write_text("first")

    assert demo_folder(place, meanwhile) == place
    assert (place / "mark").read_text() == "first"
    assert alone(place)


def test_what_goes_wrong_names_the_folder_that_was_asked_for(tmp_path, monkeypatch):
    def full(fresh, progress=None):
        raise OutputError(f"Cannot write '{fresh / 'markers/time01.npz'}': No space left on device.")

    monkeypatch.setattr(folder, "simulate_corpus", full)
    with pytest.raises(OutputError, match=f"'{tmp_path / 'demo/markers/time01.npz'}'"):
        demo_folder(tmp_path / "demo")
