"""A small simulated corpus on disk, for a first look without recordings and for tests."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from corpus_tools.core import Audio, Capture, FloatArray, Labels, Tier, atomic_folder, step
from corpus_tools.demo.actor import Disturbances, disturb, marker_names, true_markers
from corpus_tools.demo.gestures import articulate, time_phones
from corpus_tools.demo.sentences import Sentence, covering_sentences
from corpus_tools.demo.sound import speak
from corpus_tools.io import (
    CorpusDescription,
    init_corpus,
    read_description,
    write_markers_npz,
    write_textgrid,
    write_wav,
)

__all__ = ["VERSION", "SimulatedSentence", "demo_folder", "simulate_corpus", "simulate_sentence"]

VERSION = "1"
"""Changes whenever the simulated corpus does: a kept copy of another version is made anew."""

RATE_HZ = 120.0
N_SENTENCES = 14

_NOTE = (
    "Simulated, not recorded: sentences of the time domain spoken by a formant synthesiser, and a simulated\n"
    "marker capture of the bundled head (gestures, skin motion, sensor noise, occlusions, head motion).\n"
    f"Version {VERSION} of the simulator, seed {{seed}}.\n"
)

Progress = Callable[[float, str], None]


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedSentence:
    """One simulated recording and the truth behind it.

    Attributes
    ----------
    sentence : Sentence
    phones, words : Tier
    capture : Capture
        What the cameras saw, 73 markers, NaN where occluded.
    truth_mm : (n_frames, 66, 3) mm
        Face markers without noise, gaps or head motion.
    audio : Audio
    """

    sentence: Sentence
    phones: Tier
    words: Tier
    capture: Capture
    truth_mm: FloatArray
    audio: Audio


def simulate_sentence(
    sentence: Sentence, rng: np.random.Generator, how: Disturbances | None = None
) -> SimulatedSentence:
    """Simulate the recording of one sentence at 120 Hz.

    Parameters
    ----------
    sentence : Sentence
    rng : numpy Generator
        Equal generators give equal recordings.
    how : Disturbances, optional
    """
    phones, words = time_phones(sentence, rng)
    truth = true_markers(articulate(phones, RATE_HZ, rng))
    seen = disturb(truth, RATE_HZ, rng, how)
    capture = Capture(seen, RATE_HZ, marker_names(), history=(step("simulated", version=VERSION),))
    return SimulatedSentence(sentence, phones, words, capture, truth, speak(phones, rng))


def simulate_corpus(
    folder: str | Path,
    n_sentences: int = N_SENTENCES,
    seed: int = 0,
    progress: Progress | None = None,
) -> CorpusDescription:
    """Write a simulated corpus; equal arguments give equal bytes.

    Parameters
    ----------
    folder : path
        Made when it does not exist; nothing remains of it when the work is interrupted.
    n_sentences : int
    seed : int
    progress : callable, optional
        ``progress(fraction, what)``; may raise to cancel.

    Raises
    ------
    OutputError
        The folder cannot be written.
    """
    report = progress or (lambda fraction, what: None)
    rng = np.random.default_rng(seed)
    with atomic_folder(folder) as out:
        for index, sentence in enumerate(covering_sentences(n_sentences, rng)):
            report(index / n_sentences, f"simulating sentence {index + 1} of {n_sentences}")
            made = simulate_sentence(sentence, np.random.default_rng([seed, index]))
            name = f"time{index + 1:02d}"
            write_markers_npz(out / "markers" / f"{name}.npz", made.capture)
            write_wav(out / "wav" / f"{name}.wav", made.audio)
            labels = Labels((made.phones, made.words), 0.0, made.phones.intervals[-1].end_s)
            write_textgrid(out / "textgrid" / f"{name}.TextGrid", labels)
        (out / "NOTE.txt").write_text(_NOTE.format(seed=seed), encoding="utf-8")
        settings = {"name": "simulated time sentences", "frame_time": "start", "head_scale": "false"}
        init_corpus(
            out,
            motion=str(out / "markers" / "{id}.npz"),
            audio=str(out / "wav" / "{id}.wav"),
            labels=str(out / "textgrid" / "{id}.TextGrid"),
            settings=settings,
        )
        report(1.0, "simulated")
    return read_description(folder)


def demo_folder(folder: str | Path, progress: Progress | None = None) -> Path:
    """Return a folder with the simulated starter corpus, made there on first use.

    Parameters
    ----------
    folder : path
        Where it is kept; a copy of another version is replaced.
    progress : callable, optional
    """
    place = Path(folder)
    stamp = place / "NOTE.txt"
    if stamp.is_file() and stamp.read_text(encoding="utf-8") == _NOTE.format(seed=0):
        return place
    shutil.rmtree(place, ignore_errors=True)
    simulate_corpus(place, progress=progress)
    return place
