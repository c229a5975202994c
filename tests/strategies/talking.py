"""A small simulated speaker of ARPABET: lips that close, a jaw, a head that moves; as a corpus folder."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.interpolate import PchipInterpolator

from corpus_tools.core import Capture, Interval, Labels, Recording, Tier, Utterance
from corpus_tools.io import init_corpus, write_markers_npz, write_textgrid
from corpus_tools.speech import phone_set

PHONES = phone_set("arpabet")
WORDS = {
    "bin": ("B", "IH", "N"),
    "set": ("S", "EH", "T"),
    "two": ("T", "UW"),
    "now": ("N", "AW"),
    "may": ("M", "EY"),
}
HEAD = ("head0", "head1", "head2", "head3")
FACE = ("brow0", "nose5", "cheek0", "cheek1", "lip_out0", "lip_out3", "lip_out6", "lip_out9")
FACE += ("lip_in1", "lip_in2", "lip_in3", "lip_in5", "lip_in6", "lip_in7", "chin3", "chin4")
RATE_HZ = 40.0
# neutral x, y, z, and how much of opening (down), rounding (in and forward) and jaw each marker takes
_PLACES = dict(
    zip(
        (*HEAD, *FACE),
        [
            *((-60, 60, -20), (60, 60, -20), (-55, 20, -40), (55, 25, -40)),
            *((-20, 45, 20), (0, 5, 45), (-35, -5, 20), (35, -5, 20)),
            *((-25, -30, 25), (0, -22, 35), (25, -30, 25), (0, -40, 33)),
            *((-10, -29, 34), (0, -29, 36), (10, -29, 34), (10, -31, 34), (0, -31, 36), (-10, -31, 34)),
            *((0, -65, 25), (8, -66, 24)),
        ],
        strict=True,
    )
)
_OPENING = {"lip_out9": -0.8, "lip_in5": -0.9, "lip_in6": -1.0, "lip_in7": -0.9, "chin3": -0.6, "chin4": -0.6}
_ROUND = {"lip_out0": (0.5, 0.2), "lip_out6": (-0.5, 0.2), "lip_out3": (0, 0.6), "lip_out9": (0, 0.6)}
# opening mm, rounding mm of each phone
_POSTURES = {
    **dict.fromkeys("BM", (-1.8, 1.0)),
    **{"SIL": (0.0, 0.0), "IH": (5.0, -2.0), "EH": (8.0, -1.0), "EY": (6.0, -3.0), "AW": (11.0, 2.0)},
    **{"UW": (3.0, 7.0), "N": (3.5, 0.0), "S": (2.0, -1.0), "T": (2.5, 0.0)},
}


def speak(name: str, words: list[str], rng: np.random.Generator) -> Utterance:
    """Return an utterance of words, of phones of random length, with silence around."""
    intervals, said, at = [Interval(0.0, 0.5, "SIL")], [], 0.5
    for word in words:
        start = at
        for phone in WORDS[word]:
            end = at + float(rng.uniform(0.07, 0.16))
            intervals.append(Interval(at, end, phone))
            at = end
        said.append(Interval(start, at, word))
    intervals.append(Interval(at, at + 0.5, "SIL"))
    return Utterance(name, " ".join(words), Tier("phones", tuple(intervals)), Tier("words", tuple(said)))


def motion_of(spoken: Utterance, rng: np.random.Generator, noise_mm: float = 0.05) -> Capture:
    """Return simulated motion: postures by phone with chance in them, an offset of the whole, head still."""
    times = np.arange(int(spoken.duration_s * RATE_HZ)) / RATE_HZ
    wanted = np.array([_POSTURES[p] for p in spoken.labels]) + rng.normal(0, 0.6, (len(spoken.labels), 2))
    centres = np.array([p.centre_s for p in spoken.phones])
    opening, rounding = PchipInterpolator(centres, wanted)(np.clip(times, centres[0], centres[-1])).T
    names = (*HEAD, *FACE)
    positions = np.repeat(np.array([_PLACES[n] for n in names], float)[None], len(times), axis=0)
    for column, name in enumerate(names):
        positions[:, column, 1] += _OPENING.get(name, 0.0) * opening
        side, forward = _ROUND.get(name, (0.0, 0.0))
        positions[:, column, 0] += side * rounding
        positions[:, column, 2] += forward * rounding
    face = slice(len(HEAD), None)
    positions[:, face] += rng.normal(0, 0.4, (len(FACE), 3)) + rng.normal(
        0, noise_mm, positions[:, face].shape
    )
    return Capture(positions, RATE_HZ, names)


def talk(n: int = 8, seed: int = 0, words: int = 4) -> list[Recording]:
    """Return `n` simulated recordings, head markers and all."""
    found = []
    for index in range(n):
        rng = np.random.default_rng([seed, index])
        spoken = speak(f"s{index:02d}", [str(w) for w in rng.choice(sorted(WORDS), words)], rng)
        found.append(Recording(spoken, motion_of(spoken, rng)))
    return found


def with_head_motion(capture: Capture, rng: np.random.Generator) -> Capture:
    """Return a capture whose head is turned and moved as a whole."""
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_euler("xyz", rng.uniform(-8, 8, 3), degrees=True).as_matrix()
    return Capture(capture.positions_mm @ turn.T + rng.uniform(-20, 20, 3), capture.rate_hz, capture.names)


def talking_corpus(folder: Path, n: int = 8, seed: int = 0) -> Path:
    """Write a corpus of simulated recordings: motion and labels, no sound."""
    for recording in talk(n, seed):
        spoken = recording.utterance
        moved = with_head_motion(recording.capture, np.random.default_rng([seed, *spoken.name.encode()]))
        (folder / "m").mkdir(parents=True, exist_ok=True)
        (folder / "t").mkdir(exist_ok=True)
        write_markers_npz(folder / "m" / f"{spoken.name}.npz", moved)
        assert spoken.words is not None
        write_textgrid(
            folder / "t" / f"{spoken.name}.TextGrid",
            Labels((spoken.phones, spoken.words), 0.0, spoken.duration_s),
        )
    settings = {"phones": "arpabet", "reference_markers": "head*"}
    init_corpus(
        folder / "work",
        motion=str(folder / "m" / "{id}.npz"),
        labels=str(folder / "t" / "{id}.TextGrid"),
        settings=settings,
    )
    return folder / "work"
