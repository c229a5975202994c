"""The simulated corpus on disk: recordings to begin with, and the truth behind them for tests."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from corpus_tools.core import Audio, BoolArray, Capture, FloatArray, Labels, Tier, atomic_folder, step
from corpus_tools.demo.actor import layout_columns, marker_names, true_markers
from corpus_tools.demo.capture import Disturbances, Seen, disturb
from corpus_tools.demo.cover import covering_sentences
from corpus_tools.demo.gestures import articulate
from corpus_tools.demo.sentences import Sentence
from corpus_tools.demo.truth import Truth, write_truth
from corpus_tools.demo.voices import Voice, usual_voice
from corpus_tools.io import (
    CorpusDescription,
    init_corpus,
    read_description,
    write_markers_npz,
    write_textgrid,
    write_wav,
)

__all__ = [
    "N_SENTENCES",
    "README",
    "VERSION",
    "SimulatedSentence",
    "corpus_stamp",
    "simulate_corpus",
    "simulate_sentence",
]

VERSION = "2"
"""Changes whenever the simulated corpus does: a kept copy of another version is made anew."""

N_SENTENCES = 55
"""As many as paper A captured."""

RATE_HZ = 120.0
README = "README.txt"

_README = """Simulated, not recorded: {n} sentences of the time domain (paper A, section 4)

{stamp}

The voice: {voice}.
The motion: a simulated 120 Hz marker capture of the bundled head. Gestures of a task-dynamic model move
its lips and jaw; private skin motion, sensor noise with spikes, markers that exchange their names,
occlusions, head motion and a jig that slips are added, as optical capture has them. What was really there
is in truth/, which no pattern of corpus.toml reads.

What to look out for:
{events}
"""

Progress = Callable[[float, str], None]


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedSentence:
    """One simulated recording and the truth behind it.

    Attributes
    ----------
    sentence : Sentence
    phones, words : Tier
        As the voice spoke them.
    capture : Capture
        What the cameras saw, NaN where occluded.
    truth_mm : (n_frames, 66, 3) mm
        Face markers without noise, gaps, skin or head motion.
    articulators : (n_frames, 5)
    seen : Seen
        What was done to the truth, all 73 markers.
    audio : Audio
    """

    sentence: Sentence
    phones: Tier
    words: Tier
    capture: Capture
    truth_mm: FloatArray
    articulators: FloatArray
    seen: Seen
    audio: Audio


def simulate_sentence(
    sentence: Sentence,
    rng: np.random.Generator,
    how: Disturbances | None = None,
    voice: Voice | None = None,
    layout: str = "full",
) -> SimulatedSentence:
    """Simulate the recording of one sentence at 120 Hz.

    Parameters
    ----------
    sentence : Sentence
    rng : numpy Generator
        Equal generators give equal recordings.
    how : Disturbances, optional
    voice : Voice, optional
        The embedded one, where it is installed.
    layout : str
        Which markers the capture has, of :data:`~corpus_tools.demo.actor.LAYOUTS`.
    """
    columns = layout_columns(layout)
    for_voice, for_gestures, for_capture = rng.spawn(3)
    spoken = (voice or usual_voice()).speak(sentence, for_voice)
    articulators = articulate(spoken.phones, RATE_HZ, for_gestures)
    truth = true_markers(articulators)
    seen = disturb(truth, RATE_HZ, for_capture, how)
    names = tuple(marker_names()[i] for i in columns)
    history = (step("simulated", version=VERSION),)
    capture = Capture(seen.positions_mm[:, columns], RATE_HZ, names, history=history)
    return SimulatedSentence(
        sentence, spoken.phones, spoken.words, capture, truth, articulators, seen, spoken.audio
    )


def corpus_stamp(voice: Voice, seed: int) -> str:
    """Return the line of the README that is the same when the whole corpus is."""
    return f"Version {VERSION} of the simulator, voice {voice.name} ({voice.version()}), seed {seed}."


def _span(mask: BoolArray) -> str:
    frames = np.flatnonzero(mask)
    return f"frames {frames[0]}-{frames[-1]}"


def _events(name: str, made: SimulatedSentence) -> list[str]:
    """Return what went wrong in a recording beyond noise, spikes and occlusions, one line each."""
    lines = []
    seen, names = made.seen, marker_names()
    pair = [names[i] for i in np.flatnonzero(seen.swapped.any(axis=0))]
    if set(pair) & set(made.capture.names):
        lines.append(
            f"  {name}: {' and '.join(pair)} exchanged in {_span(np.asarray(seen.swapped.any(axis=1)))}"
        )
    if np.isfinite(seen.slip_s):
        lines.append(f"  {name}: the jig slips at {seen.slip_s:.2f} s")
    return lines


def _write(out: Path, name: str, made: SimulatedSentence) -> None:
    write_markers_npz(out / "markers" / f"{name}.npz", made.capture)
    write_wav(out / "wav" / f"{name}.wav", made.audio)
    labels = Labels((made.phones, made.words), 0.0, made.phones.intervals[-1].end_s)
    write_textgrid(out / "textgrid" / f"{name}.TextGrid", labels)
    truth = Truth.of(made.truth_mm, made.articulators, made.seen, RATE_HZ)
    write_truth(out / "truth" / f"{name}.npz", truth)


def _describe(out: Path, seed: int, voice: Voice, n: int, events: Sequence[str]) -> None:
    text = _README.format(
        n=n,
        stamp=corpus_stamp(voice, seed),
        voice=voice.summary,
        events="\n".join(events or ["  nothing"]),
    )
    (out / README).write_text(text, encoding="utf-8")
    init_corpus(
        out,
        motion=str(out / "markers" / "{id}.npz"),
        audio=str(out / "wav" / "{id}.wav"),
        labels=str(out / "textgrid" / "{id}.TextGrid"),
        settings={"name": "simulated time sentences", "frame_time": "start", "head_scale": "false"},
    )


def simulate_corpus(
    folder: str | Path,
    n_sentences: int = N_SENTENCES,
    seed: int = 0,
    progress: Progress | None = None,
    *,
    layout: str = "full",
    voice: Voice | None = None,
    how: Disturbances | None = None,
) -> CorpusDescription:
    """Write a simulated corpus; equal arguments give equal bytes.

    Parameters
    ----------
    folder : path
        Made when it does not exist; nothing remains of it when the work is interrupted.
    n_sentences : int
        The first (about 30) cover the diphones of the domain, best first; the rest are random.
    seed : int
    progress : callable, optional
        ``progress(fraction, what)``; may raise to cancel.
    layout : str
        Which markers there are: "full" (66 on the face, 7 on the head) or "outer-lips".
    voice : Voice, optional
        The embedded one, where it is installed; the README says which spoke.
    how : Disturbances, optional
        What the capture adds to the truth.

    Raises
    ------
    OutputError
        The folder cannot be written.
    """
    report = progress or (lambda fraction, what: None)
    layout_columns(layout)
    speaker = voice or usual_voice()
    events: list[str] = []
    with atomic_folder(folder) as out:
        for index, sentence in enumerate(covering_sentences(n_sentences, np.random.default_rng(seed))):
            report(index / n_sentences, f"simulating sentence {index + 1} of {n_sentences}")
            rng = np.random.default_rng([seed, index])
            made = simulate_sentence(sentence, rng, how, speaker, layout)
            name = f"time{index + 1:02d}"
            _write(out, name, made)
            events += _events(name, made)
        _describe(out, seed, speaker, n_sentences, events)
        report(1.0, "simulated")
    return read_description(folder)
