"""Every sentence of the time domain, as the embedded voice says it, is in the 55 of the demo corpus."""

import itertools
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from corpus_tools.core import Capture, Labels, Recording
from corpus_tools.demo import (
    N_SENTENCES,
    VOICES,
    all_sentences,
    articulate,
    covering_sentences,
    marker_names,
    time_grammar,
    true_markers,
)
from corpus_tools.fragments import build_inventory, coverage
from corpus_tools.speech import phone_set, recorded_utterance, speak_text
from corpus_tools.synthesis import prepare_selection, select_greedy, select_viterbi
from tests.demo.patient_voice import PatientVoice

PHONES = phone_set("arpabet")
FRESH = range(0, 2880, 320)


@pytest.fixture(scope="module")
def asked():
    """What a text asks for, for every sentence of the domain: the utterances of the embedded voice."""
    voice = PatientVoice(2)
    patch = pytest.MonkeyPatch()
    patch.setattr("corpus_tools.speech.engines.espeak._children", [voice])
    try:
        with ThreadPoolExecutor(2) as pool:
            yield list(pool.map(lambda text: speak_text(text, PHONES), time_grammar().texts()))
    finally:
        patch.undo()
        voice.close()


@pytest.fixture(scope="module")
def recordings():
    """The 55 as they are recorded: what the voice made of each, and motion from the gestures."""
    made = []
    for index, sentence in enumerate(covering_sentences(N_SENTENCES, np.random.default_rng(0))):
        for_voice, for_gestures, _ = np.random.default_rng([0, index]).spawn(3)
        spoken = VOICES["espeak"].speak(sentence, for_voice)
        labels = Labels((spoken.phones, spoken.words), 0.0, spoken.phones.intervals[-1].end_s)
        utterance = recorded_utterance(f"time{index + 1:02d}", labels, spoken.audio, PHONES)
        face = true_markers(articulate(spoken.phones, 120.0, for_gestures))
        made.append(Recording(utterance, Capture(face, 120.0, marker_names()[:66])))
    return made


def test_all_2880_have_every_diphone_in_the_corpus_so_that_none_needs_backoff(asked, recordings):
    assert len(asked) == 2880
    inventory = build_inventory(recordings)
    assert coverage(inventory, asked, leave_one_out=False).missing == ()


def test_the_lexicon_that_sentences_are_chosen_by_says_what_the_voice_says(asked):
    differing = [
        (u.text, " ".join(u.labels))
        for u, s in zip(asked, all_sentences(), strict=True)
        if list(u.labels) != ["SIL", *itertools.chain(*s.phones), "SIL"]
    ]
    assert differing == []


def test_one_child_for_all_says_the_phones_that_a_fresh_one_says(asked):
    texts = list(time_grammar().texts())
    for index in FRESH:
        assert speak_text(texts[index], PHONES).labels == asked[index].labels


@pytest.mark.parametrize("select", [select_greedy, select_viterbi], ids=["greedy", "viterbi"])
def test_real_selections_use_no_backoff(asked, recordings, select):
    model = prepare_selection(build_inventory(recordings), PHONES, n_components=8)
    for utterance in asked[7::96]:
        selection = select(model, utterance)
        assert selection.chosen[0].first == 0
        assert selection.chosen[-1].last == len(utterance.phones) - 1
        assert not any(unit.backoff for unit in selection.chosen)


def test_a_corpus_without_one_of_the_words_would_be_found_wanting(asked, recordings):
    """The check above can fail: without the recordings that say "six" the sentences with it lack diphones."""
    without = [r for r in recordings if "six" not in r.utterance.text]
    assert 0 < len(without) < len(recordings)
    inventory = build_inventory(without)
    with_six = [u for u in asked if " six " in u.text]
    assert len(with_six) == 240
    covered = coverage(inventory, with_six, leave_one_out=False).utterances
    assert all(("S", "IH") in u.missing for u in covered)
