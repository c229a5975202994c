"""Who speaks: both voices keep sound, phones and words together, vary, and are the same again."""

import itertools

import numpy as np
import pytest

from corpus_tools.core import MissingExtraError
from corpus_tools.demo import VOICES, all_sentences, time_grammar, time_phones, usual_voice
from corpus_tools.speech import ENGINES, phone_set

SENTENCE = time_grammar().pronounce("the time is now just after eleven pm")


@pytest.fixture(scope="module", params=list(VOICES))
def voice(request):
    return VOICES[request.param]


@pytest.fixture(scope="module")
def said(voice):
    return [voice.speak(SENTENCE, np.random.default_rng(seed)) for seed in range(4)]


def level(audio, start_s, end_s):
    part = np.asarray(audio.samples)[int(start_s * audio.rate_hz) : int(end_s * audio.rate_hz)]
    return float(np.sqrt(np.mean(part.astype(float) ** 2)))


def test_phones_are_those_of_the_lexicon_without_holes_and_as_long_as_the_sound(said):
    expected = ["SIL", *itertools.chain(*SENTENCE.phones), "SIL"]
    for spoken in said:
        assert [p.text for p in spoken.phones] == expected
        assert spoken.phones.intervals[0].start_s == 0.0
        for before, after in itertools.pairwise(spoken.phones):
            assert before.end_s == after.start_s
        assert spoken.phones.intervals[-1].end_s == pytest.approx(spoken.audio.duration_s, abs=1e-4)
        assert min(p.duration_s for p in spoken.phones) >= 0.0099


def test_words_cover_the_speech(said):
    for spoken in said:
        assert spoken.words.intervals[0].start_s == pytest.approx(spoken.phones.intervals[0].end_s)
        assert spoken.words.intervals[-1].end_s == pytest.approx(spoken.phones.intervals[-1].start_s)
        assert [w.text for w in spoken.words][:6] == "the time is now just after".split()  # noqa: SIM905


def test_it_sounds_where_it_speaks_and_is_silent_at_both_ends(said):
    for spoken in said:
        first, last = spoken.phones.intervals[0], spoken.phones.intervals[-1]
        assert 0.3 <= first.duration_s <= 0.55
        assert 0.3 <= last.duration_s <= 0.55
        vowels = [p for p in spoken.phones if p.text in phone_set("arpabet").vowels]
        loud = np.mean([level(spoken.audio, p.start_s, p.end_s) for p in vowels])
        assert level(spoken.audio, 0.0, first.end_s - 0.03) < 0.02 * loud
        assert level(spoken.audio, last.start_s + 0.15, last.end_s) < 0.02 * loud


def test_every_token_has_a_rate_and_silences_of_its_own_and_is_the_same_again(voice, said):
    speech = [s.phones.intervals[-1].start_s - s.phones.intervals[0].end_s for s in said]
    assert 0.02 < np.ptp(np.log(speech)) < 0.6
    assert np.ptp([s.phones.intervals[0].duration_s for s in said]) > 0.01
    again = voice.speak(SENTENCE, np.random.default_rng(0))
    assert again.phones == said[0].phones
    np.testing.assert_array_equal(again.audio.samples, said[0].audio.samples)


def test_without_the_extra_the_formant_voice_speaks(monkeypatch):
    assert usual_voice() is VOICES["espeak"]

    def gone():
        raise MissingExtraError("the voice is not installed")

    monkeypatch.setattr(
        "corpus_tools.demo.voices.ENGINES",
        {"espeak": type("Gone", (), {"check": staticmethod(gone), "version": ENGINES["espeak"].version})},
    )
    assert usual_voice() is VOICES["formants"]
    assert "voice" in VOICES["formants"].summary


@pytest.mark.parametrize("index", [0, 1444, 2879])
def test_times_of_the_formant_voice_follow_words_and_phones(index):
    sentence = all_sentences()[index]
    phones, words = time_phones(sentence, np.random.default_rng(index))
    assert [p.text for p in phones] == ["SIL", *itertools.chain(*sentence.phones), "SIL"]
    assert tuple(w.text for w in words) == sentence.words
    assert all(0.03 < p.duration_s < 0.35 for p in phones.intervals[1:-1])
