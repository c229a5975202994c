"""A small simulated corpus that tests may spoil."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from corpus_tools.core import Capture
from corpus_tools.demo import simulate_corpus
from corpus_tools.io import read_markers, write_markers_npz


@pytest.fixture(scope="session")
def small_corpus(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of four simulated sentences; tests must not write into it."""
    folder = tmp_path_factory.mktemp("small") / "corpus"
    simulate_corpus(folder, n_sentences=4)
    return folder


@pytest.fixture
def spoiled(small_corpus: Path, tmp_path: Path) -> Path:
    """Return a copy of the small corpus for one test to spoil."""
    return shutil.copytree(small_corpus, tmp_path / "spoiled")


@pytest.fixture
def alter(spoiled: Path) -> Callable[[str, Callable[[Capture], Capture]], None]:
    """Return a function that rewrites the motion of one recording of the spoiled corpus."""

    def change(name: str, how: Callable[[Capture], Capture]) -> None:
        path = spoiled / "markers" / f"{name}.npz"
        write_markers_npz(path, how(read_markers(path)))

    return change
