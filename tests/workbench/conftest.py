"""A small simulated corpus, made and opened once for all tests of the workbench."""

import pytest

from corpus_tools.demo import simulate_corpus
from corpus_tools.pipeline import open_corpus


@pytest.fixture(scope="session")
def corpus_folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("simulated") / "corpus"
    simulate_corpus(folder, n_sentences=12)
    return folder


@pytest.fixture(scope="session")
def opened(corpus_folder):
    return open_corpus(corpus_folder)
