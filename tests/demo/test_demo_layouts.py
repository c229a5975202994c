"""Every marker layout goes the whole way: opened, a sentence put together, a head that says it."""

import numpy as np
import pytest

from corpus_tools.config import Config
from corpus_tools.demo import LAYOUTS, layout_columns, marker_names, read_truth, simulate_corpus
from corpus_tools.pipeline import check_corpus, open_corpus, prepare_head, synthesise
from corpus_tools.speech import lip_aperture_mm

NAMES = marker_names()[:66]


@pytest.fixture(scope="module", params=list(LAYOUTS))
def layout(request):
    return request.param


@pytest.fixture(scope="module")
def folder(layout, tmp_path_factory):
    place = tmp_path_factory.mktemp(layout) / "corpus"
    simulate_corpus(place, n_sentences=8, layout=layout)
    return place


@pytest.fixture(scope="module")
def corpus(folder):
    return open_corpus(folder)


def test_it_opens_with_the_markers_of_the_layout_and_nothing_to_mend(layout, folder, corpus):
    assert corpus.markers == tuple(marker_names()[i] for i in layout_columns(layout) if i < 66)
    assert corpus.skipped == {}
    assert np.isfinite(corpus.neutral_mm).all()
    assert check_corpus(folder)["advice"] == []


def test_lips_close_in_its_bilabials(corpus):
    assert np.isfinite(corpus.lips.threshold_mm)
    bilabials = [
        (corpus.recording(n), p)
        for n in corpus.names
        for p in corpus.utterance(n).phones
        if p.text in corpus.phones.bilabials
    ]
    assert len(bilabials) > 15
    for recording, phone in bilabials:
        aperture = lip_aperture_mm(recording.capture.positions_mm, corpus.markers)
        times = recording.capture.times_s
        near, around = (np.abs(times - phone.centre_s) <= reach for reach in (0.08, 0.2))
        assert aperture[near].min() < aperture[around].max() - 2.0


def test_a_sentence_is_synthesised_and_moves_the_head_as_the_truth_moves(folder, corpus):
    config = Config()
    head = prepare_head(corpus, "base", config)
    name = corpus.names[2]
    made = synthesise(corpus, corpus.utterance(name), config, head, (name,))
    vertices = np.asarray(made.vertices_mm)
    assert np.isfinite(vertices).all()
    truth = read_truth(folder / "truth" / f"{name}.npz")
    markers = vertices[:, [head.mesh.markers[n] for n in NAMES]]
    count = min(len(markers), len(truth.face_mm))
    spoken, true = (lip_aperture_mm(p[:count].astype(float), NAMES) for p in (markers, truth.face_mm))
    assert np.corrcoef(spoken, true)[0, 1] > 0.75
