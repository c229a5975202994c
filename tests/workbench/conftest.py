"""A small simulated corpus, made and opened once for all tests of the workbench."""

import queue

import pytest

from corpus_tools.demo import simulate_corpus
from corpus_tools.pipeline import open_corpus
from workbench.actions import CorpusCache, Desk
from workbench.state import Session


@pytest.fixture(scope="session")
def corpus_folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("simulated") / "corpus"
    simulate_corpus(folder, n_sentences=12)
    return folder


@pytest.fixture(scope="session")
def opened(corpus_folder):
    return open_corpus(corpus_folder)


class Now:
    """Runs what is delivered when asked, as a page's loop would."""

    def __init__(self):
        self.queue = queue.Queue()

    def __call__(self, action):
        self.queue.put(action)

    def until(self, condition, timeout_s=60):
        while not condition():
            self.queue.get(timeout=timeout_s)()


@pytest.fixture
def desk_of(corpus_folder):
    cache, made = CorpusCache(), []

    def make():
        loop = Now()
        desk = Desk(Session(), cache, loop)
        made.append(desk)
        return desk, loop

    yield make
    for desk in made:
        desk.close()
