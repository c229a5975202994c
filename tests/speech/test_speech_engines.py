"""Every speech engine keeps the same laws; the embedded voice lives, and dies, in a process of its own."""

from __future__ import annotations

import itertools
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from corpus_tools.core import Audio, EngineError, InputError, Interval, Labels, MissingExtraError, Tier
from corpus_tools.speech import ENGINES, SpeechRequest, phone_map, phone_set, speak_text
from corpus_tools.speech.engines import espeak
from corpus_tools.speech.engines.child import Children

PHONES = phone_set("arpabet")
SENTENCE = "the time is now exactly one in the afternoon"
LETTERS = "a b c d e f g h i j k l m n o p q r s t u v x y z"
GRID = (
    "bin lay place set blue green red white at by in with "
    f"{LETTERS} zero one two three four five six seven eight nine again now please soon"
).split()


def request_for(engine):
    if engine.takes == "text":
        return SpeechRequest("law", text=SENTENCE)
    rows = ((0.0, 0.3, "SIL"), (0.3, 0.5, "N"), (0.5, 0.9, "AW1"), (0.9, 1.2, "sp"))
    tiers = (
        Tier("phones", tuple(Interval(*row) for row in rows)),
        Tier("words", (Interval(0.3, 0.9, "now"),)),
    )
    sound = Audio(np.sin(np.arange(1200 * 16) / 20).astype(np.float32), 16000)
    return SpeechRequest("law", labels=Labels(tiers, 0.0, 1.2), audio=sound)


@pytest.mark.parametrize("name", ENGINES)
def test_every_engine_gives_a_whole_utterance_and_the_same_twice(name):
    engine = ENGINES[name]
    engine.check()
    assert engine.version()
    first, again = (engine.speak(request_for(engine), PHONES) for _ in range(2))
    assert first.engine == name
    assert first.labels[0] == first.labels[-1] == "SIL"
    assert set(first.labels) <= set(PHONES.phones)
    for before, after in itertools.pairwise(first.phones):
        assert before.end_s == after.start_s
        assert (before.text, after.text) != ("SIL", "SIL")
    assert min(p.duration_s for p in first.phones) >= 0.01 - 1e-9
    assert first.phones.intervals[0].start_s == 0
    assert first.audio.duration_s == pytest.approx(first.duration_s, abs=1e-3)
    assert np.abs(first.audio.samples).max() <= 1
    edges = {t for p in first.phones for t in (p.start_s, p.end_s)}
    assert all(w.start_s in edges and w.end_s in edges for w in first.words)
    assert first.phones == again.phones
    assert first.audio.samples.tobytes() == again.audio.samples.tobytes()


@pytest.mark.parametrize("name", [n for n in ENGINES if ENGINES[n].takes != "text"])
def test_an_engine_says_what_it_speaks(name):
    with pytest.raises(InputError, match="--"):
        ENGINES[name].speak(SpeechRequest("x", text="now"), PHONES)
    with pytest.raises(InputError, match=r"not text.*espeak"):
        speak_text("now", PHONES, engine=name)


@pytest.fixture(scope="module")
def spoken():
    return speak_text(SENTENCE, PHONES)


def test_the_sentence_of_the_paper_has_its_phones_and_every_word(spoken):
    assert spoken.labels[1:-1] == tuple(
        "DH AH T AY M IH Z N AW EH G Z AE K T L IY W AH N IH N DH IY AE F T ER N UW N".split()  # noqa: SIM905
    )
    assert [w.text for w in spoken.words] == SENTENCE.split()
    inside = {
        w.text: [p.text for p in spoken.phones if w.start_s <= p.centre_s < w.end_s] for w in spoken.words
    }
    assert inside["in"] == ["IH", "N"], "eSpeak NG says 'in the' in one go"
    assert inside["afternoon"] == ["AE", "F", "T", "ER", "N", "UW", "N"]
    assert spoken.audio.rate_hz == 22050


def test_sound_and_phones_are_in_time(spoken):
    samples, rate = spoken.audio.samples, spoken.audio.rate_hz

    def loudness(low, high):
        return float(np.sqrt(np.mean(samples[round(low * rate) : round(high * rate)] ** 2)))

    first, *inner, last = spoken.phones
    assert first.duration_s >= 0.3
    assert last.duration_s >= 0.3
    assert loudness(first.start_s, first.end_s) < 1e-3
    assert loudness(last.start_s + 0.02, last.end_s) < 1e-3
    vowels = [loudness(p.start_s, p.end_s) for p in inner if p.text in PHONES.vowels]
    assert min(vowels) > 0.02


def test_a_stop_begins_with_its_closure():
    spoken = speak_text("happy apple, pay", PHONES)
    samples, rate = spoken.audio.samples, spoken.audio.rate_hz
    stops = [p for p in spoken.phones if p.text == "P"]
    assert len(stops) == 3
    for stop in stops:
        start = round(stop.start_s * rate)
        assert not samples[start : start + rate // 50].any(), "20 ms and more of silence"
        assert stop.duration_s > 0.06
        assert np.abs(samples[start : round(stop.end_s * rate)]).max() > 0.01, "and the burst"


@pytest.mark.parametrize("word", GRID)
def test_the_words_of_grid_map_onto_the_phones_of_the_set(word):
    vocabulary = {"zed", *GRID} - {"z"}
    spoken = speak_text(f"by {word} two", PHONES, vocabulary=vocabulary)
    _, middle, _ = spoken.words
    phones = " ".join(p.text for p in spoken.phones if middle.start_s <= p.centre_s < middle.end_s)
    known = {
        "a": "EY",
        "z": "Z EH D",
        "zero": "Z IH R OW",
        "again": "AH G EH N",
        "with": "W IH DH",
        "r": "AA R",
        "x": "EH K S",
    }
    assert phones == known.get(word, phones)
    assert phones
    if len(word) == 1:
        assert len(phones.split()) <= 3, f"'{word}' is spelled, not called: {phones}"


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"language": "xx"}, ("not of 'xx'", "holds the phones of en")),
        ({"language": "en-xx"}, ("language 'en-xx'", "en-gb, ")),
        ({"language": "es-419"}, ("es-419", "holds the phones of en")),
        ({"voice": "f22"}, ("voice 'f22'", "did you mean 'f2'")),
        ({"rate": 9.0}, ("9", "0.5 to 2.5")),
        ({"engine": "espaek"}, ("espaek", "did you mean 'espeak'")),
    ],
    ids=str,
)
def test_what_the_voice_cannot_do_costs_one_sentence(changes, words):
    with pytest.raises(InputError) as caught:
        speak_text("now", PHONES, **changes)
    for word in words:
        assert word in str(caught.value)


def test_a_sound_without_a_place_in_the_set_is_named(monkeypatch):
    monkeypatch.setattr(espeak, "LANGUAGES", {"en": "de"})
    with pytest.raises(InputError, match=r"'C'.*phone set 'arpabet'"):
        speak_text("ich", PHONES)


def test_rate_and_voice_change_the_sound():
    usual, quick, other = (speak_text("hello", PHONES, **k) for k in ({}, {"rate": 2.0}, {"voice": "f2"}))
    assert quick.duration_s - 0.6 < 0.65 * (usual.duration_s - 0.6)
    assert usual.labels == quick.labels == other.labels
    assert usual.audio.samples.tobytes() != other.audio.samples.tobytes()


@pytest.mark.parametrize("voice", ["f2", "whisper"])
def test_breathy_voices_are_the_same_at_another_time_of_day(voice):
    first = speak_text("hello", PHONES, voice=voice)
    time.sleep(1.1)  # the library seeds its noise with the second of the day
    again = speak_text("hello", PHONES, voice=voice)
    assert first.audio.samples.tobytes() == again.audio.samples.tobytes()


def test_british_english_says_zed_and_is_written_as_dictionaries_do():
    assert " ".join(speak_text("z four", PHONES, language="en-gb").labels) == "SIL Z EH D F AO R SIL"
    assert " ".join(speak_text("z four", PHONES).labels) == "SIL Z IY F AO R SIL"


def test_every_word_has_its_time_and_the_words_join_up():
    text = "it is in the end one of the things that are out of the way, for the most of us"
    spoken = speak_text(text, PHONES)
    assert [w.text for w in spoken.words] == text.replace(",", "").split()


def test_brackets_are_no_phoneme_codes_and_tags_are_refused():
    plain = speak_text("now, aI, then", PHONES)
    assert speak_text("now [[aI]] then", PHONES).labels == plain.labels
    with pytest.raises(InputError, match="markup"):
        speak_text("<break/> now", PHONES)


def test_the_library_is_not_in_our_process():
    speak_text("now", PHONES)
    assert "espeak" not in Path("/proc/self/maps").read_text()
    assert "espeakng_loader" not in sys.modules


def test_without_the_extra_one_line_says_what_to_install(monkeypatch):
    monkeypatch.setattr(espeak, "_children", [])
    monkeypatch.setitem(sys.modules, "espeakng_loader", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'visual-speech-workbench\[voice\]'"):
        speak_text("now", PHONES)
    with pytest.raises(MissingExtraError):
        ENGINES["espeak"].check()
    espeak.prepare_espeak()


def test_a_library_that_does_not_load_is_told(monkeypatch, tmp_path):
    package = tmp_path / "espeakng_loader"
    package.mkdir()
    (package / "__init__.py").write_text("def get_library_path(): return '/none/at/all.so'\n")
    monkeypatch.setattr(espeak, "_children", [])
    monkeypatch.setattr(espeak, "_folder", lambda: tmp_path)
    with pytest.raises(MissingExtraError, match="pip install"):
        speak_text("now", PHONES)


def stub(tmp_path, *lines):
    """Return children that run these lines; ``turn`` counts the starts."""
    counter, script = tmp_path / "turns", tmp_path / "child.py"
    head = [
        "import os, struct, sys, time",
        f"path = {str(counter)!r}",
        "turn = len(open(path).read()) if os.path.exists(path) else 0",
        "open(path, 'a').write('x')",
        "def send(data): sys.stdout.buffer.write(struct.pack('>I', len(data)) + data); sys.stdout.flush()",
        "sys.stdin.buffer.read(4)",
    ]
    script.write_text("\n".join([*head, *lines]) + "\n")
    return Children([sys.executable, "-I", "-S", str(script)], "the voice")


def test_a_child_that_dies_is_replaced_once_in_silence(tmp_path, capfd):
    children = stub(tmp_path, "if turn == 0: os.abort()", "send(b'{\"ok\": 1}'); send(b'ab')")
    assert children.ask({"x": 1}, 10) == ({"ok": 1}, b"ab")
    assert (tmp_path / "turns").read_text() == "xx"
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    "line", ["os._exit(0)", "sys.stdout.write('Error: no')", "send(b'{')", "send(b'{}')"], ids=str
)
def test_a_child_that_gives_no_whole_answer_twice_costs_one_sentence(tmp_path, line):
    with pytest.raises(EngineError, match="ended twice") as caught:
        stub(tmp_path, line).ask({"x": 1}, 10)
    assert str(caught.value).count(".") == 1
    assert (tmp_path / "turns").read_text() == "xx"


def test_a_child_that_hangs_is_stopped(tmp_path):
    start = time.perf_counter()
    with pytest.raises(EngineError, match=r"within 0\.5 s"):
        stub(tmp_path, "time.sleep(60)").ask({"x": 1}, 0.5)
    assert time.perf_counter() - start < 10


def test_the_voice_killed_in_the_middle_speaks_all_the_same():
    """Killed from outside while it works: the second try gives the same bytes, and no child stays behind."""
    text = " ".join([SENTENCE + "."] * 60)
    usual = speak_text(text, PHONES)
    killed = []

    def kill():
        while not killed and not done.wait(0.005):
            for child in children_of(os.getpid())[:1]:
                os.kill(child, signal.SIGKILL)
                killed.append(child)

    espeak._process().close()
    done = threading.Event()
    thread = threading.Thread(target=kill)
    thread.start()
    again = speak_text(text, PHONES)
    done.set()
    thread.join()
    assert killed
    assert again.audio.samples.tobytes() == usual.audio.samples.tobytes()


def children_of(pid):
    """Return the children of a process that are voices."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            parent = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
            if parent == pid and b"espeak_worker" in (folder / "cmdline").read_bytes():
                found.append(int(folder.name))
        except OSError:
            continue
    return found


def test_nothing_stays_behind_when_the_program_ends():
    code = (
        "import os\n"
        "from corpus_tools.speech import phone_set, prepare_espeak, speak_text\n"
        "p = phone_set('arpabet')\n"
        "[speak_text('now', p) for _ in range(2)]\n"
        "prepare_espeak()\n"
        "from corpus_tools.speech.engines.espeak import _children\n"
        "print(_children[0]._spare.process.pid, flush=True)\n"
    )
    for end in ("", "os.kill(os.getpid(), 9)\n"):
        run = subprocess.run([sys.executable, "-c", code + end], capture_output=True, text=True, check=False)
        child = int(run.stdout)
        deadline = time.monotonic() + 10
        while Path(f"/proc/{child}").exists() and time.monotonic() < deadline:
            time.sleep(0.02)
        assert not Path(f"/proc/{child}").exists(), f"the voice outlived the program ({end!r})"
        assert run.stderr == ""


def test_a_forked_process_starts_its_own_voice():
    speak_text("now", PHONES)
    espeak.prepare_espeak()
    usual = speak_text("now", PHONES).audio.samples.tobytes()
    espeak.prepare_espeak()
    waiting = espeak._process()._spare
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        same = speak_text("now", PHONES).audio.samples.tobytes() == usual
        os.write(writing, b"1" if same else b"0")
        os._exit(0)
    os.waitpid(child, 0)
    assert os.read(reading, 1) == b"1"
    os.close(reading)
    os.close(writing)
    assert waiting.alive, "the voice that waits for us was used by another process"
    assert speak_text("now", PHONES).audio.samples.tobytes() == usual


def test_many_threads_may_speak_at_once():
    texts = ["one", "two", "three", "four"]
    alone = [speak_text(t, PHONES).audio.samples.tobytes() for t in texts]
    found = {}
    threads = [
        threading.Thread(target=lambda t=t: found.update({t: speak_text(t, PHONES).audio.samples.tobytes()}))
        for t in texts
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [found[t] for t in texts] == alone


def test_the_symbols_of_the_voice_are_a_map_of_every_set():
    assert phone_map("espeak", "arpabet").phones is PHONES
