"""What ``synth`` is asked to speak: a text, a recording of the corpus, or a label file; one of them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from corpus_tools.config import ConfigBase
from corpus_tools.core import InputError, Interval, Utterance
from corpus_tools.io import read_audio, read_labels
from corpus_tools.pipeline import OpenCorpus, check_speech, speak_for, speech_language
from corpus_tools.speech import labelled_utterance

__all__ = ["SpeakRequest"]


@dataclass(frozen=True, slots=True)
class SpeakRequest:
    """The options of a command line that say what to speak.

    Attributes
    ----------
    text, utterance : str or None
    labels, audio : path or None
    voiced : tuple of str
        Options given that only a text has: "--lang", "--engine", "--voice", "--rate".
    """

    text: str | None = None
    utterance: str | None = None
    labels: Path | None = None
    audio: Path | None = None
    voiced: tuple[str, ...] = ()

    def check(self, config: ConfigBase) -> None:
        """Refuse wrong combinations, and text that cannot be spoken, before any work.

        Raises
        ------
        InputError
            The sentence says which options go together.
        """
        given = [self.text, self.utterance, self.labels]
        if sum(g is not None for g in given) != 1:
            raise InputError(
                "Say what to speak: --text TEXT, --utterance NAME or --labels FILE.TextGrid (one of them)."
            )
        if self.audio is not None and self.labels is None:
            raise InputError(
                "--audio goes with --labels FILE.TextGrid; a text is spoken, and a recorded utterance brings "
                "its own sound."
            )
        if self.voiced and self.text is None:
            raise InputError(
                f"{self.voiced[0]} goes with --text; recordings and label files bring their own sound."
            )
        if self.text is not None:
            check_speech(self.text, config)

    def target(self, corpus: OpenCorpus, config: ConfigBase) -> tuple[Utterance, dict[str, Any]]:
        """Return the utterance, and the request as the manifest tells it."""
        if self.text is not None:
            language = speech_language(corpus, config)
            return speak_for(corpus, self.text, config), {"text": self.text, "language": language}
        if self.utterance is not None:
            return corpus.utterance(self.utterance), {"utterance": self.utterance}
        assert self.labels is not None
        target = labelled_utterance(
            self.labels.stem,
            read_labels(self.labels),
            read_audio(self.audio) if self.audio else None,
            corpus.phones,
            phone_tier=corpus.description.phone_tier,
            word_tier=corpus.description.word_tier,
            source=str(self.labels),
            language=corpus.description.language,
        )
        return target, {"labels": self.labels.name, "audio": self.audio.name if self.audio else None}

    def own_recordings(self, corpus: OpenCorpus, target: Utterance) -> tuple[str, ...]:
        """Return the recordings that say the target itself: that of --utterance, those of equal --labels."""
        if self.utterance is not None:
            return (self.utterance,)
        if self.labels is None:
            return ()
        said = _spoken(target, corpus.phones.silence)
        return tuple(
            r.name for r in corpus.recordings if _alike(_spoken(r.utterance, corpus.phones.silence), said)
        )


SAME_S = 0.001
"""Times that differ by no more are equal (our choice: label files are written with 1 ms or finer)."""


def _spoken(utterance: Utterance, silence: str) -> list[Interval]:
    return [p for p in utterance.phones if p.text != silence]


def _alike(a: list[Interval], b: list[Interval]) -> bool:
    """Say whether spoken phones and their times are equal; silences follow from them and the file."""
    return [p.text for p in a] == [p.text for p in b] and all(
        max(abs(p.start_s - q.start_s), abs(p.end_s - q.end_s)) <= SAME_S for p, q in zip(a, b, strict=True)
    )
