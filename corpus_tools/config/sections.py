"""What is spoken, and from which motion: speech, cleaning, selection, and a person's overrides.

A new section is a class here (or in a module beside it) under ``@section("name")``; loading, export, the
diff, the schema and the command line pick it up from the registry.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator

from corpus_tools.cleaning import check_gap_method
from corpus_tools.config.section import Section, section
from corpus_tools.core import InputError

__all__ = ["CleaningSettings", "OverrideSettings", "SelectionSettings", "SpeechSettings"]


@section("speech")
class SpeechSettings(Section):
    """How text is spoken; recordings and label files bring their own sound and times."""

    engine: str = Field("espeak", description="Speech engine by name: espeak, the embedded voice.")
    language: str = Field(
        "", description="Such as en, en-gb, en-us; empty: the language that corpus.toml names."
    )
    sound: Literal["voice", "units"] = Field(
        "voice",
        description="What is heard: the voice or the recording; or the sound of the chosen units, in whose "
        "times they then speak.",
    )
    voice: str = Field("", description="Variant of the voice, such as f2; empty: its usual one.")
    rate: float = Field(1.0, ge=0.5, le=2.5, description="Speaking rate: 1 as usual, 2 twice as fast.")


@section("cleaning")
class CleaningSettings(Section):
    """Paper A section 4: noise, gaps, head motion."""

    cutoff_hz: float = Field(10.0, ge=0.1, le=60, description="Kalman smoother: frequency kept, Hz.")
    noise: Literal["cutoff", "channels", "components"] = Field(
        "cutoff",
        description="Kalman smoother: one cutoff for all, or noise estimated by channel or by component.",
    )
    head_cutoff_mm: float = Field(
        1.0, ge=0.001, le=20, description="Residual at which a head marker is doubted, mm."
    )
    head_iterations: int = Field(6, ge=1, le=50, description="Reweighting rounds of the head-motion fit.")
    head_support: bool = Field(
        True, description="Let upper-face markers that hardly move help the head markers to find the head."
    )
    gap_method: str = Field(
        "auto",
        description="Gap filling: auto (per gap, the best in rehearsal), pca-gp, gp, dct (paper A), kalman.",
    )
    gap_longest_s: float = Field(1.0, gt=0, le=60, description="Longer gaps are filled but doubtful, s.")
    gap_doubt_mm: float = Field(
        1.0, gt=0, le=100, description="Uncertainty from which a filled sample is doubtful, mm."
    )
    gap_components: int = Field(24, ge=1, le=60, description="Principal components that fill gaps.")
    outliers: bool = Field(
        True, description="Take out spikes and exchanged markers, flag markers that slid (beyond the paper)."
    )
    remove_bias: bool = Field(
        True, description="Free each recording of the posture it keeps constantly (beyond the paper)."
    )

    @field_validator("gap_method")
    @classmethod
    def _known(cls, name: str) -> str:
        try:
            check_gap_method(name)
        except InputError as error:
            raise ValueError(str(error).rstrip(".")) from None
        return name


@section("selection")
class SelectionSettings(Section):
    """Paper A section 5.1.1: which fragments speak the utterance."""

    method: str = Field("viterbi", description="Method id: greedy (as printed, mended) or viterbi.")
    duration: float = Field(1.0, ge=0, le=1e6, description="Weight of the difference in phone timing.")
    context: float = Field(
        0.3, ge=0, le=1e6, description="Weight of the neighbours left and right of the unit."
    )
    position: float = Field(
        0.0, ge=0, le=1e6, description="Weight of the place in syllable, word and phrase (beyond paper A)."
    )
    stress: float = Field(
        0.0,
        ge=0,
        le=1e6,
        description="Weight of the stress, where labels or voice tell it (beyond paper A).",
    )
    backoff: float = Field(
        2.0, ge=0, le=1e6, description="Cost of a phone that its viseme class stands in for."
    )
    flagged: float = Field(
        1.0, ge=0, le=1e6, description="Weight of filled or doubtful frames inside the unit."
    )
    join: float = Field(1.0, ge=0, le=1e6, description="Weight of the posture distance at a join.")
    velocity: float = Field(
        0.3, ge=0, le=1e6, description="Weight of the velocity distance at a join, relative to join."
    )
    acceleration: float = Field(
        0.0, ge=0, le=1e6, description="Weight of the acceleration distance at a join, relative to join."
    )
    aperture: float = Field(
        0.0, ge=0, le=1e6, description="Weight of the lip-aperture distance at a join, relative to join."
    )
    sound: float = Field(
        0.0,
        ge=0,
        le=1e6,
        description="Weight of the distance in sound at a join, relative to join; see speech.sound.",
    )
    allow_backoff: bool = Field(True, description="Let a viseme class stand in where a diphone is missing.")
    components: int = Field(12, ge=1, le=60, description="Principal components of the join distance.")
    prune: int = Field(100, ge=1, description="Candidates kept per diphone by Viterbi.")


@section("overrides")
class OverrideSettings(Section):
    """A person's word against the search: what must and what must not be used."""

    pins: tuple[Annotated[str, Field(pattern=r"^\d+-\d+=.+:\d+-\d+$")], ...] = Field(
        (),
        description="Target phones and the unit that must speak them: 'first-last=recording:i-j'; a pin "
        "holds against a ban, and synth says so.",
    )
    bans: tuple[Annotated[str, Field(min_length=1)], ...] = Field(
        (), description="Units ('recording:i-j') or whole recordings that must not be used."
    )
