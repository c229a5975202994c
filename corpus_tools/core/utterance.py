"""An utterance: the timed phones that synthesis must speak, with words and sound; and a recording."""

from __future__ import annotations

from dataclasses import dataclass

from corpus_tools.core.capture import Audio, Capture
from corpus_tools.core.labels import Tier

__all__ = ["Recording", "Utterance", "speech_span_s"]


@dataclass(frozen=True, slots=True)
class Utterance:
    """What is to be said, and when (paper A section 5.1.1: phonetic labels and timing of the target).

    Attributes
    ----------
    name : str
        Id of the recording or of the prompt.
    text : str
        The words; may be empty when only phones are known.
    phones : Tier
        Contiguous intervals in the corpus's phone set; silence first and last.
    words, syllables : Tier or None
    stress : tuple of int, or None
        Of each phone: 0 none, 1 primary, 2 secondary, -1 unknown (consonants, silence); None: nothing known.
    audio : Audio or None
    engine : str
        Where sound and times come from: "recorded", "labels", "espeak", ...
    """

    name: str
    text: str
    phones: Tier
    words: Tier | None = None
    syllables: Tier | None = None
    audio: Audio | None = None
    engine: str = "recorded"
    stress: tuple[int, ...] | None = None

    @property
    def duration_s(self) -> float:
        """End of the last phone, in seconds."""
        return self.phones.intervals[-1].end_s

    @property
    def labels(self) -> tuple[str, ...]:
        """The phones as text, in order."""
        return tuple(interval.text for interval in self.phones)


@dataclass(frozen=True, slots=True)
class Recording:
    """A cleaned capture together with what is said in it: what the unit inventory is built from."""

    utterance: Utterance
    capture: Capture

    @property
    def name(self) -> str:
        """Id of the recording."""
        return self.utterance.name


def speech_span_s(utterance: Utterance, silence: str, margin_s: float = 0.0) -> tuple[float, float]:
    """Return start of the first and end of the last phone that is not silence, s, widened by a margin.

    Of an utterance that is silent throughout, those of all of it.
    """
    spoken = [p for p in utterance.phones if p.text != silence] or list(utterance.phones)
    return spoken[0].start_s - margin_s, spoken[-1].end_s + margin_s
