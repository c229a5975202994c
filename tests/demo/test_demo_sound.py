"""The simulated voice: in time with the phones, loud in vowels, silent in silences, never too loud."""

import numpy as np
import pytest

from corpus_tools.demo import speak, time_grammar, time_phones
from corpus_tools.speech import phone_set


@pytest.fixture(scope="module")
def voice():
    sentence = time_grammar().pronounce("the time is now just after six in the afternoon")
    phones, _ = time_phones(sentence, np.random.default_rng(0))
    return phones, speak(phones, np.random.default_rng(1))


def level(audio, phone, margin_s=0.01):
    inner = slice(
        int((phone.start_s + margin_s) * audio.rate_hz), int((phone.end_s - margin_s) * audio.rate_hz)
    )
    return float(np.sqrt(np.mean(np.asarray(audio.samples)[inner].astype(float) ** 2)))


def test_sound_is_as_long_as_the_phones_and_within_range(voice):
    phones, audio = voice
    assert audio.rate_hz == 16000
    assert audio.duration_s == pytest.approx(phones.intervals[-1].end_s, abs=1 / 16000)
    assert 0.3 < np.abs(audio.samples).max() < 0.9


def test_vowels_sound_and_silences_do_not(voice):
    phones, audio = voice
    vowels = phone_set("arpabet").vowels
    loud = [level(audio, p) for p in phones if p.text in vowels]
    quiet = [level(audio, p, 0.05) for p in phones if p.text == "SIL"]
    assert len(loud) >= 5
    assert max(quiet) < 0.02 * min(loud)


def test_hisses_are_higher_than_vowels(voice):
    phones, audio = voice

    def centroid_hz(phone):
        part = np.asarray(audio.samples)[int(phone.start_s * 16000) : int(phone.end_s * 16000)]
        power = np.abs(np.fft.rfft(part)) ** 2
        return float((power * np.fft.rfftfreq(len(part), 1 / 16000)).sum() / power.sum())

    hisses = [centroid_hz(p) for p in phones if p.text in {"S", "SH", "F"}]
    vowels = [centroid_hz(p) for p in phones if p.text in {"AA", "AW", "AO", "AH", "AE", "AY"}]
    assert hisses
    assert min(hisses) > 2 * max(vowels)


def test_the_same_generator_gives_the_same_sound(voice):
    phones, audio = voice
    again = speak(phones, np.random.default_rng(1))
    np.testing.assert_array_equal(audio.samples, again.samples)
